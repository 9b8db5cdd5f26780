// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/camera_model.hpp"
#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/math/se3.hpp"

int main() {
  plvo::Vector6 delta = plvo::Vector6::Constant(0.5);
  const plvo::Se3 T = plvo::boxplus(plvo::Se3{}, delta);
  return plvo::CameraModel{}.validate().ok() && (plvo::boxminus(T, plvo::Se3{}) - delta).norm() < 1e-12 ? 0
                                                                                                        : 1;
}
