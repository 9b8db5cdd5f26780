// SPDX-License-Identifier: Apache-2.0
// A hand that rotates a camera to and fro about all three axes, for the simulator: the motion that plvo
// calibrate requires.
#pragma once

#include <cmath>
#include <string>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::test {

// Returns a TUM trajectory of this many seconds at 100 Hz, z up, initially looking along x.
inline std::string turning_hand(double seconds) {
  Matrix3 look;
  look.col(0) = Vector3(0, -1, 0);
  look.col(1) = Vector3(0, 0, -1);
  look.col(2) = Vector3(1, 0, 0);
  std::string text;
  for (int i = 0; i <= static_cast<int>(seconds * 100); ++i) {
    const double t = 0.01 * i;
    const auto wave = [t](double size, double hz, double phase) {
      return size * (std::sin(6.2831853 * hz * t + phase) - std::sin(phase));
    };
    const Vector3 turn(wave(0.12, 1.1, 0.3), wave(0.18, 0.8, 0), wave(0.12, 0.6, 1));
    const Vector3 place(wave(0.04, 0.9, 2), wave(0.05, 0.7, 0.5), wave(0.03, 1.2, 1.5));
    text +=
        trajectory_line(1'000'000'000 + std::int64_t{10'000'000} * i, Se3{look * rotation_exp(turn), place}) +
        '\n';
  }
  return text;
}

}  // namespace plvo::test
