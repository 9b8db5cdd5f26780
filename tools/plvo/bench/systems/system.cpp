// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/systems/system.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "plvo/odometry/odometry.hpp"

namespace plvo::bench {
namespace {

constexpr const char* kPaperSuffix = "-paper";

class PlvoSystem final : public System {
 public:
  Status init(const CameraModel& camera, const Config& config) {
    Limits limits;
    limits.width = camera.width;
    limits.height = camera.height;
    memory_.resize(required_bytes(limits) + kArenaAlignment);
    return odometry_.init(memory_, camera, config, limits);
  }
  void prepare(const RgbdFrame& frame) override { frame_ = frame; }
  bool track() override {
    result_ = odometry_.track(frame_);
    return result_.state != TrackState::kLost;
  }
  Se3 pose() const override { return result_.T_world_camera; }

 private:
  std::vector<std::byte> memory_;
  Odometry odometry_;
  RgbdFrame frame_;
  TrackResult result_;
};

bool is_paper(const std::string& name) { return name.find(kPaperSuffix) != std::string::npos; }

bool is_group(const std::string& word) {
  return word == "all" || word == "ours" || word == "paper" || word == "peers" || word == "opencv" ||
         word == "open3d";
}

bool in_group(const std::string& group, const std::string& name) {
  if (group == "all") return true;
  if (group == "ours") return name.starts_with("plvo-") && !is_paper(name);
  if (group == "paper") return is_paper(name);
  if (group == "peers") return !name.starts_with("plvo-");
  return (group == "opencv" || group == "open3d") && name.starts_with(group + '-');
}

}  // namespace

const std::vector<std::string>& system_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const char* suffix : {"", kPaperSuffix})
      for (const char* features : {"points", "lines", "both"})
        all.push_back(fmt::format("plvo-{}{}", features, suffix));
    if (!opencv_version().empty()) all.insert(all.end(), {"opencv-rgbd", "opencv-icp", "opencv-rgbdicp"});
    if (!open3d_version().empty()) all.push_back("open3d-hybrid");
    return all;
  }();
  return names;
}

Status parse_systems(const std::vector<std::string>& words, std::vector<std::string>& names) {
  names.clear();
  for (const std::string& word : words) {
    bool known = is_group(word);  // a group is known even if none of its systems was built
    for (const std::string& name : system_names()) {
      if (name != word && !in_group(word, name)) continue;
      known = true;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    if (!known) {
      return {StatusCode::kInvalidArgument,
              fmt::format("no system '{}' in this build; there are all, ours, paper, peers, {}", word,
                          fmt::join(system_names(), ", "))};
    }
  }
  if (names.empty()) return {StatusCode::kInvalidArgument, "no system of those named is in this build"};
  return {};
}

Status make_system(const std::string& name, const CameraModel& camera, std::unique_ptr<System>& system) {
  const auto& names = system_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    return {StatusCode::kInvalidArgument, fmt::format("no system '{}' in this build", name)};
  if (name.starts_with("opencv-")) {
    system = make_opencv_system(name, camera);
    return {};
  }
  if (name.starts_with("open3d-")) {
    system = make_open3d_system(camera);
    return {};
  }
  Config config = is_paper(name) ? Config::paper() : Config();
  config.features = name.starts_with("plvo-points")  ? Features::kPoints
                    : name.starts_with("plvo-lines") ? Features::kLines
                                                     : Features::kBoth;
  if (config.features != Features::kBoth) config.surfaces = false;  // only this kind of features
  auto ours = std::make_unique<PlvoSystem>();
  const Status status = ours->init(camera, config);
  if (status.ok()) system = std::move(ours);
  return status;
}

}  // namespace plvo::bench
