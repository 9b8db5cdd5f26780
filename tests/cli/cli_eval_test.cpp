// SPDX-License-Identifier: Apache-2.0
// Tests `plvo eval` through the command line, and against the independent script that defines its metrics.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "plvo/base/random.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo_command.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::kPlvo;
using test::run_command;
using test::run_plvo;
using test::TemporaryFolder;
using test::write_file;

fs::path shared() {
  const char* folder = std::getenv("PLVO_SHARED");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

// Writes a drifting estimate at the colour stamps of a sequence: the truth plus a random walk, with a few
// lost frames.
void write_estimate(const fs::path& sequence, const fs::path& estimate) {
  eval::Trajectory truth;
  ASSERT_TRUE(eval::read_trajectory({sequence / "groundtruth.txt", {}, {}}, truth).ok());
  Random random(11);
  const auto noise = [&random](double size) { return size * (2 * random.uniform() - 1); };
  Se3 drift{rotation_exp(Vector3(0.4, -0.3, 0.2)), Vector3(1, 2, 3)};
  std::string text = std::string(kTrajectoryHeader) + '\n';
  std::ifstream list(sequence / "rgb.txt");
  std::string line;
  for (int frame = 0; std::getline(list, line);) {
    if (line[0] == '#') continue;
    const auto stamp = static_cast<std::int64_t>(std::llround(std::stod(line) * 1e6)) * 1000;
    const auto sampled = eval::sample(truth, {stamp}, {eval::GroundTruthSampling::kNearest, 1'000'000'000});
    Vector6 step;
    step << noise(0.004), noise(0.004), noise(0.004), noise(0.003), noise(0.003), noise(0.003);
    drift = boxplus(drift, step);
    if (++frame % 17 != 0) text += trajectory_line(stamp, drift * sampled.poses[0]) + '\n';
  }
  write_file(estimate, text);
}

void compare(const nlohmann::json& ours, double theirs, const char* what) {
  EXPECT_NEAR(ours.get<double>(), theirs, 1e-6 * std::abs(theirs) + 1e-12) << what;
}

TEST(CliEval, AgreesWithTheIndependentScript) {
  const fs::path script = shared() / "eval" / "eval_rpe.py";
  if (!fs::exists(script)) GTEST_SKIP() << "the independent script is not here: " << script;
  if (run_command("/usr/bin/python3 -c 'import numpy'").exit_code != 0)
    GTEST_SKIP() << "python3-numpy is not installed";
  const TemporaryFolder folder;
  for (const char* name : {"fr1_rpy_150", "corridor_varying", "fr1_xyz_10f", "fr1_desk_9f"}) {
    const fs::path sequence = shared() / "data" / name;
    const fs::path estimate = folder / "estimate.txt";
    write_estimate(sequence, estimate);
    for (const auto& [ours_mode, their_mode] :
         {std::pair("nearest", "nearest"), std::pair("interpolated", "interp")}) {
      const std::string truth = (sequence / "groundtruth.txt").string();
      const CommandResult ours = run_plvo("eval --json - --gt " + truth + " --est " + estimate.string() +
                                          " --gt-sampling " + ours_mode);
      const CommandResult theirs = run_command("/usr/bin/python3 " + script.string() + ' ' + truth + ' ' +
                                               estimate.string() + " --json --gt " + their_mode);
      ASSERT_EQ(ours.exit_code, 0) << ours.err;
      ASSERT_EQ(theirs.exit_code, 0) << theirs.err;
      const auto a = nlohmann::json::parse(ours.out);
      const auto b = nlohmann::json::parse(theirs.out);
      SCOPED_TRACE(std::string(name) + ' ' + ours_mode);
      EXPECT_EQ(a["poses"], b["poses"]);
      compare(a["rpe"][0]["translation_m"]["rmse"], b["rpe_frame_t_mm"].get<double>() * 1e-3,
              "RPE per frame, mm");
      compare(a["rpe"][0]["rotation_deg"]["rmse"], b["rpe_frame_r_deg"], "RPE per frame, degrees");
      compare(a["rpe"][0]["translation_m"]["median"], b["rpe_frame_t_med_mm"].get<double>() * 1e-3, "median");
      compare(a["rpe"][0]["identity"]["translation_m"]["rmse"], b["gt_frame_t_mm"].get<double>() * 1e-3,
              "identity");
      compare(a["rpe"][0]["identity"]["rotation_deg"]["rmse"], b["gt_frame_r_deg"], "identity, degrees");
      if (b.contains("rpe_1s_t_m")) {
        EXPECT_EQ(a["rpe"][1]["pairs"], b["pairs_1s"]);
        compare(a["rpe"][1]["translation_m"]["rmse"], b["rpe_1s_t_m"], "RPE per second");
        compare(a["rpe"][1]["rotation_deg"]["rmse"], b["rpe_1s_r_deg"], "RPE per second, degrees");
      } else {
        EXPECT_EQ(a["rpe"][1]["pairs"], 0);
      }
      compare(a["ate_m"]["rmse"], b["ate_rmse_m"], "ATE");
      compare(a["ate_m"]["max"], b["ate_max_m"], "ATE, largest");
      compare(a["end_drift"]["translation_m"], b["end_t_m"], "end-point drift");
      compare(a["end_drift"]["rotation_deg"], b["end_r_deg"], "end-point drift, degrees");
      compare(a["path_m"], b["path_m"], "path");
    }
  }
}

class CliEvalFiles : public ::testing::Test {
 protected:
  CliEvalFiles() {
    std::string truth, covariances;
    for (int i = 0; i < 50; ++i) {
      const Se3 T{rotation_exp(Vector3(0, 0.01 * i, 0)), Vector3(0.01 * i, 0, 0)};
      truth += trajectory_line(i * 33'000'000LL, T) + '\n';
      covariances += covariance_line(i * 33'000'000LL, Matrix6::Identity() * 1e-6) + '\n';
    }
    write_file(folder_ / "gt.txt", truth);
    write_file(folder_ / "est.txt", truth);
    write_file(folder_ / "cov.txt", covariances);
  }
  CommandResult eval(const std::string& more) const {
    return run_plvo("eval --gt " + (folder_ / "gt.txt").string() + " --est " +
                    (folder_ / "est.txt").string() + ' ' + more);
  }
  TemporaryFolder folder_;
};

TEST_F(CliEvalFiles, TextHasEveryRow) {
  const CommandResult r =
      eval("--est-covariance " + (folder_ / "cov.txt").string() + " --rpe-delta 1f --rpe-delta 0.1m");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  for (const char* words : {"50 of 50 poses", "RPE per frame", "RPE over 0.1m", "identity", "ATE",
                            "end-point drift", "error against distance", "of the poses       all, 6"})
    EXPECT_NE(r.out.find(words), std::string::npos) << words << '\n' << r.out;
}

TEST_F(CliEvalFiles, ExitsWithTwoWhenUsageIsWrong) {
  EXPECT_EQ(run_plvo("eval").exit_code, 2);
  EXPECT_EQ(run_plvo("nonsense").exit_code, 2);
  EXPECT_EQ(run_plvo("eval --help").exit_code, 0);
  EXPECT_NE(run_plvo("--help").out.find("3 no frame could be tracked"), std::string::npos);
}

TEST_F(CliEvalFiles, UnneededKittiTimesAreRefused) {
  write_file(folder_ / "times.txt", "0.0\n");
  const CommandResult r = eval("--kitti-times " + (folder_ / "times.txt").string());
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.err.find("--kitti-times is for KITTI's rows"), std::string::npos) << r.err;
}

TEST_F(CliEvalFiles, MotionsAreTestedSinglyAndOverASecond) {
  std::string motions;
  for (int i = 1; i < 50; ++i) {
    TrackResult result;
    result.stamp_ns = i * 33'000'000LL;
    result.reference_stamp_ns = (i - 1) * 33'000'000LL;
    const auto truth = [](int k) {
      return Se3{rotation_exp(Vector3(0, 0.01 * k, 0)), Vector3(0.01 * k, 0, 0)};
    };
    // Each motion has an error of a millimetre along x: one standard deviation.
    result.T_camera_reference = truth(i).inverse() * truth(i - 1);
    result.T_camera_reference.t.x() += 1e-3;
    result.motion_covariance = 1e-6 * Matrix6::Identity();
    motions += motion_line(result) + '\n';
  }
  write_file(folder_ / "motions.txt", motions);
  const std::string more = "--est-motions " + (folder_ / "motions.txt").string();
  const CommandResult text = eval(more);
  for (const char* words : {"of the motions     all, 6", "over a second      all, 6", "translation, 3",
                            "rotation, 3", "21 samples, 1 of them apart"})
    EXPECT_NE(text.out.find(words), std::string::npos) << words << '\n' << text.out;
  const auto json = nlohmann::json::parse(eval(more + " --json -").out);
  EXPECT_EQ(json["nees_motion"]["samples"], 49);
  EXPECT_NEAR(json["nees_motion"]["mean"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(json["nees_motion"]["translation"]["median"].get<double>(), 1, 1e-3);
  EXPECT_NEAR(json["nees_motion"]["rotation"]["mean"].get<double>(), 0, 1e-3);
  // The noise of the truth triples the covariance.
  const auto noisy = nlohmann::json::parse(eval(more + " --gt-sigma 0.001 0 --json -").out);
  EXPECT_NEAR(noisy["nees_motion"]["mean"].get<double>(), 1.0 / 3, 1e-3);
  EXPECT_EQ(noisy["ground_truth_sigma"]["position_m"], 0.001);
  EXPECT_NE(eval(more + " --gt-sigma 0.001 0.5")
                .out.find("of a true pose, in the covariance as well: 1.000 mm, 0.5000 deg"),
            std::string::npos);
  EXPECT_EQ(eval("--gt-sigma 0.001 0").exit_code, 2);
  EXPECT_EQ(eval(more + " --gt-sigma 0.001").exit_code, 2);
  EXPECT_EQ(eval(more + " --gt-sigma -1 0").exit_code, 2);
  // The same error thirty times in a row is not noise.
  EXPECT_EQ(json["nees_second"]["samples"], 21);
  EXPECT_EQ(json["nees_second"]["translation"]["expected"], 3);
  EXPECT_GT(json["nees_second"]["mean"].get<double>(), json["nees_second"]["mean_band_95"][1].get<double>());
}

// The camera of the truth is rotated by half a degree and its clock is 20 ms late: this counts as an error of
// a perfect estimate until the truth is fitted.
TEST_F(CliEvalFiles, RotatedAndLateTruthIsFitted) {
  const Matrix3 turn = rotation_exp(Vector3(0.003, -0.006, 0.005));
  const auto exact = [](int i) {
    const double t = 0.01 * i;
    return Se3{
        rotation_exp(Vector3(0.3 * std::sin(2.1 * t), 0.4 * std::sin(1.7 * t), 0.3 * std::sin(2.9 * t))),
        Vector3(0.3 * std::sin(1.3 * t), 0.2 * std::sin(2.3 * t), 0)};
  };
  std::string truth, estimate, motions;
  for (int i = 0; i < 1000; ++i) {
    const Se3 T = exact(i);
    truth += trajectory_line((i + 2) * 10'000'000LL, {T.R * turn.transpose(), T.t}) + '\n';
    if (i % 4 != 0) continue;
    estimate += trajectory_line(i * 10'000'000LL, T) + '\n';
    if (i == 0) continue;
    TrackResult result;
    result.stamp_ns = i * 10'000'000LL;
    result.reference_stamp_ns = (i - 4) * 10'000'000LL;
    result.T_camera_reference = T.inverse() * exact(i - 4);
    result.motion_covariance = 1e-8 * Matrix6::Identity();
    motions += motion_line(result) + '\n';
  }
  write_file(folder_ / "gt.txt", truth);
  write_file(folder_ / "est.txt", estimate);
  write_file(folder_ / "motions.txt", motions);
  const std::string more = "--est-motions " + (folder_ / "motions.txt").string();
  const auto plain = nlohmann::json::parse(eval(more + " --json -").out);
  const auto fitted = nlohmann::json::parse(eval(more + " --fit-truth --json -").out);
  EXPECT_FALSE(plain.contains("truth_fit"));
  EXPECT_NEAR(fitted["truth_fit"]["rotation_deg"][1].get<double>(), -0.006 * 57.29578, 0.01);
  EXPECT_LT(fitted["truth_fit"]["rotation_sigma_deg"][1].get<double>(), 0.01);
  EXPECT_NEAR(fitted["truth_fit"]["clock_ms"].get<double>(), 20, 0.1);
  EXPECT_LT(fitted["truth_fit"]["clock_sigma_ms"].get<double>(), 0.1);
  const auto second = [](const nlohmann::json& json) {
    return json["rpe"][1]["rotation_deg"]["rmse"].get<double>();
  };
  EXPECT_EQ(fitted["truth_fit"]["second_before"]["rotation_deg"]["rmse"], second(plain));
  EXPECT_GT(second(plain), 0.1);
  EXPECT_LT(second(fitted), 0.01);
  EXPECT_GT(plain["nees_second"]["mean"].get<double>(), 6);
  EXPECT_LT(fitted["nees_second"]["mean"].get<double>(), 6);
  EXPECT_LT(fitted["ate_m"]["max"].get<double>(), 1e-3);
  EXPECT_NE(eval("--fit-truth").out.find("truth fitted to the estimate"), std::string::npos);
  const CommandResult nearest = eval("--fit-truth --gt-sampling nearest");
  EXPECT_EQ(nearest.exit_code, 2);
  EXPECT_NE(nearest.err.find("leave --gt-sampling nearest out"), std::string::npos) << nearest.err;
}

// The message names the option to use, as long as there is one.
TEST_F(CliEvalFiles, ANeesFarFromSixIsExplained) {
  Random random(5);
  std::string truth, estimate, small, large;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.033 * i;
    const Se3 T{
        rotation_exp(Vector3(0.3 * std::sin(2.1 * t), 0.4 * std::sin(1.7 * t), 0.3 * std::sin(2.9 * t))),
        Vector3(std::sin(t), 0.2 * std::sin(2.3 * t), 0)};
    Vector6 error;
    for (double& e : error) e = 0.004 * (2 * random.uniform() - 1);
    truth += trajectory_line(i * 33'000'000LL, T) + '\n';
    estimate += trajectory_line(i * 33'000'000LL, boxplus(T, error)) + '\n';
    small += covariance_line(i * 33'000'000LL, Matrix6::Identity() * 1e-6) + '\n';
    large += covariance_line(i * 33'000'000LL, Matrix6::Identity()) + '\n';
  }
  write_file(folder_ / "gt.txt", truth);
  write_file(folder_ / "est.txt", estimate);
  write_file(folder_ / "small.txt", small);
  write_file(folder_ / "large.txt", large);
  const auto says = [](const CommandResult& r, const char* words) {
    return r.err.find(words) != std::string::npos;
  };
  const std::string too_small = "--est-covariance " + (folder_ / "small.txt").string();
  CommandResult r = eval(too_small + " --json -");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_TRUE(says(r, "the NEES of the poses is ") && says(r, "where a true covariance gives 6")) << r.err;
  EXPECT_TRUE(says(r, "--fit-truth finds both") && says(r, "--gt-sigma METRES DEGREES adds it")) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  ASSERT_EQ(json["warnings"].size(), 1u);
  EXPECT_TRUE(says(r, json["warnings"][0].get<std::string>().c_str()));
  r = eval(too_small + " --fit-truth");
  EXPECT_TRUE(says(r, "--gt-sigma") && !says(r, "--fit-truth")) << r.err;
  r = eval(too_small + " --gt-sigma 0.0001 0.001");
  EXPECT_TRUE(!says(r, "--gt-sigma") && says(r, "--fit-truth")) << r.err;
  r = eval(too_small + " --fit-truth --gt-sigma 0.0001 0.001");
  EXPECT_TRUE(says(r, "the covariance is too small, and its standard deviations should be ")) << r.err;
  EXPECT_TRUE(!says(r, "--gt-sigma") && !says(r, "--fit-truth")) << r.err;
  EXPECT_EQ(eval(too_small + " --gt-sigma 0.002 0.12").err, "");
  r = eval("--est-covariance " + (folder_ / "large.txt").string());
  EXPECT_TRUE(says(r, "the covariance is larger than the errors")) << r.err;
}

// Lengths that are five times too long suggest a wrong unit of depth. A bad estimate does not, although some
// scale fits it slightly better.
TEST_F(CliEvalFiles, WrongScaleIsReported) {
  Random random(6);
  std::string truth, fivefold, slightly, bad;
  for (int i = 0; i < 200; ++i) {
    const Vector3 t(std::sin(0.04 * i), 0.2 * std::sin(0.1 * i), 0.01 * i);
    const Vector3 off(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    const auto line = [i](const Vector3& p) {
      return trajectory_line(i * 33'000'000LL, {Matrix3::Identity(), p}) + '\n';
    };
    truth += line(t);
    fivefold += line(5 * t + 0.01 * off);
    slightly += line(1.04 * t);
    bad += line(t + 2 * off);
  }
  write_file(folder_ / "gt.txt", truth);
  write_file(folder_ / "est.txt", fivefold);
  const CommandResult r = eval("--json -");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.err.find("the estimate's lengths are 5 times the true ones"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("is the unit of depth right"), std::string::npos) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_NEAR(json["scale"]["best_fit"].get<double>(), 0.2, 1e-3);
  EXPECT_LT(json["scale"]["ate_rmse_m"].get<double>(), 0.01);
  EXPECT_GT(json["ate_m"]["rmse"].get<double>(), 1);
  write_file(folder_ / "est.txt", slightly);
  EXPECT_EQ(eval("").err, "");
  write_file(folder_ / "est.txt", bad);
  const CommandResult noisy = eval("--json -");
  EXPECT_EQ(noisy.err, "");
  EXPECT_LT(nlohmann::json::parse(noisy.out)["scale"]["best_fit"].get<double>(), 0.95);
}

TEST_F(CliEvalFiles, TooShortRecordingIsNotFitted) {
  const CommandResult r = eval("--fit-truth");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("the truth cannot be fitted"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("take a longer recording"), std::string::npos) << r.err;
}

TEST_F(CliEvalFiles, FilesOfTwoClocksAreNamedWithBoth) {
  std::string late, milliseconds;
  for (int i = 0; i < 50; ++i) {
    late += trajectory_line(90'000'000'000LL + i * 33'000'000LL, Se3()) + '\n';
    milliseconds += std::to_string(33 * i) + " 0 0 0 0 0 0 1\n";
  }
  write_file(folder_ / "est.txt", late);
  CommandResult r = eval("");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("the truth goes from 0.00 to 1.62 s, the estimate from 90.00 to 91.62"),
            std::string::npos)
      << r.err;
  EXPECT_NE(r.err.find("--offset -90.00 lets both begin together)"), std::string::npos) << r.err;
  EXPECT_EQ(eval("--offset -90").exit_code, 0);
  write_file(folder_ / "est.txt", milliseconds);
  r = eval("");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("the stamps of the estimate look wrong, they lie 33 s apart, as milliseconds would"),
            std::string::npos)
      << r.err;
}

// Files of one name in two folders, ranked in one picture; what is for one estimate is refused.
TEST_F(CliEvalFiles, SeveralEstimatesAreRanked) {
  std::string worse, half;
  for (int i = 0; i < 50; ++i) {
    const Se3 T{rotation_exp(Vector3(0, 0.01 * i, 0)), Vector3(0.011 * i, 0, 0)};
    worse += trajectory_line(i * 33'000'000LL, T) + '\n';
    if (i < 25) half += trajectory_line(i * 33'000'000LL, T) + '\n';
  }
  std::filesystem::create_directory(folder_ / "other");
  write_file(folder_ / "other/est.txt", worse);
  write_file(folder_ / "half.txt", half);
  const std::string gt = "eval --gt " + (folder_ / "gt.txt").string();
  const std::string more = gt + " --est " + (folder_ / "half.txt").string() + ' ' +
                           (folder_ / "other/est.txt").string() + ' ' + (folder_ / "est.txt").string();
  const std::string plot = (folder_ / "plot.svg").string();
  const CommandResult r = run_plvo(more + " --plot " + plot);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  const std::size_t first = r.out.find("   1  " + (folder_ / "est.txt").string());
  const std::size_t second = r.out.find("   2  " + (folder_ / "other/est.txt").string());
  const std::size_t third = r.out.find("   3  " + (folder_ / "half.txt").string());
  EXPECT_TRUE(first < second && second < third && third != std::string::npos) << r.out;
  EXPECT_NE(r.err.find("half.txt covers 0.8 s, another estimate 1.6 s"), std::string::npos) << r.err;
  const std::string svg = test::read_file(plot);
  EXPECT_EQ(svg.substr(0, 5), "<?xml");
  EXPECT_NE(svg.find("other/est.txt: ATE"), std::string::npos);
  const auto json = nlohmann::json::parse(run_plvo(more + " --json -").out);
  ASSERT_EQ(json["estimates"].size(), 3u);
  EXPECT_EQ(json["estimates"][0]["estimate"], (folder_ / "est.txt").string());
  for (const char* option :
       {"--report r.html", "--est-covariance c.txt", "--est-motions m.txt", "--fit-truth"}) {
    const CommandResult refused = run_plvo(more + ' ' + option);
    EXPECT_EQ(refused.exit_code, 2) << option;
    EXPECT_NE(refused.err.find("leave it out"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(run_plvo(more + " --plot " + (folder_ / "est.txt").string()).exit_code, 2) << "an input";
  EXPECT_EQ(run_plvo(more + " --plot /nowhere/plot.svg").exit_code, 1);
  write_file(folder_ / "late.txt", trajectory_line(90'000'000'000LL, Se3()) + '\n');
  const CommandResult late = run_plvo(more + ' ' + (folder_ / "late.txt").string());
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_NE(late.err.find("late.txt: only 0 of 1 poses have ground truth"), std::string::npos) << late.err;
}

TEST_F(CliEvalFiles, OneEstimateHasAPicture) {
  const CommandResult r = eval("--plot -");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.out.substr(0, 5), "<?xml");
  EXPECT_NE(r.err.find("RPE per frame"), std::string::npos) << "the text steps aside";
}

TEST_F(CliEvalFiles, MissingAndDamagedFilesAreOneLine) {
  for (const char* more : {"--est-covariance /nowhere", "--est-motions /nowhere", "--est /nowhere"}) {
    const CommandResult r =
        run_plvo("eval --gt " + (folder_ / "gt.txt").string() + ' ' + more +
                 (std::string(more).find("--est ") == 0 ? "" : " --est " + (folder_ / "est.txt").string()));
    EXPECT_EQ(r.exit_code, 1) << more;
    EXPECT_NE(r.err.find("plvo: error: cannot read /nowhere"), std::string::npos) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  }
  write_file(folder_ / "est.txt", "0.0 1 2\n");
  EXPECT_EQ(eval("").exit_code, 1);
  EXPECT_NE(eval("").err.find("line 1: has 3 columns"), std::string::npos);
}

TEST_F(CliEvalFiles, FullStandardOutputIsAnError) {
  const std::string command =
      kPlvo + " eval --gt " + (folder_ / "gt.txt").string() + " --est " + (folder_ / "est.txt").string();
  EXPECT_EQ(run_command("sh -c '" + command + " >/dev/full'").exit_code, 1);
}

}  // namespace
}  // namespace plvo
