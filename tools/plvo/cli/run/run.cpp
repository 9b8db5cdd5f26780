// SPDX-License-Identifier: Apache-2.0
// plvo run: frames of a recorded or simulated camera in, a trajectory with covariances out.
#include <fmt/core.h>

#include <unistd.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "plvo/cli/common/camera_options.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/odometry_options.hpp"
#include "plvo/cli/common/progress.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/run/overlay.hpp"
#include "plvo/cli/run/run_history.hpp"
#include "plvo/cli/run/run_outputs.hpp"
#include "plvo/cli/run/run_summary.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/replay/paced_camera.hpp"

namespace plvo::cli {
namespace {

constexpr std::size_t kReportedDamages = 10;  // further ones are only counted
constexpr std::size_t kUnknownFrameCount = 4096;

struct RunOptions {
  CameraOptions camera;
  OdometryOptions odometry;
  OutputOptions outputs;
  std::string summary, overlay, report;
  std::size_t report_frames = 60;
  Pace pace = Pace::kFast;
  bool quiet = false;
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
  explicit Run(const RunOptions& options) : options_(options) {}

  int execute() {
    if (Status status = open(); !status.ok()) return fail(status);
    catch_interrupt();
    const Status failure = loop();
    finish();
    if (!failure.ok()) return fail(failure);
    if (Status status = write_summary(); !status.ok()) return fail(status);
    if (summary_->tracked() > 0) return kExitSuccess;
    fail(fmt::format("no frame could be tracked{}{}", summary_->main_reason().empty() ? "" : ": ",
                     summary_->main_reason()));
    return kExitNothingTracked;
  }

 private:
  // Everything that can be wrong is found before the first file is made.
  Status open() {
    if (Status status = open_camera(options_.camera, opened_); !status.ok()) return status;
    Config config = make_config(options_.odometry);
    config.stage_clock = posix_thread_cpu_ns;
    if (Status status = block_.init(opened_.camera->model(), config); !status.ok()) return status;
    summary_ = std::make_unique<RunSummary>(opened_.frame_count.value_or(kUnknownFrameCount));
    summary_->camera_name = opened_.name;
    summary_->unpaired_images = opened_.unpaired_images;
    history_ = std::make_unique<RunHistory>(!options_.report.empty(), options_.report_frames,
                                            opened_.frame_count.value_or(kUnknownFrameCount));
    if (!options_.overlay.empty())
      if (Status status = overlay_.open(options_.overlay); !status.ok()) return status;
    return outputs_.open(options_.outputs);
  }

  Status loop() {
    Progress progress(clock_, options_.quiet, opened_.frame_count);
    PacedCamera camera(*opened_.camera, options_.pace, clock_, wait_for_enter);
    prefault_program();
    summary_->resident_start = resident_memory();
    FrameRecord record;
    for (; !interrupted(); ++record.number) {
      RgbdFrame frame;
      record.camera_status = camera.next(frame);
      if (record.camera_status.code() == StatusCode::kEndOfStream) return {};
      record.result = TrackResult();
      record.result.stamp_ns = frame.stamp_ns;
      if (record.damaged()) {
        if (record.camera_status.code() != StatusCode::kDamaged) return record.camera_status;
        if (summary_->damaged() < kReportedDamages) {
          progress.clear();
          warn(fmt::format("frame {} skipped: {}", record.number, record.camera_status.message()));
        }
      } else {
        const std::int64_t start = posix_thread_cpu_ns();
        record.result = block_.odometry().track(frame);
        record.cpu_ns = posix_thread_cpu_ns() - start;
      }
      summary_->add(record);
      history_->add(record, record.damaged() ? nullptr : &frame, block_.odometry());
      if (Status status = outputs_.write(record); !status.ok()) return status;
      if (!record.damaged())
        if (Status status = overlay_.write(record.number, block_.odometry()); !status.ok()) return status;
      progress.show(record, summary_->lost());
    }
    return {};
  }

  void finish() {
    summary_->resident_end = resident_memory();
    summary_->interrupted = interrupted();
    summary_->arena_bytes = block_.odometry().memory_used();
    summary_->arena_peak = block_.odometry().memory_peak();
    if (const Status status = history_->evaluate(opened_); !status.ok()) warn(status.message());
    summary_->evaluation = history_->evaluation();
    if (!options_.quiet) fmt::print("{}", summary_->to_text());
  }

  Status write_summary() {
    if (!options_.report.empty())
      if (Status status = history_->write_report(options_.report, *summary_); !status.ok()) return status;
    if (options_.summary.empty()) return {};
    LineFile file;
    return file.open(options_.summary, summary_->to_json().dump(2));
  }

  RunOptions options_;
  OpenedCamera opened_;
  OdometryBlock block_;
  RunOutputs outputs_;
  Overlay overlay_;
  std::unique_ptr<RunSummary> summary_;
  std::unique_ptr<RunHistory> history_;
  PosixClock clock_;
};

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Track a recorded or simulated sequence");
  add_camera_options(*command, options->camera);
  const std::map<std::string, Pace> paces = {
      {"fast", Pace::kFast}, {"realtime", Pace::kRealtime}, {"step", Pace::kStep}};
  command
      ->add_option("--pace", options->pace, "fast; realtime, as the stamps say; step, a frame for each Enter")
      ->transform(CLI::CheckedTransformer(paces).description(""))
      ->type_name("PACE");
  const std::string outputs = "Outputs (docs/formats.md)";
  const auto file = [&](const char* name, std::string& path, const char* what) {
    command->add_option(name, path, what)->type_name("FILE")->group(outputs);
  };
  file("--out", options->outputs.trajectory, "Trajectory, TUM format: one line per tracked frame");
  file("--covariance", options->outputs.covariance, "6x6 covariance of each pose");
  file("--motions", options->outputs.motions,
       "Motion from the reference of each frame, with its 6x6 covariance");
  file("--stats", options->outputs.stats, "CSV: one row per frame, lost and damaged ones with the reason");
  file("--json", options->summary, "The summary as JSON");
  file("--report", options->report, "A page that shows the run: one HTML file, no network");
  command->add_option("--report-frames", options->report_frames, "Frames with pictures in the report, about")
      ->capture_default_str()
      ->type_name("NUMBER")
      ->group(outputs);
  command
      ->add_option("--overlay", options->overlay,
                   "A PNG of each frame with its keypoints, segments and matches")
      ->type_name("DIR")
      ->group(outputs);
  command->add_flag("--quiet", options->quiet, "No progress line and no summary")->group(outputs);
  add_odometry_options(*command, options->odometry);
  command->footer(kExitCodeHelp);
  command->callback([options, &exit_code] {
    if (options->camera.folder.empty() && options->camera.kind.empty())
      throw CLI::RequiredError("A sequence: plvo run DIR, or plvo run --camera sim");
    exit_code = Run(*options).execute();
  });
}

}  // namespace plvo::cli
