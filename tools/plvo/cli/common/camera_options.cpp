// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/camera_options.hpp"

#include <fmt/core.h>

#include <charconv>
#include <climits>

#include "plvo/replay/tum_camera.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::cli {
namespace {

namespace fs = std::filesystem;

bool parse_count(std::string_view text, std::size_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string check_frame_range(const std::string& text) {
  FrameRange range;
  return parse_frame_range(text, range)
             ? ""
             : "expected first:end, such as 0:100, 50: or :20, with first < end: " + text;
}

std::string builtin_names() {
  std::string names;
  for (std::string_view name : builtin_calibration_names())
    names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

Status open_tum(const CameraOptions& options, OpenedCamera& opened) {
  const fs::path folder = options.folder;
  FrameRange range;
  if (!options.frames.empty() && !parse_frame_range(options.frames, range))
    return {StatusCode::kInvalidArgument, "the frame range must be first:end"};
  // A folder that is no sequence should be told so before a missing calibration is.
  TumOptions tum;
  tum.associations = options.associations;
  tum.tolerance_ns = static_cast<std::int64_t>(options.tolerance_s * 1e9);
  tum.first_frame = range.first;
  tum.end_frame = range.end;
  TumIndex index;
  if (Status status = read_tum_index(folder, tum.associations, tum.tolerance_ns, index); !status.ok())
    return status;
  Calibration calibration;
  if (Status status = find_calibration(options.calibration, folder, calibration); !status.ok()) return status;
  auto camera = std::make_unique<TumCamera>();
  if (Status status = camera->open(folder, calibration, tum); !status.ok()) return status;
  opened.frame_count = camera->frame_count();
  opened.unpaired_images = index.unpaired_colour;
  opened.name = folder.lexically_normal().filename().empty()
                    ? folder.lexically_normal().parent_path().filename().string()
                    : folder.lexically_normal().filename().string();
  std::error_code error;
  if (const fs::path truth_file = folder / "groundtruth.txt"; fs::exists(truth_file, error)) {
    opened.ground_truth = [truth_file](const std::vector<std::int64_t>&, eval::Trajectory& truth) {
      return eval::read_trajectory({truth_file, {}, {}}, truth);
    };
  }
  opened.camera = std::move(camera);
  return {};
}

constexpr int kSimulatedFrames = 300;

Status open_simulator(const CameraOptions& options, OpenedCamera& opened) {
  FrameRange range;
  range.end = kSimulatedFrames;
  if (!options.frames.empty() &&
      (!parse_frame_range(options.frames, range) || range.first != 0 || range.end > INT_MAX))
    return {StatusCode::kInvalidArgument,
            "a simulated walk starts at frame 0 and has an end: give --frames :100"};
  SimulatorOptions settings;
  std::unique_ptr<SimulatedCamera> camera;
  Status status = make_simulator_options(options.simulator, static_cast<int>(range.end), settings);
  if (status.ok()) status = SimulatedCamera::create(settings, camera);
  if (!status.ok()) return status;
  opened.frame_count = static_cast<std::size_t>(camera->frames());
  opened.name =
      fmt::format("sim {} {} seed {}", to_string(settings.scene), to_string(settings.light), settings.seed);
  opened.ground_truth = [simulated = camera.get()](const std::vector<std::int64_t>& stamps,
                                                   eval::Trajectory& truth) {
    for (std::int64_t stamp : stamps) truth.poses.push_back({stamp, simulated->ground_truth(stamp)});
    return Status();
  };
  opened.camera = std::move(camera);
  return {};
}

}  // namespace

bool parse_frame_range(const std::string& text, FrameRange& range) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return false;
  const std::string_view first = std::string_view(text).substr(0, colon);
  const std::string_view end = std::string_view(text).substr(colon + 1);
  FrameRange result;
  if (!first.empty() && !parse_count(first, result.first)) return false;
  if (!end.empty() && !parse_count(end, result.end)) return false;
  if (result.first >= result.end) return false;
  range = result;
  return true;
}

void add_calibration_options(CLI::App& command, CalibrationOptions& options, const std::string& group,
                             DepthScale depth_scale) {
  command
      .add_option(
          "--calibration", options.file,
          "calibration.txt (fx fy cx cy depth_scale [k1 k2 p1 p2 k3 [readout_s]]) or ROS camera_info YAML")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--camera-model", options.model_name, "A camera by name: " + builtin_names())
      ->type_name("NAME")
      ->group(group);
  const auto number = [&](const char* name, std::optional<double>& value, const char* what) {
    command.add_option(name, value, what)->type_name("NUMBER")->group(group);
  };
  number("--fx", options.fx, "Focal length, px");
  number("--fy", options.fy, "Focal length, px");
  number("--cx", options.cx, "Principal point, px");
  number("--cy", options.cy, "Principal point, px");
  if (depth_scale == DepthScale::kAsked)
    number("--depth-scale", options.depth_scale,
           "Units of the depth images per metre (default 5000; 1000 for mm)");
  number("--readout", options.readout_s,
         "Rolling shutter: seconds from the first row to the last (Kinect v1: 0.0261; 0: global shutter)");
  command.add_option("--distortion", options.distortion, "k1 k2 p1 p2 [k3]")
      ->expected(4, 5)
      ->type_name("NUMBERS")
      ->group(group);
}

Status find_calibration(const CalibrationOptions& options, const fs::path& folder, Calibration& calibration) {
  const bool any_pinhole = options.fx || options.fy || options.cx || options.cy;
  const bool all_pinhole = options.fx && options.fy && options.cx && options.cy;
  std::error_code error;
  const fs::path beside = folder / "calibration.txt";
  Status status;
  if (!options.file.empty()) {
    status = read_calibration(options.file, calibration);
  } else if (!options.model_name.empty()) {
    status = builtin_calibration(options.model_name, calibration);
  } else if (!all_pinhole) {
    if (!fs::exists(beside, error)) {
      return {StatusCode::kInvalidArgument,
              fmt::format(
                  "no calibration: give --calibration FILE, --camera-model NAME ({}), or --fx --fy --cx --cy",
                  builtin_names())};
    }
    status = read_calibration(beside, calibration);
  }
  if (!status.ok()) return status;
  Pinhole& pinhole = calibration.camera.pinhole;
  if (any_pinhole) {
    pinhole = {options.fx.value_or(pinhole.fx), options.fy.value_or(pinhole.fy),
               options.cx.value_or(pinhole.cx), options.cy.value_or(pinhole.cy)};
  }
  if (const auto& d = options.distortion; !d.empty())
    calibration.camera.distortion = {d[0], d[1], d[2], d[3], d.size() > 4 ? d[4] : 0.0};
  calibration.camera.readout_s = options.readout_s.value_or(calibration.camera.readout_s);
  calibration.depth_units_per_metre = options.depth_scale.value_or(calibration.depth_units_per_metre);
  return {};
}

void add_camera_options(CLI::App& command, CameraOptions& options) {
  command
      .add_option("folder", options.folder,
                  "Recorded sequence: a folder with rgb.txt and depth.txt (TUM layout)")
      ->type_name("DIR");
  CLI::Option* kind =
      command.add_option("--camera", options.kind, "sim: the simulated camera, instead of a folder")
          ->check(CLI::IsMember({"sim"}).description(""))
          ->type_name("sim");
  command.get_option("folder")->excludes(kind);
  command.add_option("--frames", options.frames, "Only the frames first:end, end not included")
      ->check(CLI::Validator(check_frame_range, ""))
      ->type_name("FIRST:END");
  command
      .add_option("--associations", options.associations,
                  "Pairs 'stamp rgb stamp depth' instead of rgb.txt and depth.txt")
      ->type_name("FILE");
  command
      .add_option("--tolerance", options.tolerance_s, "Largest difference of the stamps of colour and depth")
      ->check(CLI::PositiveNumber.description(""))
      ->capture_default_str()
      ->type_name("SECONDS");
  add_calibration_options(command, options.calibration,
                          "Calibration (default: calibration.txt in the folder)", DepthScale::kAsked);
  add_simulator_options(command, options.simulator);
}

Status open_camera(const CameraOptions& options, OpenedCamera& opened) {
  return options.kind == "sim" ? open_simulator(options, opened) : open_tum(options, opened);
}

}  // namespace plvo::cli
