// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/camera_info.hpp"

namespace plvo {
namespace {

Status wrong_count(const char* words, std::size_t count) {
  return Status(StatusCode::kInvalidArgument, words).append(static_cast<std::ptrdiff_t>(count));
}

// The name that librealsense gives to plumb_bob, and the names of two other lenses. These two mean no
// distortion if their coefficients are 0, and are refused otherwise.
constexpr std::string_view kRealSensePlumbBob = "Brown Conrady";

bool is_undistorted(std::string_view model, std::span<const double> coefficients) {
  if (model != "None" && model != "Inverse Brown Conrady" && model != "Modified Brown Conrady") return false;
  for (const double coefficient : coefficients)
    if (coefficient != 0) return false;
  return true;
}

}  // namespace

Status lens_model_of(std::string_view name, LensModel& model) {
  if (name == "equidistant" || name == "fisheye") {
    model = LensModel::kEquidistant;
  } else if (name.empty() || name == "plumb_bob" || name == "rational_polynomial" ||
             name == kRealSensePlumbBob) {
    model = LensModel::kRational;
  } else {
    return Status(StatusCode::kUnsupported, "distortion model '")
        .append(name.substr(0, 40))
        .append(
            "' is not supported, only plumb_bob, rational_polynomial and equidistant; calibrate again "
            "with one of them, or undistort the images first");
  }
  return {};
}

const char* lens_model_name(const Distortion& lens) {
  if (lens.model == LensModel::kEquidistant) return "equidistant";
  return lens.is_plumb_bob() ? "plumb_bob" : "rational_polynomial";
}

Status distortion_of(std::string_view model, std::span<const double> coefficients, Distortion& lens) {
  const std::span<const double> D = coefficients;
  LensModel known = LensModel::kRational;
  if (is_undistorted(model, D)) {
    lens = {};
    return {};
  }
  if (const Status status = lens_model_of(model, known); !status.ok()) return status;
  if (known == LensModel::kEquidistant) {
    if (D.size() != 4)
      return wrong_count("equidistant has 4 distortion coefficients, k1 k2 k3 k4, not ", D.size());
    lens = {.k1 = D[0], .k2 = D[1], .k3 = D[2], .k4 = D[3], .model = LensModel::kEquidistant};
    return {};
  }
  if ((model == "plumb_bob" || model == kRealSensePlumbBob) && D.size() > 5)
    return wrong_count("plumb_bob has 4 or 5 distortion coefficients (8 are rational_polynomial's), not ",
                       D.size());
  if (D.size() != 0 && D.size() != 4 && D.size() != 5 && D.size() != 8 && D.size() != 12 && D.size() != 14)
    return wrong_count("expected 4 or 5 distortion coefficients (plumb_bob) or 8 (rational_polynomial), not ",
                       D.size());
  for (std::size_t i = 8; i < D.size(); ++i)
    if (D[i] != 0)
      return {StatusCode::kUnsupported,
              "a lens with a thin prism or a tilted sensor (more than 8 distortion coefficients) is not "
              "supported; calibrate again with rational_polynomial, or undistort the images first"};
  const auto at = [&](std::size_t i) { return i < D.size() ? D[i] : 0.0; };
  lens = {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
  return {};
}

}  // namespace plvo
