// SPDX-License-Identifier: Apache-2.0
// What sensors other than the camera say of the motion since the last good frame: the priors of the frames
// since then, one after the other. What a prior leaves out of the motion goes on as it did, and is as
// uncertain as a motion that nobody sees.
#pragma once

#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo {

class PropagatedPrior {
 public:
  // A good frame: nothing has moved since.
  void restart() {
    *this = PropagatedPrior();
    whole_ = true;
  }
  // A frame `seconds` after the one before. velocity: (v, ω) per second of the scene in the axes of the last
  // good frame's camera, as of exposure.hpp, for what the prior does not tell. A prior that tells no motion
  // ends what is known until the next restart(), and so does a motion that may lead anywhere
  // (covariance.hpp).
  void extend(const MotionPrior& prior, const Vector6& velocity, double seconds,
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
