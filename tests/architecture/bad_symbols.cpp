// SPDX-License-Identifier: Apache-2.0
// Everything that the core must not do, so that the check of its symbols can be seen to fail.
#include <cmath>
#include <cstdio>
#include <vector>

int calls = 0;

[[gnu::noinline]] inline int replaceable(int n) { return n * n; }

double misbehave(int n, double x) {
  static int hidden = 0;
  hidden += replaceable(n);
  calls += hidden;
  std::vector<double> heap(static_cast<std::size_t>(n), std::sin(x));
  std::printf("%d\n", calls);
  return heap.back();
}
