// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include "plvo/base/arena.hpp"
#include "plvo/bench/detectors/detector.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/lines/lsd/lsd.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/points/detector.hpp"

namespace plvo::bench {
namespace {

// A pyramid and the scratch memory of both detectors.
class Ground {
 public:
  explicit Ground(const DetectorCapacity& capacity) : memory_(bytes(capacity)), arena_(memory_) {
    pyramid_.allocate(arena_, capacity.width, capacity.height);
    pyramid_.init(capacity.width, capacity.height);
  }
  const Pyramid& build(const GrayView& image) {
    for (int y = 0; y < image.height; ++y) std::copy_n(image.row(y), image.width, pyramid_.base().row(y));
    pyramid_.build();
    return pyramid_;
  }
  Arena& scratch() { return arena_; }

 private:
  static std::size_t bytes(const DetectorCapacity& capacity) {
    Arena sizer = Arena::counting();
    Pyramid pyramid;
    pyramid.allocate(sizer, capacity.width, capacity.height);
    {
      const ScratchScope scope(sizer);
      reserve_detection(sizer, capacity.width, capacity.height);
    }
    return sizer.peak() +
           SegmentDetector::scratch_bytes((capacity.width + 1) / 2, (capacity.height + 1) / 2) + 4096;
  }
  std::vector<std::byte> memory_;
  Arena arena_;
  Pyramid pyramid_;
};

}  // namespace

SegmentFinder own_segment_finder(const DetectorCapacity& capacity) {
  const auto ground = std::make_shared<Ground>(capacity);
  const auto storage = std::make_shared<std::vector<Segment>>(static_cast<std::size_t>(capacity.segments));
  const SegmentDetector detector((capacity.width + 1) / 2, (capacity.height + 1) / 2);
  return {"plvo (LSD at half size)", [=](const GrayView& image) {
            const Pyramid& pyramid = ground->build(image);
            FixedVector<Segment> segments(*storage);
            std::vector<Line> lines;
            if (!detector.detect(pyramid.level(1), 2, pyramid.level(0), ground->scratch(), segments).ok())
              return lines;
            for (const Segment& segment : segments) lines.push_back({segment.a, segment.b});
            return lines;
          }};
}

PointFinder own_point_finder(const DetectorCapacity& capacity) {
  const auto ground = std::make_shared<Ground>(capacity);
  const auto storage = std::make_shared<std::vector<Keypoint>>(static_cast<std::size_t>(capacity.keypoints));
  // Our detector skips pixels without depth; here every pixel has a depth.
  const auto depth = std::make_shared<std::vector<std::uint16_t>>(
      static_cast<std::size_t>(capacity.width) * static_cast<std::size_t>(capacity.height),
      std::uint16_t{1000});
  const auto map = std::make_shared<UndistortionMap>();
  return {"plvo", [=](const GrayView& image) {
            const Pyramid& pyramid = ground->build(image);
            const DepthSampler sampler({depth->data(), image.width, image.height, image.width}, *map,
                                       DepthNoise{});
            FixedVector<Keypoint> keypoints(*storage);
            detect_keypoints(pyramid, sampler, DetectorConfig{}, ground->scratch(), keypoints);
            std::vector<FoundPoint> points;
            for (const Keypoint& keypoint : keypoints)
              points.push_back({Vector2(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)),
                                static_cast<double>(keypoint.strength)});
            return points;
          }};
}

}  // namespace plvo::bench
