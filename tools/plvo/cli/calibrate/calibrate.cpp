// SPDX-License-Identifier: Apache-2.0
// plvo calibrate: when a sensor exposes depth and colour, from recordings made with it.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "plvo/calibrate/timing_report.hpp"
#include "plvo/calibrate/timing_search.hpp"
#include "plvo/cli/common/console.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/prefetched_camera.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kHelp =
    "Record about half a minute by hand, turning the camera all the while: left and right, up and down,\n"
    "about its axis, 20 to 60 degrees per second, in a furnished room with light. No target is needed.\n"
    "The unit of depth is not found: depths that are all 1 % too long look like a room 1 % larger.\n"
    "Several recordings of one sensor are fitted together and give one answer.\n"
    "Each of the frames that are used takes 0.6 MB at 640x480.\n"
    "\n"
    "Examples:\n"
    "  plvo record turns && plvo calibrate turns --out camera.yaml\n"
    "  plvo calibrate desk hall --out camera.yaml           two recordings of one sensor\n"
    "  plvo run sequence --calibration camera.yaml          and so for live and record\n";

struct CalibrateOptions {
  std::vector<std::string> recordings;
  BagTopicNames topics;
  CalibrationOptions calibration;
  std::string out, report, json;
  std::size_t frames = 300;
  bool find_readouts = true;
  int threads = 2;
  bool quiet = false;
};

CameraOptions camera_options(const CalibrateOptions& options, const std::string& recording) {
  CameraOptions camera;
  camera.sequence = recording;
  camera.topics = options.topics;
  camera.calibration = options.calibration;
  return camera;
}

bool same_lens(const CameraModel& a, const CameraModel& b) {
  const auto numbers = [](const CameraModel& camera) {
    const Pinhole& p = camera.pinhole;
    const Distortion& d = camera.distortion;
    return std::array{p.fx, p.fy, p.cx, p.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6};
  };
  return numbers(a) == numbers(b) && a.distortion.model == b.distortion.model;
}

// So many frames of each recording that all have at most `total`: as many of each as it has, or as of the
// others.
std::vector<std::size_t> share_out(std::size_t total, const std::vector<std::size_t>& counts) {
  std::vector<std::size_t> by_count(counts.size());
  std::iota(by_count.begin(), by_count.end(), std::size_t{0});
  std::stable_sort(by_count.begin(), by_count.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] < counts[b]; });
  std::vector<std::size_t> shares(counts.size());
  for (std::size_t i = 0; i < by_count.size(); ++i) {
    std::size_t& share = shares[by_count[i]];
    share = std::min(counts[by_count[i]], total / (by_count.size() - i));
    total -= share;
  }
  return shares;
}

// The cameras are opened once for each pass; what they have to say is said once.
class FirstPassLog final : public Log {
 public:
  explicit FirstPassLog(Log& log) : log_(log) {}
  void write(LogLevel level, std::string_view message) override {
    // What is not known is what is being looked for, but for the unit of depth.
    if (said_ || message.find("readout") != std::string_view::npos) return;
    log_.write(level, message);
  }
  void end_of_pass() { said_ = true; }

 private:
  Log& log_;
  bool said_ = false;
};

class Calibrate {
 public:
  explicit Calibrate(const CalibrateOptions& options)
      : options_(options), console_(options.quiet), log_(console_) {}

  int execute() {
    for (const std::string& file : {options_.out, options_.report, options_.json})
      if (!file.empty())
        if (Status status = LineFile::check(file); !status.ok()) return fail(status);
    if (Status status = find_start(); !status.ok()) return fail(status);
    calibrate::TimingSearch search;
    search.start = calibrate::timing_of(calibration_.camera);
    search.find_readouts = options_.find_readouts;
    search.threads = options_.threads;
    search.on_progress = [this](const std::string& line) {
      if (console_.wants_line()) console_.show_line(line);
    };
    search.on_result = [this](const std::string& line) { console_.write(LogLevel::kInfo, line); };
    search.track = [this](const calibrate::SensorTiming& timing,
                          std::vector<calibrate::TrackedRecording>& recordings) {
      return track(timing, recordings);
    };
    console_.write(LogLevel::kInfo, fmt::format("tracking at most {} frames of{}, a few times over",
                                                options_.frames, names()));
    const Status found = calibrate::find_timing(search, result_);
    console_.clear();
    if (!found.ok()) return fail(found);
    return finish();
  }

 private:
  Status open(const std::string& recording, OpenedCamera& opened) {
    return open_camera(camera_options(options_, recording), log_, opened);
  }

  // The lens, and what is known beforehand, are those of the first recording; the others must have its size.
  Status find_start() {
    for (const std::string& recording : options_.recordings) {
      OpenedCamera opened;
      if (Status status = open(recording, opened); !status.ok()) return status;
      if (opened.scaled_down_by > 1)
        return Status(StatusCode::kInvalidArgument,
                      fmt::format("{} has larger images than plvo takes; record a smaller mode of the same "
                                  "camera to calibrate it",
                                  recording));
      const CameraModel model = opened.camera->model();
      if (names_.empty()) calibration_.camera = model;
      if (model.width != calibration_.camera.width || model.height != calibration_.camera.height)
        return Status(StatusCode::kInvalidArgument,
                      fmt::format("{} has images of another size than {}; calibrate them one by one",
                                  recording, options_.recordings.front()));
      if (!same_lens(model, calibration_.camera))
        return Status(StatusCode::kInvalidArgument,
                      fmt::format("{} has another lens than {}; calibrate the recordings of one sensor "
                                  "together, or give --calibration for all",
                                  recording, options_.recordings.front()));
      names_.push_back(opened.name);
      frame_counts_.push_back(opened.frame_count.value_or(SIZE_MAX));
    }
    log_.end_of_pass();
    calibration_.has_size = true;
    calibration_.readout_given = calibration_.depth_scale_given = true;
    return {};
  }

  Status track(const calibrate::SensorTiming& timing, std::vector<calibrate::TrackedRecording>& recordings) {
    const std::vector<std::size_t> shares = share_out(options_.frames, frame_counts_);
    for (std::size_t i = 0; i < options_.recordings.size(); ++i) {
      OpenedCamera opened;
      if (Status status = open(options_.recordings[i], opened); !status.ok()) return status;
      recordings.emplace_back();
      std::size_t number = 0;
      const auto on_frame = [&] {
        ++number;
        if (console_.wants_line())
          console_.show_line(
              fmt::format("{}: tracking frame {} of at most {}", opened.name, number, shares[i]));
      };
      const CameraModel camera = calibrate::with_timing(calibration_.camera, timing);
      PrefetchedCamera prefetched(*opened.camera);
      if (Status status =
              calibrate::track_recording(prefetched, camera, shares[i], on_frame, recordings.back());
          !status.ok())
        return status;
    }
    // Units a metre, as files say it; more digits than those are the division's.
    if (recordings.front().metres_per_unit > 0)
      calibration_.depth_units_per_metre = std::round(1e6 / recordings.front().metres_per_unit) / 1e6;
    return {};
  }

  // Each after a space.
  std::string names() const {
    std::string text;
    for (const std::string& name : names_) text += ' ' + printable(name);
    return text;
  }

  int finish() {
    catch_interrupt();  // until here there is nothing to keep: a signal ends the program at once
    if (!calibrate::is_determined(result_, 0))
      return fail(
          "these recordings do not show when depth is exposed; record half a minute in a furnished room with "
          "light, "
          "turning the camera all the while: left and right, up and down, 20 to 60 deg/s");
    calibrate::SensorTiming timing = result_.timing;
    const calibrate::SensorTiming start = calibrate::timing_of(calibration_.camera);
    if (!calibrate::is_determined(result_, 1)) timing.depth_readout_s = start.depth_readout_s;
    if (!calibrate::is_determined(result_, 2)) timing.readout_s = start.readout_s;
    result_.timing = timing;
    if (!result_.settled)
      console_.write(LogLevel::kWarning, "the last pass still changed the result; more frames help");
    calibration_.camera = calibrate::with_timing(calibration_.camera, timing);
    // An output that fails does not take the others with it.
    int exit_code = kExitSuccess;
    for (const Status& status : {write_calibration(), write_page(), write_summary()})
      if (!status.ok()) exit_code = fail(status);
    return exit_code;
  }

  Status write_page() {
    LineFile page;
    return options_.report.empty() ? Status()
                                   : page.open(options_.report, calibrate::to_html(result_, names_));
  }

  Status write_summary() {
    return write_result(
        options_.json, calibrate::to_json(result_),
        [this] { return options_.quiet ? std::string() : calibrate::to_text(result_); },
        is_standard_output(options_.out) || is_standard_output(options_.report));
  }

  Status write_calibration() {
    std::string text = "# Made by plvo calibrate from" + names() + '\n';
    for (std::size_t i = 0; i < 3; ++i)
      if (calibrate::is_determined(result_, i) && result_.sigma_s[i] > 0)
        text += fmt::format("# {}: SD {:.5f} s\n", calibrate::kTimingNames[i].key, result_.sigma_s[i]);
    // Numbers of a thousandth of a millisecond say all there is to say.
    DepthTiming& depth = calibration_.camera.depth_timing;
    double& stamp_sigma_s = calibration_.camera.stamp_sigma_s;
    if (result_.stamp_sigma_s >= 0) stamp_sigma_s = result_.stamp_sigma_s;
    for (double* seconds : {&depth.delay_s, &depth.readout_s, &calibration_.camera.readout_s, &stamp_sigma_s})
      *seconds = std::round(*seconds * 1e6) / 1e6;
    text += calibration_lines(calibration_);
    text.pop_back();  // the file adds it
    LineFile file;
    return file.open(options_.out, text);
  }

  CalibrateOptions options_;
  Console console_;
  FirstPassLog log_;
  Calibration calibration_;
  std::vector<std::string> names_;
  std::vector<std::size_t> frame_counts_;  // SIZE_MAX where it is not known
  calibrate::TimingResult result_;
};

void check(const CLI::App& command, const CalibrateOptions& options) {
  check_calibration_options(command);
  FileRoles files;
  files.writes("--out", options.out);
  files.writes("--report", options.report);
  files.writes("--json", options.json);
  for (const std::string& recording : options.recordings) {
    if (is_oni_file(recording))
      refuse_options(command, {"--depth-scale"},
                     "does not apply to an .oni file, which has units of its own");
    add_inputs(camera_options(options, recording), files);
  }
  if (std::none_of(options.recordings.begin(), options.recordings.end(),
                   [](const std::string& recording) { return is_bag(recording); }))
    refuse_bag_options(command);
  files.check();
}

}  // namespace

void add_calibrate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App& command = add_command(app, "calibrate", "Find when a sensor exposes depth and colour", kHelp);
  OptionGroup group(command);
  CLI::Option* recordings = group.add("recordings", "DIR|FILE",
                                      "Recordings of one sensor: folders in the TUM layout, .oni files, or "
                                      "recordings of ROS",
                                      [options](const std::string& text) -> std::string {
                                        options->recordings.push_back(text);
                                        return text.empty() ? "expected a path, not an empty word" : "";
                                      });
  require(recordings);
  takes_words(recordings, 64);
  require(group.path("--out", options->out,
                     "The calibration with what was found, for --calibration; - is standard output"));
  group.path("--report", options->report, "A page with the curves: one HTML file, no network");
  group.choice("--find", options->find_readouts, Choices<bool>{{"all", true}, {"delay", false}},
               "delay: the readouts are taken from the calibration (default all)");
  group.whole("--frames", options->frames, 60, 5000,
              "Largest number of frames of all recordings (default 300)");
  group.whole("--threads", options->threads, 1, 256,
              "Threads; the result does not depend on them (default 2)");
  group.flag("--quiet", options->quiet, "Warnings and errors only: no progress, no summary");
  add_bag_options(command, options->topics, BagImu::kPassedOver);
  add_calibration_options(command, options->calibration, DepthScale::kAsked,
                          "the calibration in the recording");
  add_json_option(command, options->json);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return Calibrate(*options).execute();
  });
}

}  // namespace plvo::cli
