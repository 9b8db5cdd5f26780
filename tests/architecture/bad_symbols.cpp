// SPDX-License-Identifier: Apache-2.0
// Does everything that the core must not do, to test that the check of its symbols can fail.
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
