// SPDX-License-Identifier: Apache-2.0
// OpenCV's detectors with their default settings, in one thread.
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>
#include <opencv2/ximgproc/fast_line_detector.hpp>

#include "plvo/bench/detectors/detector.hpp"

namespace plvo::bench {
namespace {

// OpenCV's headers require pointers to mutable data even for images that they only read.
cv::Mat as_mat(const GrayView& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

std::vector<Line> to_lines(const std::vector<cv::Vec4f>& found) {
  std::vector<Line> lines;
  for (const cv::Vec4f& v : found)
    lines.push_back({Vector2(static_cast<double>(v[0]), static_cast<double>(v[1])),
                     Vector2(static_cast<double>(v[2]), static_cast<double>(v[3]))});
  return lines;
}

std::vector<FoundPoint> to_points(const std::vector<cv::KeyPoint>& found) {
  std::vector<FoundPoint> points;
  for (const cv::KeyPoint& k : found)
    points.push_back(
        {Vector2(static_cast<double>(k.pt.x), static_cast<double>(k.pt.y)), static_cast<double>(k.response)});
  return points;
}

}  // namespace

std::vector<SegmentFinder> opencv_segment_finders() {
  cv::setNumThreads(1);
  const auto lsd = cv::createLineSegmentDetector();
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  const auto fast_lines = cv::ximgproc::createFastLineDetector();
  return {{"OpenCV LSD",
           [lsd](const GrayView& image) {
             std::vector<cv::Vec4f> found;
             lsd->detect(as_mat(image), found);
             return to_lines(found);
           }},
          {"OpenCV EDLines",
           [drawing](const GrayView& image) {
             std::vector<cv::Vec4f> found;
             drawing->detectEdges(as_mat(image));
             drawing->detectLines(found);
             return to_lines(found);
           }},
          {"OpenCV FastLineDetector", [fast_lines](const GrayView& image) {
             std::vector<cv::Vec4f> found;
             fast_lines->detect(as_mat(image), found);
             return to_lines(found);
           }}};
}

std::vector<PointFinder> opencv_point_finders(const DetectorCapacity& capacity) {
  cv::setNumThreads(1);
  const auto orb = cv::ORB::create(capacity.keypoints);
  const auto fast = cv::FastFeatureDetector::create();
  return {{"OpenCV ORB",
           [orb](const GrayView& image) {
             std::vector<cv::KeyPoint> found;
             orb->detect(as_mat(image), found);
             return to_points(found);
           }},
          {"OpenCV FAST", [fast](const GrayView& image) {
             std::vector<cv::KeyPoint> found;
             fast->detect(as_mat(image), found);
             return to_points(found);
           }}};
}

}  // namespace plvo::bench
