// SPDX-License-Identifier: Apache-2.0
// plvo eval: an estimate against the ground truth.
#include <fmt/core.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/eval/evaluation.hpp"
#include "plvo/report/report.hpp"

namespace plvo::cli {
namespace {

struct EvalOptions {
  eval::TrajectorySource ground_truth, estimate;
  std::string kitti_times, covariance, motions, report;
  eval::GroundTruthSampling sampling = eval::GroundTruthSampling::kInterpolated;
  double max_difference_s = 0.02;
  double offset_s = 0;
  std::vector<std::string> deltas;
  bool json = false;
};

int eval_command(EvalOptions options) {
  eval::EvaluationOptions settings;
  settings.sampling = options.sampling;
  settings.max_difference_ns = static_cast<std::int64_t>(options.max_difference_s * 1e9);
  settings.offset_ns = static_cast<std::int64_t>(options.offset_s * 1e9);
  for (const std::string& text : options.deltas) {
    eval::RpeDelta delta;
    if (!eval::parse_rpe_delta(text, delta)) return kExitUsage;  // refused by the option's own check before
    settings.deltas.push_back(delta);
  }
  options.ground_truth.kitti_times = options.estimate.kitti_times = options.kitti_times;

  eval::Trajectory ground_truth, estimate;
  std::vector<eval::StampedCovariance> covariances;
  std::vector<eval::UncertainMotion> motions;
  eval::Evaluation evaluation;
  Status status = read_trajectory(options.ground_truth, ground_truth);
  if (status.ok()) status = read_trajectory(options.estimate, estimate);
  const auto kitti = [](const eval::Trajectory& t) { return t.format == eval::TrajectoryFormat::kKitti; };
  if (status.ok() && !options.kitti_times.empty() && !kitti(ground_truth) && !kitti(estimate)) {
    fail("--kitti-times is for KITTI's rows of 12 numbers, and neither file has them; leave it out");
    return kExitUsage;
  }
  if (status.ok() && !options.covariance.empty())
    status = eval::read_covariances(options.covariance, covariances);
  if (status.ok() && !options.motions.empty()) status = eval::read_motions(options.motions, motions);
  if (status.ok()) status = evaluate(ground_truth, estimate, covariances, motions, settings, evaluation);
  if (!status.ok()) return fail(status);
  for (const auto& [trajectory, source] :
       {std::pair(&ground_truth, &options.ground_truth), std::pair(&estimate, &options.estimate)})
    if (trajectory->ignored_rows > 0)
      warn(fmt::format("{}: {} rows with a NaN or a repeated stamp were ignored", source->path.string(),
                       trajectory->ignored_rows));
  if (!options.report.empty()) {
    report::ReportInput input;
    input.title = options.estimate.path.filename().string();
    input.subtitle = "plvo " PLVO_VERSION ": compared with " + options.ground_truth.path.string();
    input.trajectory = estimate;
    input.evaluation = evaluation;
    if (const Status written = report::write_report(options.report, input); !written.ok())
      return fail(written);
  }
  const std::string text = options.json ? to_json(evaluation).dump(2) + '\n' : to_text(evaluation);
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    return fail("cannot write to standard output");
  return kExitSuccess;
}

std::string check_delta(const std::string& text) {
  eval::RpeDelta delta;
  return eval::parse_rpe_delta(text, delta)
             ? ""
             : "expected frames, seconds or metres, such as 1f, 0.5s or 2m: " + text;
}

}  // namespace

void add_eval(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand("eval", "Compare an estimated trajectory with the ground truth");
  command->add_option("--gt", options->ground_truth.path, "Ground truth")->required()->type_name("FILE");
  command->add_option("--est", options->estimate.path, "Estimated trajectory")->required()->type_name("FILE");
  const std::map<std::string, eval::TrajectoryFormat> formats = {{"auto", eval::TrajectoryFormat::kAuto},
                                                                 {"tum", eval::TrajectoryFormat::kTum},
                                                                 {"euroc", eval::TrajectoryFormat::kEuroc},
                                                                 {"kitti", eval::TrajectoryFormat::kKitti}};
  for (const auto& [name, source] :
       {std::pair("--gt-format", &options->ground_truth), std::pair("--est-format", &options->estimate)}) {
    command->add_option(name, source->format, "auto (told by the content), tum, euroc or kitti")
        ->transform(CLI::CheckedTransformer(formats).description(""))
        ->type_name("FORMAT");
  }
  command->add_option("--kitti-times", options->kitti_times, "Stamps of KITTI rows, one in seconds a line")
      ->type_name("FILE");
  const std::map<std::string, eval::GroundTruthSampling> samplings = {
      {"nearest", eval::GroundTruthSampling::kNearest},
      {"interpolated", eval::GroundTruthSampling::kInterpolated}};
  command
      ->add_option("--gt-sampling", options->sampling, "nearest (as TUM's scripts) or interpolated (default)")
      ->transform(CLI::CheckedTransformer(samplings).description(""))
      ->type_name("WAY");
  command
      ->add_option("--max-dt", options->max_difference_s,
                   "Largest distance of a pose to its true pose, nearest sampling")
      ->check(CLI::PositiveNumber.description(""))
      ->capture_default_str()
      ->type_name("SECONDS");
  command->add_option("--offset", options->offset_s, "Added to the stamps of the estimate")
      ->type_name("SECONDS");
  command
      ->add_option("--rpe-delta", options->deltas,
                   "Distance of RPE pairs: 1f frames, 1s seconds, 2m metres; repeatable (default 1f and 1s)")
      ->check(CLI::Validator(check_delta, ""))
      ->type_name("DELTA");
  command
      ->add_option("--covariance", options->covariance,
                   "Covariances of the poses (plvo run --covariance): NEES")
      ->type_name("FILE");
  command
      ->add_option("--motions", options->motions,
                   "Motions with covariances (plvo run --motions): NEES per motion")
      ->type_name("FILE");
  command
      ->add_option("--report", options->report, "A page that shows the comparison: one HTML file, no network")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print JSON instead of text");
  command->footer(kExitCodeHelp);
  command->callback([options, &exit_code] { exit_code = eval_command(*options); });
}

}  // namespace plvo::cli
