// SPDX-License-Identifier: Apache-2.0
#include "plvo/surfaces/surface_sampling.hpp"

#include <array>
#include <span>
#include <utility>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

constexpr int kBins = 7;  // for each of x and y of the normal
constexpr auto kAllBins = static_cast<std::size_t>(kBins * kBins);

std::size_t bin_of(const Vector3& normal) {
  const auto bin = [](double x) {
    const int b = static_cast<int>(0.5 * (x + 1) * kBins);
    return static_cast<std::size_t>(b < kBins ? b : kBins - 1);
  };
  return bin(normal.y()) * kBins + bin(normal.x());
}

// Shuffles the samples, so that their order favours no part of the image.
void shuffle(FixedVector<SurfaceSample>& samples) {
  Random random;
  for (std::size_t i = samples.size(); i > 1; --i)
    std::swap(samples[i - 1], samples[random.below(static_cast<std::uint32_t>(i))]);
}

// Takes the first sample of every bin, then the second of every bin, and so on. turns: scratch; receives the
// number of earlier samples in the same bin.
void take_in_turns(const FixedVector<SurfaceSample>& from, std::span<std::uint16_t> turns,
                   FixedVector<SurfaceSample>& to) {
  std::array<std::uint16_t, kAllBins> seen{};
  for (std::size_t i = 0; i < from.size(); ++i) turns[i] = seen[bin_of(from[i].normal)]++;
  for (std::size_t turn = 0; turn < from.size() && !to.full(); ++turn)
    for (std::size_t i = 0; i < from.size(); ++i)
      if (turns[i] == turn && !to.full()) to.push_back(from[i]);
}

}  // namespace

void sample_surfaces(const DepthSampler& depth, const Pinhole& pinhole, int width, int height,
                     double noise_scale, Arena& scratch, SurfaceFeatures& features, const ImageMask& mask) {
  features.samples.clear();
  if (features.samples.capacity() == 0) return;
  const ScratchScope scope(scratch);
  const auto cells = static_cast<std::size_t>((width / kSurfaceCell + 1) * (height / kSurfaceCell + 1));
  FixedVector<SurfaceSample> candidates(scratch.take<SurfaceSample>("surface candidates", cells));
  SurfaceSample sample;
  for (int y = kSurfaceCell / 2; y < height; y += kSurfaceCell)
    for (int x = kSurfaceCell / 2; x < width; x += kSurfaceCell)
      if (mask.is_free(x, y, 0) && observe_surface(depth, pinhole, x, y, noise_scale, sample))
        candidates.push_back(sample);
  if (candidates.size() > features.samples.capacity()) shuffle(candidates);
  take_in_turns(candidates, scratch.take<std::uint16_t>("turns of surface candidates", cells),
                features.samples);
}

}  // namespace plvo
