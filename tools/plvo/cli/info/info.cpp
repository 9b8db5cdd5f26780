// SPDX-License-Identifier: Apache-2.0
// plvo info: what a recording contains, and what plvo run would take of it.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "plvo/camera/camera_info.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/recording/description.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kInfoHelp =
    "Examples:\n"
    "  plvo info recording.mcap              topics, rates, gaps, calibration, what run would take\n"
    "  plvo info recording.mcap --json -     the same for programs\n"
    "\n"
    "The exit code says whether plvo run would start.\n";

struct InfoOptions {
  std::string recording, json;
  RecordingOptions how;
};

std::string size_of(const DescribedTopic& topic) {
  return topic.width > 0 ? fmt::format("{}x{}", topic.width, topic.height) : std::string();
}

std::string camera_text(const Calibration& calibration) {
  const Pinhole& p = calibration.camera.pinhole;
  return fmt::format("{}x{}, fx {:.6g} fy {:.6g} cx {:.6g} cy {:.6g}, {}", calibration.camera.width,
                     calibration.camera.height, p.fx, p.fy, p.cx, p.cy,
                     calibration.camera.distortion.is_zero()
                         ? "no distortion"
                         : lens_model_name(calibration.camera.distortion));
}

std::string depth_text(const Calibration& calibration) {
  std::string text = fmt::format("{:.6g} units a metre, ", calibration.depth_units_per_metre);
  const DepthCamera& camera = calibration.depth_camera;
  if (!camera.known) return text + "registered to colour";
  return text + fmt::format("of a camera {:.1f} mm from colour: it will be registered",
                            1000 * Vector3(camera.tx, camera.ty, camera.tz).norm());
}

std::string topic_table(const std::vector<DescribedTopic>& topics) {
  std::size_t name = 5, type = 4, encoding = 8;
  for (const DescribedTopic& topic : topics) {
    name = std::max(name, printable(topic.name).size());
    type = std::max(type, printable(topic.type).size());
    encoding = std::max(encoding, printable(topic.encoding).size());
  }
  std::string text = fmt::format("{:<{}}  {:<{}}  {:<{}}  {:>9}  {:>8}  {:>9}  {:>9}  used as\n", "topic",
                                 name, "type", type, "encoding", encoding, "size", "messages", "rate", "gap");
  for (const DescribedTopic& topic : topics)
    text +=
        fmt::format("{:<{}}  {:<{}}  {:<{}}  {:>9}  {:>8}  {:>9}  {:>9}  {}\n", printable(topic.name), name,
                    printable(topic.type), type, printable(topic.encoding), encoding, size_of(topic),
                    topic.messages, topic.rate_hz > 0 ? fmt::format("{:.1f} Hz", topic.rate_hz) : "",
                    topic.longest_gap_s > 0 ? fmt::format("{:.3f} s", topic.longest_gap_s) : "",
                    topic.used_as.empty() ? "-" : topic.used_as);
  return text;
}

std::string page_of(const std::string& recording, const RecordingDescription& d) {
  std::string text = fmt::format("{}: {}, {:.1f} MB, {:.1f} s\n\n", printable(recording), d.format,
                                 static_cast<double>(d.bytes) * 1e-6, d.duration_s);
  text += topic_table(d.topics) + '\n';
  if (d.opens.ok()) {
    text += fmt::format("plvo run takes {} frames ({} colour images have no depth)\n", d.frames,
                        d.unpaired_colour);
    text += fmt::format("  camera  {}\n", camera_text(d.calibration));
    text += fmt::format("  depth   {}\n", depth_text(d.calibration));
    if (d.whole_image.factor > 1)
      text += fmt::format("  scaled down by {} from {}x{}\n", d.whole_image.factor, d.whole_image.width,
                          d.whole_image.height);
  } else {
    text += fmt::format("plvo run cannot start: {}\n", printable(d.opens.message()));
  }
  for (const std::string& what : d.missing) text += fmt::format("  missing: {}\n", what);
  for (const std::string& remark : d.remarks) text += fmt::format("  note: {}\n", printable(remark));
  return text;
}

nlohmann::ordered_json json_of(const std::string& recording, const RecordingDescription& d) {
  nlohmann::ordered_json topics = nlohmann::ordered_json::array();
  for (const DescribedTopic& topic : d.topics)
    topics.push_back({{"name", topic.name},
                      {"type", topic.type},
                      {"encoding", topic.encoding},
                      {"width", topic.width},
                      {"height", topic.height},
                      {"messages", topic.messages},
                      {"rate_hz", topic.rate_hz},
                      {"longest_gap_s", topic.longest_gap_s},
                      {"used_as", topic.used_as}});
  nlohmann::ordered_json json = {{"recording", recording},     {"format", d.format},  {"bytes", d.bytes},
                                 {"duration_s", d.duration_s}, {"topics", topics},    {"opens", d.opens.ok()},
                                 {"missing", d.missing},       {"remarks", d.remarks}};
  if (!d.opens.ok()) {
    json["why_not"] = d.opens.message();
    return json;
  }
  const Pinhole& p = d.calibration.camera.pinhole;
  json["frames"] = d.frames;
  json["unpaired_colour"] = d.unpaired_colour;
  json["camera"] = {{"width", d.calibration.camera.width},
                    {"height", d.calibration.camera.height},
                    {"fx", p.fx},
                    {"fy", p.fy},
                    {"cx", p.cx},
                    {"cy", p.cy},
                    {"lens", lens_model_name(d.calibration.camera.distortion)}};
  json["depth_units_per_metre"] = d.calibration.depth_units_per_metre;
  json["depth_is_registered"] = !d.calibration.depth_camera.known;
  return json;
}

int info_command(const InfoOptions& options) {
  RecordingDescription description;
  if (Status status = describe_recording(options.recording, options.how, description); !status.ok())
    return fail(status);
  const Status written = write_result(options.json, json_of(options.recording, description),
                                      [&] { return page_of(options.recording, description); });
  if (!written.ok()) return fail(written);
  return description.opens.ok() ? kExitSuccess : kExitFailure;
}

void check(const CLI::App& command, const InfoOptions& options) {
  if (is_oni_file(options.recording))
    refuse("recording", "an .oni file is described by OpenNI2's own tools; plvo run FILE.oni tracks it");
  if (!is_bag(options.recording)) refuse_bag_options(command);
  FileRoles files;
  files.writes("--json", options.json);
  CameraOptions camera;
  camera.sequence = options.recording;
  add_inputs(camera, files);
  files.check();
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& command =
      add_command(app, "info", "Show what a recording contains and what run would take", kInfoHelp);
  OptionGroup group(command);
  require(group.path(
      "recording", options->recording,
      "A folder of images, or a recording of ROS: a .bag, an .mcap, a .db3, or a folder of rosbag2",
      "DIR|FILE"));
  add_json_option(command, options->json);
  add_bag_options(command, options->how.topics, BagImu::kWithTruth);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return info_command(*options);
  });
}

}  // namespace plvo::cli
