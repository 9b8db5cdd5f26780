// SPDX-License-Identifier: Apache-2.0
// plvo eval: an estimate against the ground truth.
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/eval/evaluation.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/replay/index/numbered_index.hpp"
#include "plvo/report/report.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kEvalHelp =
    "Examples:\n"
    "  plvo eval --gt walk/groundtruth.txt --est trajectory.txt\n"
    "  plvo eval --gt chess/seq-01 --est trajectory.txt     the poses of numbered frames\n"
    "  plvo eval --gt walk.bag --est trajectory.txt         walk-groundtruth.txt beside the bag\n"
    "  plvo eval --gt walk/groundtruth.txt --est t.txt --est-covariance c.txt --report comparison.html\n";

struct EvalOptions {
  eval::TrajectorySource ground_truth, estimate;
  std::string covariance, motions, report;
  std::vector<std::string> kitti_times;  // one for both, or of the truth and of the estimate
  eval::GroundTruthSampling sampling = eval::GroundTruthSampling::kInterpolated;
  double max_difference_s = 0.02;
  std::vector<double> sigma;  // of a true pose: m, degrees
  bool fit_truth = false;
  double offset_s = 0;
  SequenceOptions folder;  // where the ground truth is a folder
  std::vector<eval::RpeDelta> deltas;
  std::string json;
};

// So that stamps can be shifted without leaving the 292 years that nanoseconds can count.
bool stamps_are_moderate(const eval::Trajectory& trajectory) {
  return std::all_of(trajectory.poses.begin(), trajectory.poses.end(), [](const eval::StampedPose& pose) {
    return pose.stamp_ns > INT64_MIN / 2 && pose.stamp_ns < INT64_MAX / 2;
  });
}

Status read_inputs(const EvalOptions& options, eval::Trajectory& ground_truth, eval::Trajectory& estimate,
                   std::vector<eval::StampedCovariance>& covariances,
                   std::vector<eval::UncertainMotion>& motions) {
  const std::filesystem::path& truth = options.ground_truth.path;
  Status status = is_recording(truth) ? read_true_poses(truth, options.folder, ground_truth)
                                      : read_trajectory(options.ground_truth, ground_truth);
  if (status.ok()) status = read_trajectory(options.estimate, estimate);
  if (status.ok() && !stamps_are_moderate(estimate))
    status = {StatusCode::kInvalidArgument, options.estimate.path.string() + " has stamps beyond 146 years"};
  if (status.ok() && !options.covariance.empty())
    status = eval::read_covariances(options.covariance, covariances);
  if (status.ok() && !options.motions.empty()) status = eval::read_motions(options.motions, motions);
  const bool kitti = ground_truth.format == eval::TrajectoryFormat::kKitti ||
                     estimate.format == eval::TrajectoryFormat::kKitti;
  if (status.ok() && !options.kitti_times.empty() && !kitti)
    refuse_command(
        "--kitti-times is for KITTI's rows of 12 numbers, and neither file has them; leave it away");
  return status;
}

int eval_command(EvalOptions options) {
  eval::EvaluationOptions settings;
  settings.sampling.method = options.sampling;
  settings.sampling.max_difference_ns = static_cast<std::int64_t>(options.max_difference_s * 1e9);
  settings.offset_ns = static_cast<std::int64_t>(options.offset_s * 1e9);
  settings.deltas = options.deltas;
  if (!options.sigma.empty()) settings.truth_sigma = {options.sigma[0], options.sigma[1] * kPi / 180};
  settings.fit_truth = options.fit_truth;
  if (!options.kitti_times.empty()) {
    options.ground_truth.kitti_times = options.kitti_times.front();
    options.estimate.kitti_times = options.kitti_times.back();
  }

  eval::Trajectory ground_truth, estimate;
  std::vector<eval::StampedCovariance> covariances;
  std::vector<eval::UncertainMotion> motions;
  eval::Evaluation evaluation;
  Status status = read_inputs(options, ground_truth, estimate, covariances, motions);
  for (const std::string& file : {options.report, options.json})
    if (status.ok() && !file.empty()) status = LineFile::check(file);
  if (status.ok()) status = evaluate(ground_truth, estimate, covariances, motions, settings, evaluation);
  if (!status.ok()) return fail(status);
  std::vector<std::string> warnings;
  for (const auto& [trajectory, source] :
       {std::pair(&ground_truth, &options.ground_truth), std::pair(&estimate, &options.estimate)})
    if (trajectory->ignored_rows > 0)
      warnings.push_back(fmt::format("{}: {} poses with a NaN, an infinity or a repeated stamp were ignored",
                                     source->path.string(), trajectory->ignored_rows));
  for (std::string& sentence : doubts_about(evaluation)) warnings.push_back(std::move(sentence));
  for (const std::string& sentence : warnings) warn(sentence);
  if (!options.report.empty()) {
    report::ReportInput input;
    input.title = options.estimate.path.filename().string();
    input.subtitle = "plvo " PLVO_VERSION ": compared with " + options.ground_truth.path.string() +
                     (options.fit_truth ? ", turned and shifted to fit" : "");
    input.trajectory = estimate;
    input.evaluation = evaluation;
    status = report::write_report(options.report, input);
  }
  nlohmann::ordered_json json = to_json(evaluation);
  json["warnings"] = warnings;
  const Status result = write_result(
      options.json, json, [&] { return to_text(evaluation); }, is_standard_output(options.report));
  int exit_code = kExitSuccess;
  for (const Status& written : {status, result})
    if (!written.ok()) exit_code = fail(written);
  return exit_code;
}

void check(const CLI::App& command, const EvalOptions& options) {
  if (options.sampling != eval::GroundTruthSampling::kNearest)
    refuse_options(command, {"--max-dt"}, "is for --gt-sampling nearest; add that, or leave it away");
  if (options.sampling == eval::GroundTruthSampling::kNearest)
    refuse_options(command, {"--fit-truth"},
                   "shifts the truth's clock, so that it is interpolated; leave --gt-sampling nearest away");
  if (options.covariance.empty() && options.motions.empty())
    refuse_options(command, {"--gt-sigma"}, "is for the NEES; add --est-covariance or --est-motions");
  const std::filesystem::path& truth = options.ground_truth.path;
  if (is_recording(truth))
    refuse_options(command, {"--gt-format"}, "is for a trajectory, and --gt names a recording");
  if (is_bag(options.estimate.path))
    refuse("--est", "a ROS bag is a recording; name the trajectory that plvo run --out made of it");
  if (!is_numbered_folder(truth)) refuse_options(command, {"--rate"}, "is for a folder of numbered frames");
  FileRoles files;
  files.writes("--report", options.report);
  files.writes("--json", options.json);
  files.reads(is_bag(truth) ? bag_ground_truth_file(truth) : truth / "groundtruth.txt");
  for (const std::filesystem::path& file : bag_files_in(truth)) files.reads(file);
  SequenceIndex index;
  if (is_numbered_folder(truth) && read_sequence_index(truth, options.folder, index).ok())
    for (const StampedFile& pose : index.poses) files.reads(truth / pose.file);
  for (const std::filesystem::path& path :
       {options.ground_truth.path, options.estimate.path, std::filesystem::path(options.covariance),
        std::filesystem::path(options.motions)})
    files.reads(path);
  for (const std::string& path : options.kitti_times) files.reads(path);
  files.check();
}

void add_inputs(CLI::App& command, EvalOptions& options) {
  OptionGroup group(command);
  const auto file = [&](const char* name, auto& path, const char* what) {
    return group.add(name, "FILE", what, [&path](const std::string& text) -> std::string {
      path = text;
      return text.empty() ? "expected a path, not an empty word" : "";
    });
  };
  require(file("--gt", options.ground_truth.path,
               "Ground truth: a trajectory in the form of TUM, EuRoC or KITTI, or the folder or bag of a "
               "sequence"));
  require(file("--est", options.estimate.path, "The estimate: a trajectory in one of these forms"));
  const std::vector<std::pair<std::string, eval::TrajectoryFormat>> formats = {
      {"auto", eval::TrajectoryFormat::kAuto},
      {"tum", eval::TrajectoryFormat::kTum},
      {"euroc", eval::TrajectoryFormat::kEuroc},
      {"kitti", eval::TrajectoryFormat::kKitti}};
  group.choice("--gt-format", options.ground_truth.format, formats, "auto: told by the content (default)");
  group.choice("--est-format", options.estimate.format, formats, "auto: told by the content (default)");
  add_rate_option(group, options.folder.frames_per_s);
  takes_values(
      group.add("--kitti-times", "FILE",
                "Stamps of KITTI rows, one in seconds a line (default: 0.1 s apart); two files where truth "
                "and estimate have not the same",
                [&options](const std::string& text) -> std::string {
                  options.kitti_times.push_back(text);
                  return text.empty() ? "expected a path, not an empty word" : "";
                }),
      1, 2);
  file("--est-covariance", options.covariance,
       "Covariances of the estimate's poses (plvo run --covariance): adds their NEES");
  file("--est-motions", options.motions,
       "Motions with their covariances (plvo run --motions): adds their NEES");
}

}  // namespace

void add_eval(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App& command =
      add_command(app, "eval", "Compare an estimated trajectory with the ground truth", kEvalHelp);
  add_inputs(command, *options);
  OptionGroup group(command);
  group.choice("--gt-sampling", options->sampling,
               Choices<eval::GroundTruthSampling>{{"nearest", eval::GroundTruthSampling::kNearest},
                                                  {"interpolated", eval::GroundTruthSampling::kInterpolated}},
               "True pose at a stamp: interpolated (default), or the nearest, as TUM's scripts take it");
  group.number("--max-dt", options->max_difference_s, positive(3600), "SECONDS",
               "With --gt-sampling nearest: most that a pose is from its true pose (default 0.02)");
  takes_values(
      group.add("--gt-sigma", "NUMBER",
                "Two numbers: how far a true pose is off, standard deviations in each axis of its position "
                "(m) and orientation (degrees); joins the covariance in the NEES (default 0 0)",
                [options](const std::string& text) {
                  double value = 0;
                  std::string wrong = read_number(text, {0, 10}, value);
                  if (wrong.empty()) options->sigma.push_back(value);
                  return wrong;
                }),
      2, 2);
  group.flag("--fit-truth", options->fit_truth,
             "Compare with the truth turned (3 angles) and its clock shifted as explains the estimate best; "
             "not for comparing systems, for it flatters each");
  group.number("--offset", options->offset_s, {-4e9, 4e9}, "SECONDS", "Added to the stamps of the estimate");
  repeatable(group.add(
      "--rpe-delta", "DELTA",
      "Distance of the pairs of the relative error: 1f frames, 0.5s seconds, 2m metres; may be given "
      "several "
      "times (default 1f and 1s)",
      [options](const std::string& text) -> std::string {
        eval::RpeDelta delta;
        if (!eval::parse_rpe_delta(text, delta))
          return expected("frames, seconds or metres, such as 1f, 0.5s or 2m", text);
        options->deltas.push_back(delta);
        return {};
      }));
  group.path("--report", options->report, "A page that shows the comparison: one HTML file, no network");
  add_json_option(command, options->json);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return eval_command(*options);
  });
}

}  // namespace plvo::cli
