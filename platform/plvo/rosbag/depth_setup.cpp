// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/depth_setup.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

constexpr std::size_t kMostTransforms = 2000;

// "/device_0/sensor_1/Color_0" of "/device_0/sensor_1/Color_0/image/data"; empty for other topics.
std::string_view librealsense_stream(std::string_view topic) {
  constexpr std::string_view kStart = "/device_", kEnd = "/image/data";
  return topic.starts_with(kStart) && topic.ends_with(kEnd) ? topic.substr(0, topic.size() - kEnd.size())
                                                            : std::string_view();
}

std::optional<Se3> first_transform(MessageFile& bag, std::size_t topic) {
  std::vector<unsigned char> bytes;
  Se3 transform;
  if (bag.messages(topic).empty() || !bag.read(bag.messages(topic).front(), bytes).ok()) return {};
  if (!parse_transform(bag.topics()[topic].wire, bytes, transform).ok()) return {};
  return transform;
}

std::optional<std::size_t> topic_named(const MessageFile& bag, std::string_view name, std::string_view type) {
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
    if (bag.topics()[i].name == name && bag.topics()[i].type == type) return i;
  return {};
}

// From depth to colour by a point of reference that both streams have.
std::optional<Se3> librealsense_transform(MessageFile& bag, std::string_view colour, std::string_view depth) {
  const std::string of_colour = std::string(colour) + "/tf/";
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const BagTopic& topic = bag.topics()[i];
    if (topic.type != kTransformType || !topic.name.starts_with(of_colour)) continue;
    const std::string group = topic.name.substr(of_colour.size());
    const auto other = topic_named(bag, std::string(depth) + "/tf/" + group, kTransformType);
    if (!other) continue;
    const auto T_colour_group = first_transform(bag, i), T_depth_group = first_transform(bag, *other);
    if (T_colour_group && T_depth_group) return *T_colour_group * T_depth_group->inverse();
  }
  return {};
}

// The value of the option Depth Units of the sensor that depth belongs to.
std::optional<double> librealsense_units(MessageFile& bag, std::string_view depth) {
  const std::string sensor(depth.substr(0, depth.rfind('/')));
  for (const char* name : {"/option/Depth Units/value", "/option/Depth_Units/value"}) {
    const auto topic = topic_named(bag, sensor + name, kFloatType);
    std::vector<unsigned char> bytes;
    float metres = 0;
    if (!topic || bag.messages(*topic).empty() || !bag.read(bag.messages(*topic).front(), bytes).ok())
      continue;
    if (!parse_float(bag.topics()[*topic].wire, bytes, metres).ok() || !(metres > 0)) continue;
    // A float is not exactly a thousandth.
    const double units = 1 / static_cast<double>(metres), whole = std::round(units);
    return std::abs(units - whole) < 1e-4 * units ? whole : units;
  }
  return {};
}

struct Edge {
  std::string parent, child;
  Se3 T_parent_child;
};

std::vector<Edge> recorded_transforms(MessageFile& bag) {
  std::vector<Edge> edges;
  std::vector<unsigned char> bytes;
  for (const bool fixed : {true, false}) {
    for (std::size_t i = 0; i < bag.topics().size(); ++i) {
      const BagTopic& topic = bag.topics()[i];
      if (topic.type != kTransformsType && topic.type != "tf/tfMessage") continue;
      if (topic.name.ends_with("tf_static") != fixed) continue;
      for (const BagMessage& message : bag.messages(i)) {
        std::vector<FrameTransform> transforms;
        if (!bag.read(message, bytes).ok() || !parse_transforms(topic.wire, bytes, transforms).ok()) continue;
        for (const FrameTransform& t : transforms)
          if (edges.size() < kMostTransforms)
            edges.push_back({std::string(t.parent), std::string(t.child), t.T_parent_child});
      }
    }
  }
  return edges;
}

// Searches a way through the transforms, breadth first.
std::optional<Se3> way_between(const std::vector<Edge>& edges, const std::string& to,
                               const std::string& from) {
  struct Place {
    std::string frame;
    Se3 T_place_from;
  };
  std::vector<Place> places = {{from, {}}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].frame == to) return places[i].T_place_from;
    for (const Edge& edge : edges) {
      const bool up = edge.child == places[i].frame;
      if (!up && edge.parent != places[i].frame) continue;
      const std::string& next = up ? edge.parent : edge.child;
      if (std::any_of(places.begin(), places.end(), [&](const Place& p) { return p.frame == next; }))
        continue;
      const Se3 step = up ? edge.T_parent_child : edge.T_parent_child.inverse();
      places.push_back({next, step * places[i].T_place_from});
    }
  }
  return {};
}

std::optional<Calibration> calibration_of(MessageFile& bag, std::optional<std::size_t> topic) {
  std::vector<unsigned char> bytes;
  Calibration calibration;
  if (!topic || bag.messages(*topic).empty() || !bag.read(bag.messages(*topic).front(), bytes).ok())
    return {};
  if (!parse_camera_info(bag.topics()[*topic].wire, bytes, calibration).ok()) return {};
  return calibration;
}

bool same_view(const TopicChoice& topics, const std::optional<Calibration>& colour, const Calibration& depth,
               const Se3& T_colour_depth) {
  const TopicChoice::Images &a = topics.images(topics.colour()), &b = topics.images(topics.depth());
  if (!colour || a.width != b.width || a.height != b.height) return false;
  const Pinhole &p = colour->camera.pinhole, &q = depth.camera.pinhole;
  return p.fx == q.fx && p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && T_colour_depth.t.isZero(1e-6) &&
         T_colour_depth.R.isIdentity(1e-6);
}

DepthCamera camera_of(const Pinhole& pinhole, const Se3& T_camera_depth) {
  DepthCamera camera;
  camera.known = true;
  camera.pinhole = pinhole;
  camera.tx = T_camera_depth.t.x();
  camera.ty = T_camera_depth.t.y();
  camera.tz = T_camera_depth.t.z();
  const Quaternion q = to_quaternion(T_camera_depth.R);
  camera.qx = q.x;
  camera.qy = q.y;
  camera.qz = q.z;
  camera.qw = q.w;
  return camera;
}

}  // namespace

DepthSetup find_depth_setup(MessageFile& bag, const TopicChoice& topics) {
  DepthSetup setup;
  const std::string &colour_name = bag.topics()[topics.colour()].name,
                    &depth_name = bag.topics()[topics.depth()].name;
  const std::string_view colour_stream = librealsense_stream(colour_name),
                         depth_stream = librealsense_stream(depth_name);
  const bool librealsense = !colour_stream.empty() && !depth_stream.empty();
  if (librealsense) setup.units_per_metre = librealsense_units(bag, depth_stream);
  if (!librealsense && topics.same_frame()) return setup;
  const std::string &colour_frame = topics.images(topics.colour()).frame,
                    &depth_frame = topics.images(topics.depth()).frame;
  if (!librealsense && (colour_frame.empty() || depth_frame.empty())) return setup;
  const std::optional<Se3> T_colour_depth =
      librealsense ? librealsense_transform(bag, colour_stream, depth_stream)
                   : way_between(recorded_transforms(bag), colour_frame, depth_frame);
  const std::optional<Calibration> depth = calibration_of(bag, topics.depth_info());
  const std::string whose = librealsense ? fmt::format("{} is depth of a camera of its own", depth_name)
                                         : fmt::format("the frame of depth, {}, is not that of colour, {}",
                                                       depth_frame, colour_frame);
  if (!T_colour_depth || !depth || !depth->camera.distortion.is_zero()) {
    setup.remark = fmt::format("{}, but {}: depth is taken as registered to colour", whose,
                               !depth           ? "depth has no usable camera_info"
                               : T_colour_depth ? "its lens has a distortion"
                                                : "no transform from one to the other was recorded");
    return setup;
  }
  if (same_view(topics, calibration_of(bag, topics.colour_info()), *depth, *T_colour_depth)) return setup;
  setup.camera = camera_of(depth->camera.pinhole, *T_colour_depth);
  setup.remark = fmt::format("{}: it is registered to colour with the calibration in the recording", whose);
  return setup;
}

}  // namespace plvo
