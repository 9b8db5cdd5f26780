// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/measure.hpp"

#include <fmt/core.h>

#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/systems/system.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/host/trajectory_file.hpp"
#include "plvo/replay/tum_camera.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

std::int64_t cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

// A line of /proc/self/status in megabytes (10^6 bytes). getrusage would count what this process was before
// it became the worker.
double memory_mb(const std::string& name) {
  std::ifstream stream("/proc/self/status");
  for (std::string line; std::getline(stream, line);)
    if (line.rfind(name + ":", 0) == 0) return std::stod(line.substr(name.size() + 1)) * 1024 / 1e6;
  return 0;
}

struct Tracks {
  eval::Trajectory trajectory;
  std::vector<double> times_ms;
  int lost = 0;
};

Status track_all(TumCamera& camera, System& system, Tracks& tracks) {
  for (RgbdFrame frame;;) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (status.code() == StatusCode::kDamaged) continue;  // for every system alike
    if (!status.ok()) return status;
    system.prepare(frame);
    const std::int64_t start = cpu_ns();
    const bool tracked = system.track();
    const std::int64_t end = cpu_ns();
    if (!tracked) ++tracks.lost;
    if (!tracks.trajectory.poses.empty()) tracks.times_ms.push_back(static_cast<double>(end - start) * 1e-6);
    tracks.trajectory.poses.push_back({frame.stamp_ns, system.pose()});
  }
}

Status evaluate_tracks(const Job& job, const Tracks& tracks, Result& result) {
  eval::Trajectory truth;
  if (Status status = eval::read_trajectory({job.folder / "groundtruth.txt", {}, {}}, truth); !status.ok())
    return status;
  eval::EvaluationOptions options;
  options.sampling = job.options.sampling;
  eval::Evaluation evaluation;
  if (Status status = eval::evaluate(truth, tracks.trajectory, {}, {}, options, evaluation); !status.ok())
    return status;
  fill_accuracy(evaluation, result);
  return {};
}

}  // namespace

Status find_calibration(const fs::path& folder, const std::string& camera_model, Calibration& calibration) {
  if (!camera_model.empty()) return builtin_calibration(camera_model, calibration);
  std::error_code error;
  if (fs::exists(folder / "calibration.txt", error))
    return read_calibration(folder / "calibration.txt", calibration);
  const std::string name = folder.filename().string();
  for (const char* number : {"1", "2", "3"}) {
    if (name.find(std::string("freiburg") + number) != std::string::npos ||
        name.rfind(std::string("fr") + number, 0) == 0)
      return builtin_calibration(std::string("tum-fr") + number, calibration);
  }
  return {StatusCode::kNotFound,
          fmt::format("{}: no calibration.txt, and the name says no TUM camera: give --camera-model",
                      folder.string())};
}

Status measure(const Job& job, const fs::path& out) {
  Calibration calibration;
  if (Status status = find_calibration(job.folder, job.options.camera_model, calibration); !status.ok())
    return status;
  TumOptions tum;
  if (job.options.frames > 0) tum.end_frame = job.options.frames;
  TumCamera camera;
  if (Status status = camera.open(job.folder, calibration, tum); !status.ok()) return status;

  // The peak is counted anew from here, so that what the loading of the program took does not hide it.
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before_mb = memory_mb("VmRSS");
  std::unique_ptr<System> system;
  if (Status status = make_system(job.system, camera.model(), system); !status.ok()) return status;
  Tracks tracks;
  if (Status status = track_all(camera, *system, tracks); !status.ok()) return status;

  Result result;
  result.peak_mb = memory_mb("VmHWM");
  result.growth_mb = result.peak_mb - before_mb;
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
