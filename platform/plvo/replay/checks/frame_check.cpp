// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/checks/frame_check.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace plvo {
namespace {

constexpr int kPixelStep = 3;  // columns and rows; odd, because some sensors leave every second one empty
constexpr int kBlack = 20;     // grey levels: black images have no brighter pixel
constexpr int kLeastContrast = 10;  // grey levels between the darkest and the brightest pixel
constexpr double kEmpty = 0.005;
constexpr double kFarMedian_m = 8;
// In a recording that is too deep by a factor of five, even the nearest depth is large.
constexpr double kFarNearest_m = 3, kFarFarthest_m = 8;
constexpr double kNearFarthest_m = 1;

}  // namespace

std::vector<std::string> FrameCheck::add(const RgbdFrame& frame) {
  if (done_) return {};
  look(frame);
  return frames_ < kFrames ? std::vector<std::string>() : finish();
}

void FrameCheck::look(const RgbdFrame& frame) {
  ++frames_;
  const ColourView& colour = frame.colour;
  const DepthView& depth = frame.depth;
  const std::ptrdiff_t row_bytes =
      colour.width * (colour.format == PixelFormat::kGray8 ? std::ptrdiff_t{1} : std::ptrdiff_t{3});
  for (int y = 0; y < colour.height; y += kPixelStep) {
    const std::uint8_t* row = colour.data + y * colour.stride_bytes;
    const auto [least, most] = std::minmax_element(row, row + row_bytes);
    darkest_ = std::min<int>(darkest_, *least);
    brightest_ = std::max<int>(brightest_, *most);
  }
  units_per_metre_ = 1 / depth.metres_per_unit;
  const double bins_per_unit = depth.metres_per_unit / kBin_m;
  for (int y = 0; y < depth.height; y += kPixelStep) {
    const std::uint16_t* row = depth.data + y * depth.stride;
    for (int x = 0; x < depth.width; x += kPixelStep) {
      ++pixels_;
      if (row[x] == 0) continue;
      ++depths_;
      ++histogram_[std::min(static_cast<std::size_t>(row[x] * bins_per_unit), kBins - 1)];
    }
  }
  edges_.add(frame);
}

double FrameCheck::depth_quantile(double share) const {
  const double wanted = share * static_cast<double>(depths_);
  std::uint64_t seen = 0;
  std::size_t bin = 0;
  while (bin < kBins - 1 && static_cast<double>(seen += histogram_[bin]) < wanted) ++bin;
  return static_cast<double>(bin + 1) * kBin_m;
}

std::string FrameCheck::finding_of_unit() const {
  const double median = depth_quantile(0.5), farthest = depth_quantile(0.999);
  std::string what;
  if (median > kFarMedian_m) {
    what = fmt::format("half of the depth lies beyond {:.1f} m", median);
  } else if (depth_quantile(0.05) > kFarNearest_m && depth_quantile(0.99) > kFarFarthest_m) {
    what = fmt::format("depth begins at {:.1f} m and reaches {:.1f} m", depth_quantile(0.05),
                       depth_quantile(0.99));
  } else if (farthest <= kNearFarthest_m) {
    what = fmt::format("no depth lies beyond {:.2f} m", farthest);
  } else {
    return {};
  }
  return fmt::format(
      "{}: is the unit of depth right? {:.0f} units per metre are used; TUM recordings have 5000, "
      "millimetres are 1000 (depth_scale in a calibration, --depth-scale for recordings)",
      what, units_per_metre_);
}

std::string FrameCheck::finding_of_colour() const {
  const char* remedy = "is the lens covered, or the exposure wrong?";
  if (brightest_ <= kBlack)
    return fmt::format(
        "the colour images are black: of the first {} frames no pixel is brighter than {} of 255; {}",
        frames_, brightest_, remedy);
  if (brightest_ - darkest_ <= kLeastContrast)
    return fmt::format(
        "the colour images show nothing: of the first {} frames all pixels lie between {} and {}; {}",
        frames_, darkest_, brightest_, remedy);
  return {};
}

std::vector<std::string> FrameCheck::finish() {
  std::vector<std::string> findings;
  if (done_ || frames_ == 0) return findings;
  done_ = true;
  if (const std::string colour = finding_of_colour(); !colour.empty()) findings.push_back(colour);
  const double share = static_cast<double>(depths_) / static_cast<double>(pixels_);
  if (share < kEmpty) {
    findings.push_back(
        fmt::format("the depth images are empty: of the first {} frames {:.2f} % of the pixels have depth; "
                    "is anything within the sensor's range, and was depth recorded?",
                    frames_, 100 * share));
    return findings;
  }
  if (const std::string unit = finding_of_unit(); !unit.empty()) findings.push_back(unit);
  if (const std::string misfit = edges_.misfit(); !misfit.empty())
    findings.push_back(
        fmt::format("depth looks {0} against colour: its edges agree with those of colour {0}, not as it is; "
                    "flip or rotate the images of one of the two",
                    misfit));
  return findings;
}

}  // namespace plvo
