// SPDX-License-Identifier: Apache-2.0
// Compares the functions with the long double functions of the C library, in units in the last place, and
// with recorded fingerprints, so that a compiler, optimisation level or processor that changes a bit fails.
#include "plvo/math/trigonometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fingerprint.hpp"
#include "plvo/base/random.hpp"

namespace plvo {
namespace {

// |got − exact| in units in the last place of `exact` rounded to double. A subnormal counts in its own unit.
double ulps(double got, long double exact) {
  const double rounded = std::abs(static_cast<double>(exact));
  const double unit = std::nextafter(rounded, std::numeric_limits<double>::infinity()) - rounded;
  return static_cast<double>(std::abs(static_cast<long double>(got) - exact) /
                             static_cast<long double>(unit));
}

double uniform(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

// A double of either sign with a magnitude between 2^low and 2^high.
double any_magnitude(Random& random, int low, int high) {
  const double m = 1 + random.uniform();
  const double sign = random.below(2) == 0 ? 1 : -1;
  return sign * std::ldexp(m, low + static_cast<int>(random.below(static_cast<std::uint32_t>(high - low))));
}

constexpr int kDraws = 20000;

// Where long double is as short as double (32-bit ARM), the reference itself may be wrong by one unit.
constexpr double kReferenceUlps = sizeof(long double) > sizeof(double) ? 0 : 1;

TEST(Trigonometry, SinAndCosWithinTwoUnitsUpToAMillion) {
  Random random(1);
  double worst_sin = 0, worst_cos = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 2 == 0 ? uniform(random, -7, 7) : any_magnitude(random, -40, 19);
    worst_sin = std::max(worst_sin, ulps(sin(x), std::sin(static_cast<long double>(x))));
    worst_cos = std::max(worst_cos, ulps(cos(x), std::cos(static_cast<long double>(x))));
  }
  EXPECT_LT(worst_sin, 2 + kReferenceUlps);
  EXPECT_LT(worst_cos, 2 + kReferenceUlps);
}

TEST(Trigonometry, SinAndCosAreAccurateNearMultiplesOfAQuarterTurn) {
  // Near a zero the error of the range reduction dominates, so this test bounds the absolute error.
  for (int k = -2000; k <= 2000; ++k) {
    const double centre = k * (kPi / 2);
    for (double x : {std::nextafter(centre, -1e9), centre, std::nextafter(centre, 1e9), centre + 1e-9}) {
      EXPECT_NEAR(sin(x), static_cast<double>(std::sin(static_cast<long double>(x))), 1.2e-16) << k;
      EXPECT_NEAR(cos(x), static_cast<double>(std::cos(static_cast<long double>(x))), 1.2e-16) << k;
    }
  }
}

TEST(Trigonometry, Atan2WithinThreeUnitsInEveryQuadrant) {
  Random random(2);
  double worst = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double y = any_magnitude(random, -30, 30), x = any_magnitude(random, -30, 30);
    worst = std::max(worst,
                     ulps(atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
    const double a = uniform(random, -1, 1), b = uniform(random, -1, 1);
    worst = std::max(worst,
                     ulps(atan2(a, b), std::atan2(static_cast<long double>(a), static_cast<long double>(b))));
  }
  EXPECT_LT(worst, 3 + kReferenceUlps);
}

TEST(Trigonometry, Atan2IsExactOnTheAxes) {
  EXPECT_EQ(atan2(0, 0), 0);
  EXPECT_EQ(atan2(0, 1), 0);
  EXPECT_EQ(atan2(0, -1), kPi);
  EXPECT_EQ(atan2(-0.0, -1), kPi) << "the range is (−π, π]";
  EXPECT_EQ(atan2(1, 0), kPi / 2);
  EXPECT_EQ(atan2(-1, 0), -kPi / 2);
  EXPECT_EQ(atan2(1, 1), kPi / 4);
  EXPECT_EQ(atan2(1e308, 1e-308), kPi / 2);
  EXPECT_EQ(atan2(5e-324, 1), 5e-324);
}

TEST(Trigonometry, AcosWithinThreeUnitsAndClamped) {
  Random random(3);
  double worst = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 2 == 0 ? uniform(random, -1, 1) : 1 - std::abs(any_magnitude(random, -50, -1));
    worst = std::max(worst, ulps(acos(x), std::acos(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 3 + kReferenceUlps);
  EXPECT_EQ(acos(1), 0);
  EXPECT_EQ(acos(1.0000001), 0);
  EXPECT_EQ(acos(-1), kPi);
  EXPECT_EQ(acos(-2), kPi);
}

TEST(Trigonometry, ExpWithinTwoUnitsOverItsWholeRange) {
  Random random(4);
  double worst = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 3 == 0 ? uniform(random, -708, 709) : any_magnitude(random, -60, i % 3 == 1 ? 0 : 5);
    worst = std::max(worst, ulps(exp(x), std::exp(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 2 + kReferenceUlps);
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(-746), 0);
  EXPECT_EQ(exp(710), std::numeric_limits<double>::infinity());
  EXPECT_LE(ulps(exp(-740), std::exp(-740.0L)), 1) << "a subnormal";
  EXPECT_LE(ulps(exp(709), std::exp(709.0L)), 2);
}

TEST(Trigonometry, LogWithinTwoUnitsOverItsWholeRange) {
  Random random(5);
  double worst = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 2 == 0 ? std::abs(any_magnitude(random, -1070, 1023)) : uniform(random, 0.5, 2);
    worst = std::max(worst, ulps(log(x), std::log(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 2 + kReferenceUlps);
  EXPECT_EQ(log(1), 0);
  EXPECT_EQ(log(0), -std::numeric_limits<double>::infinity());
}

TEST(Trigonometry, ReturnsNaNForNaNAndOutsideTheDomain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (double x : {nan, infinity, -infinity}) {
    EXPECT_TRUE(std::isnan(sin(x))) << x;
    EXPECT_TRUE(std::isnan(cos(x))) << x;
  }
  EXPECT_TRUE(std::isnan(atan2(nan, 1)));
  EXPECT_TRUE(std::isnan(atan2(1, nan)));
  EXPECT_TRUE(std::isnan(acos(nan)));
  EXPECT_TRUE(std::isnan(exp(nan)));
  EXPECT_TRUE(std::isnan(log(nan)));
  EXPECT_TRUE(std::isnan(log(-1)));
  EXPECT_TRUE(std::isnan(sin(1.1e6)) && std::isnan(cos(-1e300))) << "beyond the stated range";
  EXPECT_EQ(exp(infinity), infinity);
  EXPECT_EQ(exp(-infinity), 0);
  EXPECT_EQ(log(infinity), infinity);
}

// The fingerprints of 4000 results of each function were recorded with GCC on x86-64.
TEST(Trigonometry, ResultsHaveTheRecordedBits) {
  Random random(6);
  Fingerprint sin_bits, cos_bits, atan2_bits, acos_bits, exp_bits, log_bits, sqrt_bits;
  for (int i = 0; i < 4000; ++i) {
    const double x = uniform(random, -100, 100), y = uniform(random, -1, 1);
    sin_bits.add(sin(x));
    cos_bits.add(cos(x));
    atan2_bits.add(atan2(x, 50 * y));
    acos_bits.add(acos(y));
    exp_bits.add(exp(x));
    log_bits.add(log(x * x));
    sqrt_bits.add(sqrt(x * x * y * y));
  }
  EXPECT_EQ(sin_bits.value(), 9991889427627638946ULL);
  EXPECT_EQ(cos_bits.value(), 10198198509752781098ULL);
  EXPECT_EQ(atan2_bits.value(), 9253133284468752641ULL);
  EXPECT_EQ(acos_bits.value(), 2891371531230451466ULL);
  EXPECT_EQ(exp_bits.value(), 17197657464878474656ULL);
  EXPECT_EQ(log_bits.value(), 15364897028171667663ULL);
  EXPECT_EQ(sqrt_bits.value(), 9378867073928662489ULL);
}

}  // namespace
}  // namespace plvo
