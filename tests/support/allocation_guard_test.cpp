// SPDX-License-Identifier: Apache-2.0
// The guard must be able to fail: every way of taking memory that it claims to see.
#include "allocation_guard.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace plvo {
namespace {

// Keeps the compiler from removing a pair of allocation and release that nothing else looks at.
void* volatile sink = nullptr;

void use_and_free(void* block) {
  sink = block;
  std::free(sink);
}

struct Way {
  const char* name;
  void (*takes)();
};

class AllocationGuardCatches : public testing::TestWithParam<Way> {};

TEST_P(AllocationGuardCatches, AndCounts) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "a sanitizer owns malloc here: nothing can be counted";
  std::int64_t taken = 0;
  std::int64_t returned = 0;
  {
    AllocationGuard guard;
    GetParam().takes();
    taken = guard.taken();
    returned = guard.returned();
  }
  EXPECT_GE(taken, 1);
  EXPECT_GE(returned, 1);
}

volatile std::size_t hundred = 100;

INSTANTIATE_TEST_SUITE_P(
    Ways, AllocationGuardCatches,
    testing::Values(Way{"malloc", [] { use_and_free(std::malloc(hundred)); }},
                    Way{"calloc", [] { use_and_free(std::calloc(hundred, 8)); }},
                    Way{"realloc", [] { use_and_free(std::realloc(std::malloc(hundred), 2 * hundred)); }},
                    Way{"aligned_alloc", [] { use_and_free(std::aligned_alloc(64, 64 * hundred)); }},
                    Way{"posix_memalign",
                        [] {
                          void* block = nullptr;
                          if (posix_memalign(&block, 64, hundred) == 0) use_and_free(block);
                        }},
                    Way{"operator_new",
                        [] {
                          auto* number = new int(7);
                          sink = number;
                          delete static_cast<int*>(sink);
                        }},
                    Way{"aligned_new",
                        [] {
                          struct alignas(128) Wide {
                            char bytes[128];
                          };
                          auto* wide = new Wide;
                          sink = wide;
                          delete static_cast<Wide*>(sink);
                        }},
                    Way{"vector",
                        [] {
                          std::vector<double> numbers(hundred);
                          sink = numbers.data();
                        }},
                    Way{"string",
                        [] {
                          std::string text(hundred, 'x');
                          sink = text.data();
                        }},
                    Way{"stable_sort",
                        [] {
                          static double numbers[200];
                          std::stable_sort(numbers, numbers + 2 * hundred);
                        }},
                    Way{"eigen_dynamic",
                        [] {
                          Eigen::MatrixXd matrix(hundred, 3);
                          sink = matrix.data();
                        }},
                    Way{"eigen_product",
                        [] {
                          // A fixed-size product large enough for Eigen's blocked kernel, which takes
                          // buffers.
                          static Eigen::Matrix<double, 60, 60> a = Eigen::Matrix<double, 60, 60>::Ones();
                          static Eigen::Matrix<double, 60, 60> b;
                          Eigen::MatrixXd c = a;
                          b = a * c;
                          sink = b.data();
                        }}),
    [](const auto& way) { return std::string(way.param.name); });

TEST(AllocationGuard, CountsNothingWhereNothingIsTaken) {
  AllocationGuard guard;
  double sum = 0;
  for (std::size_t i = 0; i < hundred; ++i) sum += static_cast<double>(i);
  const std::int64_t calls = guard.calls();
  guard.disarm();
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(sum, 4950);
}

TEST(AllocationGuard, SeesItsOwnThreadOnly) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "a sanitizer owns malloc here: nothing can be counted";
  std::int64_t seen = -1;
  std::thread other;
  AllocationGuard guard;
  guard.disarm();
  other = std::thread([] { use_and_free(std::malloc(hundred)); });
  guard.arm();
  other.join();
  guard.disarm();
  seen = guard.taken();
  EXPECT_EQ(seen, 0);
}

TEST(AllocationGuard, CountsNothingWhileDisarmed) {
  AllocationGuard guard;
  guard.disarm();
  use_and_free(std::malloc(hundred));
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace plvo
