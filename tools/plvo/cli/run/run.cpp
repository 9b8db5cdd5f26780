// SPDX-License-Identifier: Apache-2.0
// plvo run: frames of a recorded or simulated camera in, a trajectory with covariances out.
#include <fmt/core.h>
#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/map/session_map.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/cli/options/odometry_options.hpp"
#include "plvo/cli/run/imu_options.hpp"
#include "plvo/cli/run/overlay.hpp"
#include "plvo/cli/run/run_history.hpp"
#include "plvo/cli/run/run_outputs.hpp"
#include "plvo/cli/run/run_summary.hpp"
#include "plvo/cli/run/wheel_options.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/prefetched_camera.hpp"
#include "plvo/host/standard_streams.hpp"
#include "plvo/replay/checks/frame_check.hpp"
#include "plvo/replay/paced_camera.hpp"

namespace plvo::cli {
namespace {

constexpr std::size_t kReportedDamages = 10;  // further ones are only counted
constexpr std::size_t kUnknownFrameCount = 4096;
constexpr const char* kRunHelp =
    "Examples:\n"
    "  plvo run --camera sim --frames 100                   no sensor and no recording needed\n"
    "  plvo run DIR --camera-model tum-fr1 --out t.txt      a TUM recording of the fr1 series\n"
    "  plvo run sequence --report run.html                  what plvo record or plvo simulate made\n"
    "  plvo run sequence --map 256 --map-trajectory map.txt   places that come back correct the drift\n"
    "  plvo run sequence --imu                              with a gyro and an accelerometer\n"
    "  plvo run sequence --quiet --out - | your_program     the trajectory into a pipe\n";

struct RunOptions {
  CameraOptions camera;
  OdometryOptions odometry;
  OutputOptions outputs;
  std::string summary, overlay, report;
  std::size_t report_frames = 60;
  Pace pace = Pace::kFast;
  bool quiet = false;
  ImuOptions imu;
  WheelOptions wheels;
  MapOptions map;
};

// One key a frame: the next line of standard input.
bool wait_for_enter() {
  char c = 0;
  while (::read(STDIN_FILENO, &c, 1) == 1)
    if (c == '\n') return true;
  return false;
}

class Run {
 public:
  explicit Run(const RunOptions& options) : options_(options), console_(options.quiet) {}

  int execute() {
    if (Status status = open(); !status.ok()) return fail(status);
    catch_interrupt();
    summary_->failure = replay();
    console_.clear();
    // An output that fails does not take the others with it.
    int exit_code = summary_->failure.ok() ? kExitSuccess : fail(summary_->failure);
    const Status finished = finish(), reported = write_report(), summarised = write_summary(),
                 mapped = map_.write();
    for (const Status& status : {finished, reported, summarised, mapped})
      if (!status.ok()) exit_code = fail(status);
    std::vector<std::string> written;
    for (const auto& [option, path] : options_.outputs.named()) written.push_back(path);
    if (reported.ok()) written.push_back(options_.report);
    if (summarised.ok()) written.push_back(options_.summary);
    if (mapped.ok())
      written.insert(written.end(), {options_.map.out, options_.map.trajectory, options_.map.ply});
    written.push_back(options_.overlay);
    tell_written(console_, written);
    if (exit_code != kExitSuccess || !summary_->failed()) return exit_code;
    fail(summary_->why_failed());
    return kExitNothingTracked;
  }

 private:
  // Everything that can be wrong is found before the first file is made.
  Status open() {
    if (Status status = open_camera(options_.camera, console_, opened_); !status.ok()) return status;
    if (Status status = block_.init(opened_.camera->model(), options_.odometry, opened_.scaled_down_by);
        !status.ok())
      return status;
    if (Status status = open_imu(options_.imu, opened_, options_.outputs.base.level, console_, imu_);
        !status.ok())
      return status;
    if (Status status = open_wheels(options_.wheels, options_.outputs.base, console_, wheels_); !status.ok())
      return status;
    if (Status status = map_.init(options_.map, opened_.camera->model(), block_.config(),
                                  static_cast<bool>(opened_.ground_truth));
        !status.ok())
      return status;
    warn_of_base_option(options_.outputs.base, console_);
    summary_ = std::make_unique<RunSummary>();
    summary_->camera_name = opened_.name;
    summary_->unpaired_images = opened_.unpaired_images;
    summary_->image = {opened_.camera->model().width, opened_.camera->model().height, opened_.scaled_down_by};
    history_ = std::make_unique<RunHistory>(!options_.report.empty(), options_.report_frames,
                                            opened_.frame_count.value_or(kUnknownFrameCount));
    if (Status status = SessionMap::check_outputs(options_.map); !status.ok()) return status;
    for (const std::string& file : {options_.report, options_.summary})
      if (!file.empty())
        if (Status status = LineFile::check(file); !status.ok()) return status;
    if (!options_.overlay.empty())
      if (Status status = overlay_.open(options_.overlay); !status.ok()) return status;
    return outputs_.open(options_.outputs);
  }

  Status replay() {
    // The simulated camera takes every processor for a frame by itself.
    std::optional<PrefetchedCamera> prefetched;
    if (!options_.camera.simulated) prefetched.emplace(*opened_.camera);
    RgbdCamera& source = prefetched ? static_cast<RgbdCamera&>(*prefetched) : *opened_.camera;
    PacedCamera camera(source, options_.pace, clock_, wait_for_enter);
    if (options_.pace == Pace::kStep)
      console_.write(LogLevel::kInfo, "--pace step: Enter tracks the next frame, Ctrl-D ends the run");
    prefault_program();
    if (prefetched) prefetched->wait_until_ahead();
    summary_->resident_start = resident_memory();
    const Status failure = loop(camera);
    summary_->resident_end = resident_memory();
    return failure;
  }

  Status loop(RgbdCamera& camera) {
    FrameRecord record;
    for (; !interrupted(); ++record.number) {
      RgbdFrame frame;
      record.camera_status = camera.next(frame);
      if (record.camera_status.code() == StatusCode::kEndOfStream) return {};
      record.result = TrackResult();
      record.result.stamp_ns = frame.stamp_ns;
      if (record.damaged()) {
        if (record.camera_status.code() != StatusCode::kDamaged) return record.camera_status;
        if (summary_->damaged() < kReportedDamages)
          console_.write(LogLevel::kWarning,
                         fmt::format("frame {} skipped: {}", record.number, record.camera_status.message()));
      } else {
        tell(check_.add(frame));
        const MotionPrior wheels = wheels_ ? wheels_->prior(frame.stamp_ns) : MotionPrior();
        block_.track(frame, imu_ ? &imu_->until(frame.stamp_ns) : nullptr, wheels, record);
      }
      if (!record.damaged()) map_.add(block_.odometry(), record);
      summary_->add(record);
      history_->add(record, record.damaged() ? nullptr : &frame, block_.odometry());
      if (Status status = outputs_.write(record); !status.ok()) return status;
      if (!record.damaged())
        if (Status status = overlay_.write(record.number, block_.odometry()); !status.ok()) return status;
      if (options_.pace == Pace::kStep) console_.write(LogLevel::kInfo, line_of(record));
      if (console_.wants_line()) console_.show_line(line_of(record));
    }
    return {};
  }

  void tell(const std::vector<std::string>& findings) {
    for (const std::string& sentence : findings) console_.write(LogLevel::kWarning, sentence);
  }

  std::string line_of(const FrameRecord& record) const {
    const TrackResult& result = record.result;
    return fmt::format("frame {}{} {}  points {}  lines {}  {:.1f} ms  lost {}", record.number + 1,
                       opened_.frame_count ? fmt::format("/{}", *opened_.frame_count) : "",
                       record.damaged() ? "damaged" : to_string(result.state), result.points.inliers,
                       result.lines.inliers, static_cast<double>(record.cpu_ns) * 1e-6, summary_->lost());
  }

  Status finish() {
    summary_->interrupted = interrupted();
    summary_->arena_bytes = block_.odometry().memory_used();
    summary_->arena_peak = block_.odometry().memory_peak();
    tell(check_.finish());
    if (wheels_ && wheels_->priors() == 0 && summary_->frames() > 1)
      console_.write(LogLevel::kWarning,
                     "the wheels have no samples at the stamps of the images: are both on one clock?");
    if (const Status status = history_->evaluate(opened_); !status.ok())
      console_.write(LogLevel::kWarning, status.message());
    summary_->evaluation = history_->evaluation();
    map_.finish();
    summary_->map = map_.summary();
    if (summary_->map) summary_->map->ate_m = ate_in_map();
    if (summary_->evaluation)
      if (const std::string doubt = eval::doubt_about_scale(*summary_->evaluation); !doubt.empty())
        console_.write(LogLevel::kWarning, doubt);
    summary_->warnings = console_.warnings();
    if (options_.quiet) return {};
    const OutputOptions& o = options_.outputs;
    if (!takes_standard_output({o.trajectory, o.covariance, o.motions, o.stats, options_.summary,
                                options_.report, options_.map.trajectory, options_.map.ply,
                                options_.map.out}))
      return print(summary_->to_text());
    print_to_stderr(summary_->to_text());
    return {};
  }

  // Nothing without ground truth. One that cannot be read was reported with the odometry's own figures.
  std::optional<double> ate_in_map() {
    if (!opened_.ground_truth) return std::nullopt;
    eval::Trajectory poses, truth;
    std::vector<std::int64_t> stamps;
    const Status read = map_.poses([&](std::int64_t stamp_ns, const Se3& T_map_camera) {
      stamps.push_back(stamp_ns);
      poses.poses.push_back({stamp_ns, T_map_camera});
      return Status();
    });
    eval::Evaluation evaluation;
    if (!read.ok() || poses.poses.size() < 2 || !opened_.ground_truth(stamps, truth).ok() ||
        !eval::evaluate(truth, poses, {}, {}, {}, evaluation).ok())
      return std::nullopt;
    return evaluation.ate.position_m.rmse;
  }

  Status write_report() {
    return options_.report.empty() ? Status() : history_->write_report(options_.report, *summary_);
  }
  Status write_summary() {
    return options_.summary.empty() ? Status() : write_json(options_.summary, summary_->to_json());
  }

  RunOptions options_;
  Console console_;
  OpenedCamera opened_;
  OdometryBlock block_;
  std::optional<RecordedImu> imu_;
  std::optional<WheelPriors> wheels_;
  FrameCheck check_;
  SessionMap map_;
  RunOutputs outputs_;
  Overlay overlay_;
  std::unique_ptr<RunSummary> summary_;
  std::unique_ptr<RunHistory> history_;
  PosixClock clock_;
};

void check(const CLI::App& command, RunOptions& options) {
  check_camera_options(command, options.camera);
  check_odometry_options(options.odometry);
  check_imu_options(command, options.imu, options.camera);
  if (options.report.empty())
    refuse_options(command, {"--report-frames"}, "is for a report: add --report FILE, or leave it out");
  check_map_options(command, options.map);
  check_output_options(command);
  check_base_option(options.outputs.base, options.outputs.has_poses() || !options.wheels.file.empty());
  if (options.camera.simulated && !options.wheels.file.empty())
    refuse("--wheels", "is for recorded sequences; plvo simulate --robot records wheels, too");
  check_wheel_options(command, options.wheels, options.outputs.base);
  check_level_option(command, options.imu.used);
  options.odometry.level_world = options.outputs.base.level;
  FileRoles files;
  for (const auto& [option, path] : options.outputs.named()) files.writes(option, path);
  add_map_files(options.map, files);
  files.writes("--json", options.summary);
  files.writes("--report", options.report);
  files.writes_folder("--overlay", options.overlay);
  add_inputs(options.camera, files);
  files.reads(options.odometry.mask);
  files.reads(options.wheels.file);
  files.check();
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App& command = add_command(app, "run", "Track a recorded or simulated sequence", kRunHelp);
  add_camera_options(command, options->camera);
  OptionGroup(command).choice(
      "--pace", options->pace,
      Choices<Pace>{{"fast", Pace::kFast}, {"realtime", Pace::kRealtime}, {"step", Pace::kStep}},
      "As fast as it goes (default), as the stamps say, or a frame for each Enter");
  add_imu_options(command, options->imu);
  add_wheel_options(command, options->wheels, WheelSource::kFile);
  add_map_options(command, options->map);
  add_output_options(command, options->outputs);
  OptionGroup base(command, kOutputGroup);
  add_level_option(base, options->outputs.base);
  OptionGroup outputs(command, kOutputGroup);
  outputs.path("--json", options->summary, "The summary as JSON");
  outputs.path("--report", options->report, "A page that shows the run: one HTML file, no network");
  outputs.whole("--report-frames", options->report_frames, 1, 100'000,
                "About so many frames with pictures in the report (default 60)");
  outputs.path("--overlay", options->overlay,
               "Folder for a PNG of each frame with its keypoints, segments and matches", "DIR");
  outputs.flag("--quiet", options->quiet, "Warnings and errors only: no progress, no summary");
  add_odometry_options(command, options->odometry);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return Run(*options).execute();
  });
}

}  // namespace plvo::cli
