// SPDX-License-Identifier: Apache-2.0
// Compares our segment detector with OpenCV's LSD on the frames of a TUM folder in one run: segments per
// frame, time and repeatability. A segment is repeatable if its depth and the ground truth can transfer it to
// the next frame (there is depth near both endpoints, and both lie inside the image). It is repeated if a
// segment is found there within 3 px, 5° and half of its length.
//   lsd_compare DIR [--frames N] [--min-length PX] [--draw DIR] [--only-ours]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "plvo/base/arena.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/lines/lsd/lsd.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace {

// CPU time of this process, since other processes may load the machine.
double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Options {
  std::string folder;
  std::string draw;
  int frames = 30;
  double min_length_px = 20;
  bool only_ours = false;
};

struct Line2 {
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  double length() const { return std::hypot(x2 - x1, y2 - y1); }
};

struct Frame {
  cv::Mat gray, depth;
  plvo::Se3 T_world_camera;
};

struct Sequence {
  plvo::Pinhole pinhole;
  double metres_per_unit = 0;
  std::vector<Frame> frames;  // those with ground truth
};

plvo::Status load(const Options& options, Sequence& sequence) {
  const std::filesystem::path folder = options.folder;
  plvo::Calibration calibration;
  plvo::RecordedCamera camera;
  plvo::Trajectory truth;
  if (plvo::Status status = plvo::read_calibration(folder / "calibration.txt", calibration); !status.ok())
    return status;
  if (plvo::Status status = camera.open(folder, calibration); !status.ok()) return status;
  if (plvo::Status status = plvo::read_trajectory({folder / "groundtruth.txt", {}, {}}, truth); !status.ok())
    return status;
  sequence.pinhole = camera.model().pinhole;
  plvo::RgbdFrame image;
  for (int number = 0; number < options.frames; ++number) {
    const plvo::Status status = camera.next(image);
    if (status.code() == plvo::StatusCode::kEndOfStream) break;
    if (!status.ok()) return status;
    const plvo::eval::SampledPoses pose = plvo::eval::sample(truth, {image.stamp_ns}, {});
    if (!pose.valid[0]) continue;
    Frame frame;
    frame.T_world_camera = pose.poses[0];
    // OpenCV's headers require pointers to mutable data even for images that they only read.
    const cv::Mat colour(image.colour.height, image.colour.width, CV_8UC3,
                         const_cast<std::uint8_t*>(image.colour.data));
    cv::cvtColor(colour, frame.gray, cv::COLOR_RGB2GRAY);
    frame.depth =
        cv::Mat(image.depth.height, image.depth.width, CV_16UC1, const_cast<std::uint16_t*>(image.depth.data))
            .clone();
    sequence.metres_per_unit = image.depth.metres_per_unit;
    sequence.frames.push_back(frame);
  }
  return {};
}

// Our detector with its memory and its pyramid.
class Ours {
 public:
  Ours(int width, int height)
      : width_(width),
        height_(height),
        pyramid_bytes_(pyramid_bytes(width, height)),
        memory_(pyramid_bytes_ + plvo::SegmentDetector::scratch_bytes((width + 1) / 2, (height + 1) / 2) +
                4096),
        arena_(memory_),
        detector_((width + 1) / 2, (height + 1) / 2),
        storage_(256) {
    pyramid_.allocate(arena_, width, height);
    pyramid_.init(width, height);
  }

  std::vector<Line2> detect(const cv::Mat& gray, double& ms, double& pyramid_ms) {
    for (int y = 0; y < height_; ++y) std::copy_n(gray.ptr(y), width_, pyramid_.base().row(y));
    const double start = cpu_ms();
    pyramid_.build();
    const double built = cpu_ms();
    segments_ = plvo::FixedVector<plvo::Segment>(storage_);
    const plvo::Status status =
        detector_.detect(pyramid_.level(1), 2.0, pyramid_.level(0), arena_, segments_, &counts_);
    const double end = cpu_ms();
    if (!status.ok()) std::fprintf(stderr, "%s\n", status.message());
    pyramid_ms = built - start;
    ms = end - built;
    std::vector<Line2> lines;
    for (const plvo::Segment& s : segments_) lines.push_back({s.a.x(), s.a.y(), s.b.x(), s.b.y()});
    return lines;
  }
  const plvo::SegmentCounts& counts() const { return counts_; }
  std::size_t dropped() const { return segments_.dropped(); }
  const plvo::FixedVector<plvo::Segment>& segments() const { return segments_; }

 private:
  static std::size_t pyramid_bytes(int width, int height) {
    plvo::Arena sizer = plvo::Arena::counting();
    plvo::Pyramid pyramid;
    pyramid.allocate(sizer, width, height);
    return sizer.peak();
  }
  int width_;
  int height_;
  std::size_t pyramid_bytes_;
  std::vector<std::byte> memory_;
  plvo::Arena arena_;
  plvo::Pyramid pyramid_;
  plvo::SegmentDetector detector_;
  std::vector<plvo::Segment> storage_;
  plvo::FixedVector<plvo::Segment> segments_;
  plvo::SegmentCounts counts_;
};

double depth_near(const Frame& frame, double metres_per_unit, double x, double y) {
  // Takes the nearest surface in the neighbourhood: a segment on a silhouette belongs to the surface in
  // front.
  std::uint16_t best = 0;
  for (int j = -2; j <= 2; ++j) {
    for (int i = -2; i <= 2; ++i) {
      const int u = static_cast<int>(x + 0.5) + i;
      const int v = static_cast<int>(y + 0.5) + j;
      if (u < 0 || v < 0 || u >= frame.depth.cols || v >= frame.depth.rows) continue;
      const std::uint16_t d = frame.depth.at<std::uint16_t>(v, u);
      if (d != 0 && (best == 0 || d < best)) best = d;
    }
  }
  return best * metres_per_unit;
}

bool carry(const Sequence& sequence, const Frame& from, const Frame& to, double x, double y, double& u,
           double& v) {
  const double d = depth_near(from, sequence.metres_per_unit, x, y);
  if (d <= 0) return false;
  const plvo::Vector3 p =
      to.T_world_camera.inverse() * (from.T_world_camera * plvo::back_project(sequence.pinhole, x, y, d));
  if (p.z() <= 0.1) return false;
  const plvo::Vector2 pixel = plvo::project(sequence.pinhole, p);
  u = pixel.x();
  v = pixel.y();
  return u >= 0 && v >= 0 && u <= to.gray.cols - 1 && v <= to.gray.rows - 1;
}

struct Difference {
  double degrees = 0;
  double distance_px = 0;  // from the midpoint of b to the line a
};

// True if b is the same segment as a, with the same direction.
bool same(const Line2& a, const Line2& b, Difference& difference) {
  const double la = a.length();
  const double dx = (a.x2 - a.x1) / la;
  const double dy = (a.y2 - a.y1) / la;
  const double along = (b.x2 - b.x1) * dx + (b.y2 - b.y1) * dy;
  const double across = (b.y2 - b.y1) * dx - (b.x2 - b.x1) * dy;
  difference.degrees = std::abs(std::atan2(across, along)) * 180 / 3.14159265358979;
  difference.distance_px = std::abs((0.5 * (b.y1 + b.y2) - a.y1) * dx - (0.5 * (b.x1 + b.x2) - a.x1) * dy);
  if (difference.degrees > 5 || difference.distance_px > 3) return false;
  const double s = (b.x1 - a.x1) * dx + (b.y1 - a.y1) * dy;
  const double e = (b.x2 - a.x1) * dx + (b.y2 - a.y1) * dy;
  return std::min(std::max(s, e), la) - std::max(std::min(s, e), 0.0) >= 0.5 * std::min(la, b.length());
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Score {
  int repeatable = 0;
  int repeated = 0;
  std::size_t segments = 0;
  std::vector<double> ms;
  std::vector<double> degrees;
  std::vector<double> distances_px;

  void compare(const Options& options, const Sequence& sequence, const Frame& from, const Frame& to,
               const std::vector<Line2>& before, const std::vector<Line2>& now) {
    for (const Line2& line : before) {
      Line2 carried;
      if (line.length() < options.min_length_px) continue;
      if (!carry(sequence, from, to, line.x1, line.y1, carried.x1, carried.y1) ||
          !carry(sequence, from, to, line.x2, line.y2, carried.x2, carried.y2) || carried.length() < 5) {
        continue;
      }
      ++repeatable;
      for (const Line2& other : now) {
        Difference difference;
        if (!same(carried, other, difference)) continue;
        ++repeated;
        degrees.push_back(difference.degrees);
        distances_px.push_back(difference.distance_px);
        break;
      }
    }
  }
  void print(const char* name, std::size_t frames, double reference_ms) {
    const double typical = median(ms);  // sorts ms
    std::printf("| %-22s | %6.1f | %6d | %6.1f %% | %5.2f | %5.2f | %6.2f | %6.2f | %6.1f |\n", name,
                static_cast<double>(segments) / static_cast<double>(frames), repeatable,
                100.0 * repeated / std::max(1, repeatable), median(degrees), median(distances_px), typical,
                ms.back(), typical / reference_ms);
  }
};

void draw(const Options& options, std::size_t i, const cv::Mat& gray, const std::vector<Line2>& lines,
          const char* who) {
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  cv::resize(picture, picture, {}, 2, 2, cv::INTER_NEAREST);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const Line2& l = lines[k];
    const cv::Scalar palette[] = {{80, 255, 80}, {255, 160, 0}, {60, 60, 255}, {0, 220, 255}, {255, 0, 255}};
    const cv::Scalar& colour = palette[k % 5];
    const auto at = [](double x, double y) {
      return cv::Point(static_cast<int>(16 * (2 * x + 0.5)), static_cast<int>(16 * (2 * y + 0.5)));
    };
    cv::line(picture, at(l.x1, l.y1), at(l.x2, l.y2), colour, 1, cv::LINE_AA, 4);
    cv::circle(picture, at(l.x1, l.y1), 32, colour, 1, cv::LINE_AA, 4);
  }
  cv::imwrite(options.draw + "/" + who + std::to_string(i) + ".png", picture);
}

std::size_t count_long(const Options& options, const std::vector<Line2>& lines) {
  std::size_t n = 0;
  for (const Line2& line : lines) n += line.length() >= options.min_length_px ? 1 : 0;
  return n;
}

std::vector<Line2> opencv_lines(cv::LineSegmentDetector& detector, const cv::Mat& gray, double& ms) {
  std::vector<cv::Vec4f> found;
  const double start = cpu_ms();
  detector.detect(gray, found);
  ms = cpu_ms() - start;
  std::vector<Line2> lines;
  for (const cv::Vec4f& v : found) {
    lines.push_back({static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]),
                     static_cast<double>(v[3])});
  }
  return lines;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool more = i + 1 < argc;
    if (word == "--frames" && more) {
      options.frames = std::atoi(argv[++i]);
    } else if (word == "--min-length" && more) {
      options.min_length_px = std::atof(argv[++i]);
    } else if (word == "--draw" && more) {
      options.draw = argv[++i];
    } else if (word == "--only-ours") {
      options.only_ours = true;
    } else {
      options.folder = word;
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Sequence sequence;
  if (const plvo::Status status = load(options, sequence); !status.ok()) {
    std::fprintf(stderr, "lsd_compare: %s\n", status.message());
    return 1;
  }
  const std::vector<Frame>& frames = sequence.frames;
  if (frames.empty()) {
    std::fprintf(stderr, "lsd_compare: no frame of '%s' has ground truth\n", options.folder.c_str());
    return 1;
  }
  cv::setNumThreads(1);
  Ours ours(frames[0].gray.cols, frames[0].gray.rows);
  const auto cv80 = cv::createLineSegmentDetector(cv::LSD_REFINE_STD, 0.8);
  const auto cv50 = cv::createLineSegmentDetector(cv::LSD_REFINE_STD, 0.5);
  Score scores[3];
  std::vector<Line2> before[3];
  std::vector<double> pyramid_ms;
  double regions = 0, dense = 0, meaningful = 0, directed = 0, grown = 0, dropped = 0, placed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<Line2> now[3];
    double ms[3] = {0, 0, 0};
    double build_ms = 0;
    now[0] = ours.detect(frames[i].gray, ms[0], build_ms);
    pyramid_ms.push_back(build_ms);
    const plvo::SegmentCounts& counts = ours.counts();
    directed += counts.directed_pixels;
    regions += counts.regions;
    dense += counts.dense;
    meaningful += counts.meaningful;
    placed += counts.placed;
    grown += static_cast<double>(counts.grown_pixels);
    dropped += static_cast<double>(ours.dropped());
    if (!options.only_ours) {
      now[1] = opencv_lines(*cv80, frames[i].gray, ms[1]);
      now[2] = opencv_lines(*cv50, frames[i].gray, ms[2]);
    }
    for (int k = 0; k < (options.only_ours ? 1 : 3); ++k) {
      scores[k].ms.push_back(ms[k]);
      scores[k].segments += count_long(options, now[k]);
      if (i > 0) scores[k].compare(options, sequence, frames[i - 1], frames[i], before[k], now[k]);
      before[k] = now[k];
    }
    if (!options.draw.empty() && i % 10 == 0) {
      draw(options, i, frames[i].gray, now[0], "ours");
      if (!options.only_ours) draw(options, i, frames[i].gray, now[1], "opencv");
    }
  }
  const auto n = static_cast<double>(frames.size());
  std::printf("%s, %zu frames; segments of at least %.0f px\n", options.folder.c_str(), frames.size(),
              options.min_length_px);
  std::printf(
      "| detector               | number | tested | repeated | deg   | px    | med ms | max ms | time × |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  const double reference = median(scores[0].ms);
  const char* const names[] = {"ours, half, refined", "OpenCV LSD, scale 0.8", "OpenCV LSD, scale 0.5"};
  for (int k = 0; k < (options.only_ours ? 1 : 3); ++k) scores[k].print(names[k], frames.size(), reference);
  std::printf(
      "ours, mean per frame: %.0f pixels with a direction, %.0f additions to regions, %.0f regions, %.0f "
      "tested, %.0f "
      "meaningful, %.0f dropped, %.0f placed; pyramid (shared with the points) %.2f ms, not included above\n",
      directed / n, grown / n, regions / n, dense / n, meaningful / n, dropped / n, placed / n,
      median(pyramid_ms));
  return 0;
}
