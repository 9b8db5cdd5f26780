// SPDX-License-Identifier: Apache-2.0
// Motion since the last good frame according to sensors other than the camera: the priors of the frames since
// then, composed. A part of the motion that a prior lacks continues with the last velocity, with the process
// noise of an unobserved motion.
#pragma once

#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo {

class PropagatedPrior {
 public:
  // Called at a good frame: the motion begins there.
  void restart() {
    *this = PropagatedPrior();
    whole_ = true;
  }
  // Appends the prior of a frame, `seconds` after the one before. coasted: the motion in this time
  // of a camera that keeps its velocity; it replaces what the prior lacks. It is (v, ω) of the
  // scene, as in exposure.hpp, times the seconds of motion, in the axes of the last good frame's
  // camera. After a prior without any motion, the propagated prior is unknown until the next
  // restart(). The same holds once the position may be anywhere (covariance.hpp).
  void extend(const MotionPrior& prior, const Vector6& coasted, double seconds,
              const ReferenceConfig& config);

  // True while every frame since the last good one came with a motion.
  bool known() const { return whole_ && frames_ > 0; }
  const Se3& T_current_last() const { return T_current_last_; }
  const Matrix6& covariance() const { return covariance_; }

 private:
  bool whole_ = false;
  int frames_ = 0;
  double seconds_ = 0;
  Se3 T_current_last_;
  Matrix6 covariance_ = Matrix6::Zero();
};

}  // namespace plvo
