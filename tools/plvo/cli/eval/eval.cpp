// SPDX-License-Identifier: Apache-2.0
// plvo eval: one or several estimates against the ground truth.
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
#include "plvo/eval/ranking.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/stderr_log.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/replay/index/numbered_index.hpp"
#include "plvo/report/plot.hpp"
#include "plvo/report/report.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kEvalHelp =
    "Examples:\n"
    "  plvo eval --gt sequence/groundtruth.txt --est trajectory.txt\n"
    "  plvo eval --gt chess/seq-01 --est trajectory.txt     the poses of numbered frames\n"
    "  plvo eval --gt recording.bag --est trajectory.txt    recording-groundtruth.txt beside the bag\n"
    "  plvo eval --gt sequence/groundtruth.txt --est t.txt --est-covariance c.txt --report report.html\n"
    "  plvo eval --gt sequence/groundtruth.txt --est a.txt b.txt --plot all.svg   ranked, one picture\n";

constexpr int kMostEstimates = 100;

struct EvalOptions {
  eval::TrajectorySource ground_truth;
  std::vector<std::filesystem::path> estimates;
  eval::TrajectoryFormat estimate_format = eval::TrajectoryFormat::kAuto;
  std::string covariance, motions, report, plot;
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

std::string ignored_rows_of(const std::string& file, const eval::Trajectory& trajectory) {
  return fmt::format("{}: {} poses with a NaN, an infinity or a repeated stamp were ignored", file,
                     trajectory.ignored_rows);
}

struct EvalInputs {
  eval::Trajectory ground_truth;
  std::vector<eval::Trajectory> estimates;
  std::vector<eval::StampedCovariance> covariances;
  std::vector<eval::UncertainMotion> motions;
};

Status read_inputs(const EvalOptions& options, EvalInputs& inputs) {
  const std::filesystem::path& truth = options.ground_truth.path;
  Status status = is_recording(truth) ? read_true_poses(truth, options.folder, inputs.ground_truth)
                                      : read_trajectory(options.ground_truth, inputs.ground_truth);
  bool kitti = inputs.ground_truth.format == eval::TrajectoryFormat::kKitti;
  for (const std::filesystem::path& path : options.estimates) {
    eval::TrajectorySource source{path, options.estimate_format, {}};
    if (!options.kitti_times.empty()) source.kitti_times = options.kitti_times.back();
    eval::Trajectory& estimate = inputs.estimates.emplace_back();
    if (status.ok()) status = read_trajectory(source, estimate);
    if (status.ok() && !stamps_are_moderate(estimate))
      status = {StatusCode::kInvalidArgument, path.string() + " has stamps beyond 146 years"};
    kitti = kitti || estimate.format == eval::TrajectoryFormat::kKitti;
  }
  if (status.ok() && !options.covariance.empty())
    status = eval::read_covariances(options.covariance, inputs.covariances);
  if (status.ok() && !options.motions.empty()) status = eval::read_motions(options.motions, inputs.motions);
  if (status.ok() && !options.kitti_times.empty() && !kitti)
    refuse_command("--kitti-times is for KITTI's rows of 12 numbers, and no file has them; leave it out");
  return status;
}

eval::EvaluationOptions settings_of(const EvalOptions& options) {
  eval::EvaluationOptions settings;
  settings.sampling.method = options.sampling;
  settings.sampling.max_difference_ns = static_cast<std::int64_t>(options.max_difference_s * 1e9);
  settings.offset_ns = static_cast<std::int64_t>(options.offset_s * 1e9);
  settings.deltas = options.deltas;
  if (!options.sigma.empty()) settings.truth_sigma = {options.sigma[0], options.sigma[1] * kPi / 180};
  settings.fit_truth = options.fit_truth;
  return settings;
}

// Evaluates each estimate; ranked, best first.
Status evaluate_all(const EvalOptions& options, const EvalInputs& inputs,
                    std::vector<eval::NamedEvaluation>& results) {
  const eval::EvaluationOptions settings = settings_of(options);
  for (std::size_t i = 0; i < inputs.estimates.size(); ++i) {
    eval::NamedEvaluation& result = results.emplace_back();
    result.name = options.estimates[i].string();
    const Status status = evaluate(inputs.ground_truth, inputs.estimates[i], inputs.covariances,
                                   inputs.motions, settings, result.evaluation);
    if (!status.ok() && inputs.estimates.size() > 1)
      return {status.code(), fmt::format("{}: {}", result.name, status.message())};
    if (!status.ok()) return status;
    if (inputs.estimates[i].ignored_rows > 0)
      result.warnings.push_back(ignored_rows_of(result.name, inputs.estimates[i]));
    for (std::string& sentence : doubts_about(result.evaluation))
      result.warnings.push_back(std::move(sentence));
  }
  eval::rank(results);
  return {};
}

Status write_comparison_report(const EvalOptions& options, const EvalInputs& inputs,
                               const eval::NamedEvaluation& result) {
  report::ReportInput input;
  input.title = options.estimates[0].filename().string();
  input.subtitle = "plvo " PLVO_VERSION ": compared with " + options.ground_truth.path.string() +
                   (options.fit_truth ? ", turned and shifted to fit" : "");
  input.trajectory = inputs.estimates[0];
  input.evaluation = result.evaluation;
  return report::write_report(options.report, input);
}

// The legend has the figure that ranks.
Status write_comparison_plot(const EvalOptions& options, const std::vector<eval::NamedEvaluation>& results) {
  std::vector<report::PlottedEstimate> plotted;
  for (const eval::NamedEvaluation& result : results) {
    const eval::RpeResult& rpe = result.evaluation.rpe.back();
    std::string label =
        fmt::format("{}: ATE {:.1f} mm", result.name, 1e3 * result.evaluation.ate.position_m.rmse);
    if (rpe.estimate.translation_m.count > 0)
      label += fmt::format(", RPE over {} {:.1f} mm, {:.2f}°", rpe.delta.text,
                           1e3 * rpe.estimate.translation_m.rmse, rpe.estimate.rotation_deg.rmse);
    plotted.push_back({label, &result.evaluation});
  }
  return report::write_plot(options.plot, "compared with " + options.ground_truth.path.string(), plotted);
}

int eval_command(EvalOptions options) {
  if (!options.kitti_times.empty()) options.ground_truth.kitti_times = options.kitti_times.front();
  EvalInputs inputs;
  Status status = read_inputs(options, inputs);
  for (const std::string& file : {options.report, options.plot, options.json})
    if (status.ok() && !file.empty()) status = LineFile::check(file);
  std::vector<eval::NamedEvaluation> results;
  if (status.ok()) status = evaluate_all(options, inputs, results);
  if (!status.ok()) return fail(status);

  const bool several = results.size() > 1;
  std::vector<std::string> warnings;
  if (inputs.ground_truth.ignored_rows > 0)
    warnings.push_back(ignored_rows_of(options.ground_truth.path.string(), inputs.ground_truth));
  if (several)
    for (std::string& sentence : eval::doubts_about_ranking(results)) warnings.push_back(std::move(sentence));
  for (const std::string& sentence : warnings) warn(sentence);
  for (const eval::NamedEvaluation& result : results)
    for (const std::string& sentence : result.warnings)
      warn(several && sentence.rfind(result.name, 0) != 0 ? result.name + ": " + sentence : sentence);

  const Status reported =
      options.report.empty() ? Status() : write_comparison_report(options, inputs, results[0]);
  const Status plotted = options.plot.empty() ? Status() : write_comparison_plot(options, results);
  nlohmann::ordered_json json = several ? ranking_json(results) : to_json(results[0].evaluation);
  if (!several) warnings.insert(warnings.end(), results[0].warnings.begin(), results[0].warnings.end());
  json["warnings"] = warnings;
  const Status result = write_result(
      options.json, json, [&] { return several ? ranking_text(results) : to_text(results[0].evaluation); },
      is_standard_output(options.report) || is_standard_output(options.plot));
  int exit_code = kExitSuccess;
  for (const Status& written : {reported, plotted, result})
    if (!written.ok()) exit_code = fail(written);
  StderrLog log;
  tell_written(log, {reported.ok() ? options.report : "", plotted.ok() ? options.plot : "",
                     result.ok() ? options.json : ""});
  return exit_code;
}

void check(const CLI::App& command, const EvalOptions& options) {
  if (options.sampling != eval::GroundTruthSampling::kNearest)
    refuse_options(command, {"--max-dt"}, "is for --gt-sampling nearest; add that, or leave it out");
  if (options.sampling == eval::GroundTruthSampling::kNearest)
    refuse_options(command, {"--fit-truth"},
                   "shifts the truth's clock, so that it is interpolated; leave --gt-sampling nearest out");
  if (options.covariance.empty() && options.motions.empty())
    refuse_options(command, {"--gt-sigma"}, "is for the NEES; add --est-covariance or --est-motions");
  const std::filesystem::path& truth = options.ground_truth.path;
  if (is_recording(truth))
    refuse_options(command, {"--gt-format"}, "is for a trajectory, and --gt names a recording");
  if (std::any_of(options.estimates.begin(), options.estimates.end(), is_bag))
    refuse("--est", "a ROS bag is a recording; name the trajectory that plvo run --out made of it");
  if (options.estimates.size() > 1) {
    refuse_options(command, {"--est-covariance", "--est-motions", "--report"},
                   "is for one estimate, and --est names several; leave it out, or compare each by itself");
    refuse_options(command, {"--fit-truth"},
                   "fits the truth to one estimate, so that each would be compared with another truth; leave "
                   "it out where several are ranked");
  }
  if (!is_numbered_folder(truth)) refuse_options(command, {"--rate"}, "is for a folder of numbered frames");
  FileRoles files;
  files.writes("--report", options.report);
  files.writes("--plot", options.plot);
  files.writes("--json", options.json);
  files.reads(is_bag(truth) ? bag_ground_truth_file(truth) : truth / "groundtruth.txt");
  for (const std::filesystem::path& file : bag_files_in(truth)) files.reads(file);
  SequenceIndex index;
  if (is_numbered_folder(truth) && read_sequence_index(truth, options.folder, index).ok())
    for (const StampedFile& pose : index.poses) files.reads(truth / pose.file);
  for (const std::filesystem::path& path :
       {options.ground_truth.path, std::filesystem::path(options.covariance),
        std::filesystem::path(options.motions)})
    files.reads(path);
  for (const std::filesystem::path& path : options.estimates) files.reads(path);
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
  CLI::Option* estimates =
      group.add("--est", "FILE", "The estimate: a trajectory in one of these forms; several are ranked",
                [&options](const std::string& text) -> std::string {
                  options.estimates.emplace_back(text);
                  return text.empty() ? "expected a path, not an empty word" : "";
                });
  require(estimates);
  takes_values(estimates, 1, kMostEstimates);
  const std::vector<std::pair<std::string, eval::TrajectoryFormat>> formats = {
      {"auto", eval::TrajectoryFormat::kAuto},
      {"tum", eval::TrajectoryFormat::kTum},
      {"euroc", eval::TrajectoryFormat::kEuroc},
      {"kitti", eval::TrajectoryFormat::kKitti}};
  group.choice("--gt-format", options.ground_truth.format, formats,
               "auto: detected from the content (default)");
  group.choice("--est-format", options.estimate_format, formats, "auto: detected from the content (default)");
  add_rate_option(group, options.folder.frames_per_s);
  takes_values(group.add("--kitti-times", "FILE",
                         "Stamps of KITTI rows, one in seconds a line (default: 0.1 s apart); two files if "
                         "truth and estimate have different ones",
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
               "With --gt-sampling nearest: largest time between a pose and its true pose (default 0.02)");
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
             "not for comparing systems, because it flatters each");
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
  group.path("--plot", options->plot,
             "A picture as SVG: the trajectories, their errors over time and over the distance travelled");
  group.path("--report", options->report, "A page that shows the comparison: one HTML file, no network");
  add_json_option(command, options->json);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return eval_command(*options);
  });
}

}  // namespace plvo::cli
