// SPDX-License-Identifier: Apache-2.0
// Argument reduction in two parts (Cody & Waite, "Software Manual for the Elementary Functions", 1980),
// followed by Taylor polynomials. The reduced interval is so small that the first neglected term is below one
// unit in the last place.
#include "plvo/math/trigonometry.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "plvo/math/rounding.hpp"

namespace plvo {
namespace {

// π/2 in three parts. The low bits of the first two are zero, so that k·part is exact for |k| < 2^20.
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
constexpr double kHalfPiMiddle = 6.07710050630396597660e-11;
constexpr double kHalfPiLow = 2.02226624879595063154e-21;

// Above this angle the reduction loses digits; far above it, the conversion to an integer is undefined.
constexpr double kLargestAngle = 1e6;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

bool in_range(double radians) { return radians >= -kLargestAngle && radians <= kLargestAngle; }

// c_0 z^(N − 1) + … + c_(N − 1), by Horner's rule.
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double z) {
  double sum = c[0];
  for (std::size_t i = 1; i < N; ++i) sum = c[i] + z * sum;
  return sum;
}

constexpr std::array kSine = {
    1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
    1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0};
constexpr std::array kCosine = {
    1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
    1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0};

double sin_polynomial(double x) {  // |x| ≤ π/4
  const double z = x * x;
  return x + x * (z * polynomial(kSine, z));
}

double cos_polynomial(double x) {  // |x| ≤ π/4
  const double z = x * x;
  return 1.0 - 0.5 * z + z * z * polynomial(kCosine, z);
}

struct Reduced {
  double x;
  int quadrant;
};

Reduced reduce(double radians) {
  const double turns = radians * (2.0 / kPi);
  const auto k = round_to<std::int32_t>(turns);
  const auto n = static_cast<double>(k);
  const double x = ((radians - n * kHalfPiHigh) - n * kHalfPiMiddle) - n * kHalfPiLow;
  return {x, k & 3};
}

double from_bits(std::uint64_t bits) {
  double x = 0;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

std::uint64_t to_bits(double x) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

double atan_polynomial(double x) {  // |x| ≤ tan(π/16) ≈ 0.199
  const double z = x * x;
  double sum = 0;
  for (int k = 23; k >= 3; k -= 2) sum = ((k / 2) % 2 == 0 ? 1.0 : -1.0) / k + z * sum;
  return x + x * (z * sum);
}

double atan_small(double x) {  // 0 ≤ x ≤ 1
  // atan x = atan c + atan((x − c) / (1 + c x)) with c = 0, tan(π/8), 1: the remainder is at most tan(π/16).
  constexpr double kTanPi16 = 0.19891236737965800691;
  constexpr double kTan3Pi16 = 0.66817863791929891999;
  constexpr double kTanPi8 = 0.41421356237309504880;
  if (x <= kTanPi16) return atan_polynomial(x);
  if (x <= kTan3Pi16) return kPi / 8 + atan_polynomial((x - kTanPi8) / (1 + kTanPi8 * x));
  return kPi / 4 + atan_polynomial((x - 1) / (1 + x));
}

// Sine, advanced by a number of quadrants.
double sin_ahead(double radians, int quadrants) {
  if (!in_range(radians)) return kNoNumber;
  const Reduced r = reduce(radians);
  switch ((r.quadrant + quadrants) % 4) {
    case 0: return sin_polynomial(r.x);
    case 1: return cos_polynomial(r.x);
    case 2: return -sin_polynomial(r.x);
    default: return -cos_polynomial(r.x);
  }
}

}  // namespace

double sin(double radians) { return sin_ahead(radians, 0); }
double cos(double radians) { return sin_ahead(radians, 1); }

double atan2(double y, double x) {
  if (y == 0 && x == 0) return 0;
  const double ay = y < 0 ? -y : y;
  const double ax = x < 0 ? -x : x;
  // Divides the smaller by the larger, so the quotient cannot overflow.
  double angle = ay <= ax ? atan_small(ay / ax) : kPi / 2 - atan_small(ax / ay);
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

double acos(double x) {
  if (x >= 1) return 0;
  if (x <= -1) return kPi;
  return atan2(sqrt((1 - x) * (1 + x)), x);
}

double exp(double x) {
  if (x != x) return kNoNumber;
  if (x > 709.0) return std::numeric_limits<double>::infinity();
  if (x < -745.0) return 0;
  // x = k ln 2 + r with |r| ≤ ln 2 / 2. exp r comes from its series and is then scaled by 2^k.
  constexpr double kLn2High = 6.93147180369123816490e-01;
  constexpr double kLn2Low = 1.90821492927058770002e-10;
  const double turns = x * 1.44269504088896338700;
  auto k = round_to<int>(turns);
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1;
  for (int n = 16; n >= 1; --n) sum = 1 + sum * r / n;
  // Scales in two steps, so that results below 2^-1022 round only once and do not underflow early.
  const int first = k / 2;
  k -= first;
  return sum * from_bits(static_cast<std::uint64_t>(first + 1023) << 52) *
         from_bits(static_cast<std::uint64_t>(k + 1023) << 52);
}

double log(double x) {
  if (x == 0) return -std::numeric_limits<double>::infinity();
  if (!(x > 0)) return kNoNumber;
  if (x > std::numeric_limits<double>::max()) return x;
  int exponent = 0;
  if (x < 2.2250738585072014e-308) {  // subnormal
    x *= 18014398509481984.0;         // 2^54
    exponent = -54;
  }
  std::uint64_t bits = to_bits(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  double m = from_bits((bits & 0x000fffffffffffffULL) | 0x3ff0000000000000ULL);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  // log m = 2 atanh s, s = (m − 1)/(m + 1), |s| ≤ 0.1716.
  const double s = (m - 1) / (m + 1);
  const double z = s * s;
  double sum = 0;
  for (int k = 21; k >= 3; k -= 2) sum = 1.0 / k + z * sum;
  return exponent * 6.93147180369123816490e-01 +
         (2 * s * (1 + z * sum) + exponent * 1.90821492927058770002e-10);
}

}  // namespace plvo
