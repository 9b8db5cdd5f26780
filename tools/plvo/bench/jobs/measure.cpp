// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/measure.hpp"

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/systems/system.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/resident_memory.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/index/sequence_index.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

struct Tracks {
  eval::Trajectory trajectory;
  std::vector<double> times_ms;
  int lost = 0;
};

Status track_all(RecordedCamera& camera, System& system, Tracks& tracks) {
  for (RgbdFrame frame;;) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (status.code() == StatusCode::kDamaged) continue;  // the same for every system
    if (!status.ok()) return status;
    system.prepare(frame);
    const std::int64_t start = posix_process_cpu_ns();
    const bool tracked = system.track();
    const std::int64_t end = posix_process_cpu_ns();
    if (!tracked) ++tracks.lost;
    if (!tracks.trajectory.poses.empty()) tracks.times_ms.push_back(static_cast<double>(end - start) * 1e-6);
    tracks.trajectory.poses.push_back({frame.stamp_ns, system.pose()});
  }
}

Status evaluate_tracks(const Job& job, const Tracks& tracks, Result& result) {
  eval::Trajectory truth;
  if (Status status = read_ground_truth(job.folder, {}, truth); !status.ok()) return status;
  eval::EvaluationOptions options;
  options.sampling.method = job.options.sampling;
  eval::Evaluation evaluation;
  if (Status status = eval::evaluate(truth, tracks.trajectory, {}, {}, options, evaluation); !status.ok())
    return status;
  fill_accuracy(evaluation, result);
  return {};
}

}  // namespace

Status measure(const Job& job, const fs::path& out) {
  Calibration calibration;
  std::string guess;  // unused: the table names the sequence
  Status found = job.options.camera_model.empty()
                     ? sequence_calibration(job.folder, calibration, guess)
                     : builtin_calibration(job.options.camera_model, calibration);
  if (!found.ok()) return found;
  SequenceOptions range;
  if (job.options.frames > 0) range.end_frame = job.options.frames;
  RecordedCamera camera;
  if (Status status = camera.open(job.folder, calibration, range); !status.ok()) return status;

  // Reset the peak here, so that the memory for loading the program does not hide it.
  forget_peak_resident();
  const std::int64_t before = resident_memory().total;
  std::unique_ptr<System> system;
  if (Status status = make_system(job.system, camera.model(), system); !status.ok()) return status;
  Tracks tracks;
  if (Status status = track_all(camera, *system, tracks); !status.ok()) return status;

  Result result;
  const std::int64_t peak = peak_resident_bytes();
  result.peak_mb = static_cast<double>(peak) / 1e6;
  result.growth_mb = static_cast<double>(peak - before) / 1e6;
  result.frames = static_cast<int>(tracks.trajectory.poses.size());
  result.lost = tracks.lost;
  const eval::Statistics times = eval::statistics(tracks.times_ms);
  result.cpu_median_ms = times.median;
  result.cpu_p95_ms = times.p95;
  if (Status status = evaluate_tracks(job, tracks, result); !status.ok()) return status;

  const fs::path file = job.result_file(out);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::string text = std::string(kTrajectoryHeader) + '\n';
  for (const eval::StampedPose& pose : tracks.trajectory.poses)
    text += trajectory_line(pose.stamp_ns, pose.T_world_camera) + '\n';
  fs::path trajectory = file;
  if (Status status = write_text(trajectory.replace_extension("txt"), text); !status.ok()) return status;
  return write_text(file, to_json(result, job.key()).dump(2) + '\n');
}

}  // namespace plvo::bench
