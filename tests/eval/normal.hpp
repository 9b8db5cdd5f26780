// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plvo/base/random.hpp"

namespace plvo::test {

inline double normal(
    Random& random) {  // the sum of twelve uniforms has variance 1; the missing tail does not matter here
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

}  // namespace plvo::test
