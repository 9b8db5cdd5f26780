// SPDX-License-Identifier: Apache-2.0
// Tests the destinations of results: no output overwrites an input or another output, pipes work, and a
// failed write is reported.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo_command.hpp"
#include "simulated_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::kPlvo;
using test::read_file;
using test::run_command;
using test::write_file;

constexpr int kShortFrames = 4;

const fs::path& short_recording() { return test::simulated_sequence<kShortFrames>(); }

class CliOutputs : public test::PlvoCommand {
 protected:
  CliOutputs() { fs::copy(short_recording(), folder_ / "sequence", fs::copy_options::recursive); }
  CommandResult run(const std::string& more) const { return plvo("run " + path("sequence") + ' ' + more); }
  void expect_refused(const CommandResult& r, const std::string& words) const {
    PlvoCommand::expect_refused(r, 2, words);
  }
  static std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }
  fs::path first_image(const char* kind) const {
    return fs::directory_iterator(folder_ / "sequence" / kind)->path();
  }
};

TEST_F(CliOutputs, NoOutputOverwritesAnInput) {
  const std::string truth = read_file(folder_ / "sequence/groundtruth.txt");
  fs::create_symlink(folder_ / "sequence/groundtruth.txt", folder_ / "link");
  fs::create_hard_link(folder_ / "sequence/groundtruth.txt", folder_ / "hard");
  for (const std::string& name :
       {path("sequence/groundtruth.txt"), path("sequence/../sequence/./groundtruth.txt"), path("link"),
        path("hard"), first_image("rgb").string(), path("sequence/calibration.txt")}) {
    for (const char* option : {"--out ", "--covariance ", "--motions ", "--stats ", "--json ", "--report "})
      expect_refused(run(option + name), "is an input, which would be overwritten; choose another name");
    EXPECT_EQ(read_file(folder_ / "sequence/groundtruth.txt"), truth);
  }
  // Paths relative to the working directory.
  expect_refused(run_command("cd " + path("sequence") + " && " + kPlvo + " run . --out rgb.txt"),
                 "--out: rgb.txt is");
  expect_refused(run("--overlay " + path("sequence/rgb")), "holds inputs, which could be overwritten");
  write_file(folder_ / "c.txt", "131 131 79.5 59.5 5000\n");
  expect_refused(run("--calibration " + path("c.txt") + " --out " + path("c.txt")), "is an input");
  // A result in the folder of the sequence is no input.
  EXPECT_EQ(run("--quiet --out " + path("sequence/estimate.txt")).exit_code, 0);
  EXPECT_EQ(run("--quiet --out " + path("sequence/estimate.txt")).exit_code, 0);
}

TEST_F(CliOutputs, OtherCommandsKeepTheirInputs) {
  const std::string truth = path("sequence/groundtruth.txt");
  const std::string before = read_file(truth);
  const std::string eval = kPlvo + " eval --gt " + truth + " --est " + truth;
  expect_refused(run_command(eval + " --report " + truth), "--report: ");
  expect_refused(run_command(eval + " --json " + truth), "--json: ");
  fs::create_directory(folder_ / "new");
  fs::copy(truth, folder_ / "new/groundtruth.txt");
  expect_refused(plvo("simulate --scene bare --size 96x64 --frames 1 --trajectory " +
                      path("new/groundtruth.txt") + " --out " + path("new")),
                 "is an input");
  write_file(folder_ / "recording.oni", "mine");
  expect_refused(plvo("live --device " + path("recording.oni") + " --out " + path("recording.oni")),
                 "is an input");
  expect_refused(plvo("run " + path("recording.oni") + " --stats " + path("recording.oni")), "is an input");
  expect_refused(plvo("record " + path("recording.oni") + " --device " + path("recording.oni")),
                 "is an input");
  fs::create_directory(folder_ / "half");
  write_file(folder_ / "half/calibration.txt", "131 131 79.5 59.5 5000\n");
  expect_refused(plvo("record " + path("half") + " --calibration " + path("half/calibration.txt")),
                 "is an input");
  expect_refused(plvo("doctor --calibration " + path("half/calibration.txt") + " --json " +
                      path("half/calibration.txt")),
                 "is an input");
  EXPECT_EQ(read_file(truth), before);
  EXPECT_EQ(read_file(folder_ / "recording.oni"), "mine");
}

TEST_F(CliOutputs, TwoOutputsNeedTwoFiles) {
  expect_refused(run("--out " + path("a") + " --stats " + path("a")), "is already written by --out");
  expect_refused(run("--out " + path("a") + " --json " + path("sequence/../a")),
                 "is already written by --out");
  fs::create_symlink("a", folder_ / "link");  // the target does not exist yet
  expect_refused(run("--out " + path("a") + " --report " + path("link")), "is already written by --out");
  expect_refused(run("--out - --stats /dev/stdout"), "standard output is already written by --out");
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  EXPECT_EQ(run("--quiet --out /dev/null --stats /dev/null").exit_code, 0);  // a device stores nothing
}

TEST_F(CliOutputs, ColumnsOfStatsAreThoseOfThePage) {
  std::istringstream page(read_file(PLVO_OUTPUTS_PAGE));
  std::string columns;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("## ", 0) == 0) inside = line == "## Columns of stats.csv";
    if (!inside || line.rfind("| `", 0) != 0) continue;
    columns += (columns.empty() ? "" : ",") + line.substr(3, line.find('`', 3) - 3);
  }
  const std::string written = run("--quiet --stats -").out;
  EXPECT_EQ(written.substr(0, written.find('\n')), columns);
}

TEST_F(CliOutputs, StandardOutputCarriesOneOutput) {
  ASSERT_EQ(run("--quiet --out " + path("t.txt")).exit_code, 0);
  const std::string expected = read_file(folder_ / "t.txt");
  for (const char* name : {"-", "/dev/stdout", "/dev/fd/1"}) {
    const CommandResult r = run(std::string("--out ") + name);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.out, expected) << name;
    EXPECT_NE(r.err.find("resident memory"), std::string::npos) << "the summary: " << r.err;
  }
  EXPECT_EQ(lines(run("--quiet --stats -").out), 1 + kShortFrames);
  EXPECT_EQ(nlohmann::json::parse(run("--json -").out)["frames"], kShortFrames);
  EXPECT_EQ(run("--quiet --report -").out.rfind("<!", 0), 0u);
  // Appending to an existing file must not truncate it.
  write_file(folder_ / "log", "before\n");
  EXPECT_EQ(
      run_command("sh -c '" + kPlvo + " run " + path("sequence") + " --quiet --out - >>" + path("log") + "'")
          .exit_code,
      0);
  EXPECT_EQ(read_file(folder_ / "log"), "before\n" + expected);
}

TEST_F(CliOutputs, FilesStateTheirReferenceFrames) {
  const auto header = [this](const char* name) {
    const std::string text = read_file(folder_ / name);
    return text.substr(0, text.find('\n'));
  };
  ASSERT_EQ(
      run("--quiet --out " + path("t") + " --covariance " + path("c") + " --motions " + path("m")).exit_code,
      0);
  const std::string poses =
      "; frame_id: world_optical, child_frame_id: camera_optical (x right, y down, z forward; the world is "
      "the "
      "first frame's camera)";
  EXPECT_EQ(header("t"), "# timestamp tx ty tz qx qy qz qw" + poses);
  EXPECT_TRUE(header("c").ends_with("axes of the world" + poses)) << header("c");
  EXPECT_TRUE(
      header("m").ends_with("; frame_id: camera_optical, child_frame_id: camera_optical at the "
                            "reference_timestamp (x right, y down, z forward)"))
      << header("m");
  // Readers treat this line as a comment.
  const CommandResult read_back =
      plvo("eval --gt " + path("sequence/groundtruth.txt") + " --est " + path("t") + " --est-covariance " +
           path("c") + " --est-motions " + path("m") + " --json -");
  ASSERT_EQ(read_back.exit_code, 0) << read_back.err;
  EXPECT_TRUE(nlohmann::json::parse(read_back.out).contains("nees_motion"));
}

// Checks TUM's format as documented by its benchmark and evo: comments begin with '#'; every other row has
// eight numbers separated by one space, with the seconds first; the quaternion has w last and unit norm.
// plvo's own reader must read the same rows.
TEST_F(CliOutputs, TrajectoriesFollowTumsFormatExactly) {
  for (const char* base : {"", " --base-camera 0.2 0 0.5 -0.5 0.5 -0.5 0.5"}) {
    ASSERT_EQ(run("--quiet --out " + path("t") + base).exit_code, 0);
    const std::string text = read_file(folder_ / "t");
    ASSERT_EQ(text.back(), '\n');
    Trajectory read;
    ASSERT_TRUE(read_trajectory({path("t"), TrajectoryFormat::kTum, {}}, read).ok());
    std::size_t rows = 0;
    std::istringstream lines(text);
    double last_stamp = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.front() == '#') continue;
      ASSERT_EQ(line.find_first_not_of("0123456789.- "), std::string::npos) << "plain decimals: " << line;
      ASSERT_EQ(std::count(line.begin(), line.end(), ' '), 7) << line;
      std::istringstream words(line);
      const std::vector<double> numbers{std::istream_iterator<double>(words), {}};
      ASSERT_EQ(numbers.size(), 8U) << line;
      ASSERT_GT(numbers[0], last_stamp);
      last_stamp = numbers[0];
      const Eigen::Map<const Eigen::Vector4d> xyzw(numbers.data() + 4);
      ASSERT_NEAR(xyzw.norm(), 1, 1e-8) << line;
      ASSERT_LT(rows, read.poses.size());
      const Se3& T = read.poses[rows].T_world_camera;
      EXPECT_LT((T.t - Vector3(numbers[1], numbers[2], numbers[3])).norm(), 1e-12);
      const Quaternion q = to_quaternion(T.R);
      EXPECT_LT((Eigen::Vector4d(q.x, q.y, q.z, q.w) - (xyzw[3] < 0 ? -1 : 1) * xyzw).norm(), 1e-8);
      ++rows;
    }
    EXPECT_EQ(rows, std::size_t{kShortFrames});
    EXPECT_EQ(read.poses.size(), rows);
  }
}

// The poses of the base are those of the camera, transformed by the mounting of the camera, and so are their
// covariances: a motion's error in units of its covariance does not change.
TEST_F(CliOutputs, WritesPosesOfTheBaseWhenItsCameraIsGiven) {
  const std::string place = "0.2 -0.1 0.5 -0.54 0.46 -0.5 0.497";
  const Se3 T_base_camera{to_rotation({-0.54, 0.46, -0.5, 0.497}), Vector3(0.2, -0.1, 0.5)};
  const auto files = [this](const std::string& name) {
    return "--quiet --out " + path(name + ".t") + " --covariance " + path(name + ".c") + " --motions " +
           path(name + ".m");
  };
  ASSERT_EQ(run(files("camera")).exit_code, 0);
  const CommandResult r = run(files("base") + " --base-camera " + place);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.err, "");
  EXPECT_NE(read_file(folder_ / "base.t").find("frame_id: odom, child_frame_id: base_link (x forward"),
            std::string::npos);

  const auto moved = [&](const std::string& from, const std::string& to, const Se3& behind) {
    Trajectory trajectory;
    ASSERT_TRUE(read_trajectory({folder_ / from, TrajectoryFormat::kTum, {}}, trajectory).ok());
    std::string text;
    for (const StampedPose& pose : trajectory.poses)
      text += trajectory_line(pose.stamp_ns, T_base_camera * pose.T_world_camera * behind) + '\n';
    write_file(folder_ / to, text);
  };
  moved("camera.t", "moved.t", T_base_camera.inverse());
  moved("sequence/groundtruth.txt", "truth.t", T_base_camera.inverse());
  const auto eval = [&](const std::string& truth, const std::string& name) {
    const CommandResult e =
        plvo("eval --gt " + path(truth) + " --est " + path(name + ".t") + " --est-covariance " +
             path(name + ".c") + " --est-motions " + path(name + ".m") + " --json -");
    EXPECT_EQ(e.exit_code, 0) << e.err;
    return nlohmann::json::parse(e.out);
  };
  EXPECT_LT(eval("moved.t", "base")["ate_m"]["max"], 5e-9) << "but for the decimals of the files";
  const auto of_base = eval("truth.t", "base");
  const auto of_camera = eval("sequence/groundtruth.txt", "camera");
  for (const char* nees : {"nees_motion", "nees_pose"}) {
    const double expected = of_camera[nees]["mean"];
    EXPECT_GT(expected, 0.1);
    EXPECT_NEAR(of_base[nees]["mean"].get<double>(), expected, 1e-3 * expected) << nees;
  }
  EXPECT_NE(read_file(folder_ / "base.c"), read_file(folder_ / "camera.c"));
  EXPECT_EQ(
      nlohmann::json::parse(run("--quiet --json - --out /dev/null --base-camera " + place).out)["evaluation"],
      nlohmann::json::parse(run("--quiet --json -").out)["evaluation"])
      << "the summary stays the camera's";
}

// The simulator's z axis points up. The levelled world must agree with the truth about this direction, up to
// the two degrees due to an accelerometer bias of 0.25 m/s².
TEST_F(CliOutputs, AccelerometerLevelsTheWorld) {
  const auto read = [&](const std::string& file) {
    Trajectory trajectory;
    EXPECT_TRUE(read_trajectory({path(file), TrajectoryFormat::kTum, {}}, trajectory).ok());
    EXPECT_EQ(trajectory.poses.size(), std::size_t{kShortFrames});
    return trajectory.poses;
  };
  ASSERT_EQ(run("--quiet --imu --level --out " + path("t")).exit_code, 0);
  EXPECT_NE(read_file(folder_ / "t").find("turned level: gravity along y"), std::string::npos);
  const auto truth = read("sequence/groundtruth.txt"), level = read("t");
  const Vector3 up(0, 0, 1);
  for (std::size_t i = 0; i < kShortFrames; ++i) {
    const Vector3 down = level[i].T_world_camera.R * truth[i].T_world_camera.R.transpose() * -up;
    EXPECT_LT((down - Vector3(0, 1, 0)).norm(), 0.1) << down.transpose();
  }
  // The camera is mounted at an angle of 20°; the base is level nevertheless.
  const std::string mounted = " --base-camera 0.2 0 0.5 -0.576 0.576 -0.41 0.41";
  ASSERT_EQ(run("--quiet --imu --level --out " + path("b") + mounted).exit_code, 0);
  EXPECT_NE(read_file(folder_ / "b").find("turned level: gravity along -z"), std::string::npos);
  const Se3 T_base_camera{to_rotation({-0.576, 0.576, -0.41, 0.41}), Vector3(0.2, 0, 0.5)};
  const auto base = read("b");
  EXPECT_LT(base[0].T_world_camera.t.norm(), 1e-8);
  for (std::size_t i = 0; i < kShortFrames; ++i) {
    const Matrix3 R_odom_truth =
        base[i].T_world_camera.R * T_base_camera.R * truth[i].T_world_camera.R.transpose();
    EXPECT_LT((R_odom_truth * up - up).norm(), 0.1) << i;
    EXPECT_LT(((base[i].T_world_camera.t - base[0].T_world_camera.t).norm()), 0.2);
  }
  expect_refused(run("--level --out " + path("t")), "--level: is by the accelerometer of --imu");
  fs::remove(folder_ / "sequence/accelerometer.txt");
  const CommandResult none = run("--imu --level --out " + path("t"));
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.err.find("without an accelerometer nothing says where down is"), std::string::npos)
      << none.err;
}

// Keeps every second pixel of the depth images, like a sensor with a smaller depth camera in the same place.
TEST_F(CliOutputs, RegistersDepthOfAnotherSizeWhenItsCameraIsGiven) {
  ASSERT_EQ(run("--quiet --out " + path("whole")).exit_code, 0);
  ImageDecoder decoder;
  std::vector<std::uint16_t> whole(160 * 120), half(80 * 60);
  for (const auto& entry : fs::directory_iterator(folder_ / "sequence/depth")) {
    ASSERT_TRUE(decoder.decode_depth(entry.path(), 160, 120, whole).ok());
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = whole[2 * (i / 80) * 160 + 2 * (i % 80)];
    ASSERT_TRUE(write_png(entry.path(), DepthView{half.data(), 80, 60, 80, 0.0002}).ok());
  }
  const CommandResult refused = run("--quiet");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("colour is 160x120 but depth is 80x60; export colour at the size of depth"),
            std::string::npos)
      << refused.err;
  const std::string colour = read_file(folder_ / "sequence/calibration.txt");
  for (const char* said :
       {"width 160\nheight 120\n", "depth_fx 65.625\ndepth_fy 65.625\ndepth_cx 39.75\ndepth_cy 29.75\n"}) {
    write_file(folder_ / "sequence/calibration.txt", colour + "\n" + said);
    const CommandResult r = run("--quiet --out " + path("half"));
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const CommandResult e = plvo("eval --gt " + path("whole") + " --est " + path("half") + " --json -");
    ASSERT_EQ(e.exit_code, 0) << e.err;
    const auto json = nlohmann::json::parse(e.out);
    EXPECT_EQ(json["poses"], kShortFrames);
    EXPECT_LT(json["ate_m"]["max"], 0.003) << said;
  }
}

TEST_F(CliOutputs, WarnsOfAMissingRotationToOpticalAxes) {
  const CommandResult r = run("--quiet --out " + path("t") + " --base-camera 0.2 0 0.5 0 0 0 1");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.err.find("this camera looks up"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("-0.5 0.5 -0.5 0.5"), std::string::npos) << r.err;
}

TEST_F(CliOutputs, FailedWriteToStandardOutputIsAnError) {
  const std::string truth = path("sequence/groundtruth.txt");
  for (const std::string& words :
       {"run " + path("sequence"), "run " + path("sequence") + " --quiet --out -",
        "run " + path("sequence") + " --quiet --json -", "eval --gt " + truth + " --est " + truth,
        "eval --json - --gt " + truth + " --est " + truth,
        "simulate --scene bare --size 96x64 --frames 1 --out " + path("one"), std::string("--help"),
        std::string("run --help"), std::string("--version")}) {
    for (const char* where : {">/dev/full", ">&-"}) {
      fs::remove_all(folder_ / "one");
      const CommandResult r = run_command("sh -c '" + kPlvo + ' ' + words + ' ' + where + "'");
      EXPECT_EQ(r.exit_code, 1) << words << where << r.err;
      EXPECT_NE(r.err.find("standard output"), std::string::npos) << words << where << r.err;
    }
  }
}

TEST_F(CliOutputs, ClosedStandardOutputDoesNotEndUpInAFile) {
  ASSERT_EQ(run("--quiet --out " + path("t.txt")).exit_code, 0);
  EXPECT_EQ(
      run_command("sh -c '" + kPlvo + " run " + path("sequence") + " --out " + path("u.txt") + " >&- 2>&-'")
          .exit_code,
      1);
  EXPECT_EQ(read_file(folder_ / "u.txt"), read_file(folder_ / "t.txt"));
}

TEST_F(CliOutputs, UnwritableOutputsAreFoundBeforeTheFirstFrame) {
  write_file(folder_ / "plain", "");
  for (const char* option : {"--report ", "--json "}) {
    const CommandResult r = run("--overlay " + path("frames") + " " + option + path("plain") + "/x");
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_NE(r.err.find("choose a path that can be written"), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(folder_ / "frames/000000.png")) << "no frame was tracked before";
  }
  EXPECT_EQ(plvo("simulate --scene bare --size 96x64 --out " + path("plain/x")).exit_code, 1);
  // A successful check leaves no file behind and keeps an old report.
  write_file(folder_ / "old.html", "old");
  EXPECT_EQ(
      run("--report " + path("old.html") + " --json " + path("new.json") + " --out " + path("plain") + "/x")
          .exit_code,
      1);
  EXPECT_EQ(read_file(folder_ / "old.html"), "old");
  EXPECT_FALSE(fs::exists(folder_ / "new.json"));
}

TEST_F(CliOutputs, ASequenceThatCannotBeTrackedIsRefusedBeforeTheFirstFrame) {
  write_file(folder_ / "sequence/calibration.txt", "131 131 79.5 59.5 0.001\n");
  CommandResult r = run("--out " + path("t.txt"));
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("depth"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder_ / "t.txt"));
}

TEST_F(CliOutputs, AssumptionsAreReportedAtTheStart) {
  write_file(folder_ / "sequence/calibration.txt", "131 131 79.5 59.5 5000\n");
  CommandResult r = run("--quiet");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("a global shutter is assumed"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("--readout 0.0261"), std::string::npos) << r.err;
  EXPECT_EQ(run("--quiet --readout 0").err, "");
  r = run("--quiet --fx 131 --fy 131 --cx 79.5 --cy 59.5");
  EXPECT_NE(r.err.find("5000 units per metre are assumed"), std::string::npos) << r.err;
  EXPECT_EQ(run("--quiet --fx 131 --fy 131 --cx 79.5 --cy 59.5 --readout 0 --depth-scale 5000").err, "");
  // Without a calibration, a recording's name in TUM's scheme determines the camera; a similar name is a
  // hint.
  fs::remove(folder_ / "sequence/calibration.txt");
  fs::rename(folder_ / "sequence", folder_ / "fr1_sequence");
  r = plvo("run " + path("fr1_sequence") + " --quiet");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("as its name may say: --camera-model tum-fr1"), std::string::npos) << r.err;
  fs::rename(folder_ / "fr1_sequence", folder_ / "rgbd_dataset_freiburg1_sequence");
  r = plvo("run " + path("rgbd_dataset_freiburg1_sequence") + " --quiet");
  EXPECT_NE(r.err.find("640x480"), std::string::npos) << "the guess does not fit these images: " << r.err;
}

TEST_F(CliOutputs, SequenceOfOneFrameIsNoFailure) {
  const CommandResult r = plvo("run --camera sim --scene bare --size 160x120 --frames 1");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.out.find("started                1"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("tracked                0"), std::string::npos) << r.out;
  EXPECT_EQ(r.err, "");
}

TEST_F(CliOutputs, LossesAreCountedByKind) {
  const std::vector<std::uint16_t> none(160 * 120, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "sequence/depth"))
    ASSERT_TRUE(write_png(entry.path(), DepthView{none.data(), 160, 120, 160, 0.0002}).ok());
  const CommandResult r = run("--json " + path("j"));
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_NE(r.out.find("  4 times"), std::string::npos) << r.out;
  const auto json = nlohmann::json::parse(read_file(folder_ / "j"));
  EXPECT_EQ(json["lost_reasons"], (nlohmann::json{{"too_few_features", 4}})) << json;
}

// Each fault is a message on standard error and a warning in the summary.
TEST_F(CliOutputs, FaultsOfTheDataAreReportedOnce) {
  const auto said = [&](const std::string& options, const std::string& words) {
    SCOPED_TRACE(words);
    const CommandResult r = run("--quiet --json " + path("j") + ' ' + options);
    EXPECT_NE(r.err.find("plvo: warning: "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find(words), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find(words), r.err.rfind(words)) << r.err;
    const auto warnings = nlohmann::json::parse(read_file(folder_ / "j"))["warnings"];
    const auto has_words = [&words](const nlohmann::json& text) {
      return text.get<std::string>().find(words) != std::string::npos;
    };
    EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(), has_words), 1) << warnings;
  };
  EXPECT_EQ(run("--quiet --json " + path("j")).err, "");
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "j"))["warnings"], nlohmann::json::array());
  said("--cx 0 --cy 0", "a coordinate of 0 was probably never filled in");
  said("--cx 59.5 --cy 79.5", "cx and cy look exchanged");
  said("--fx 131 --fy 90", "pixels are nearly always square");
  said("--depth-scale 1000", "times the true ones");
  said("--depth-scale 40000", "no depth lies beyond");
  // The ground truth has another clock or belongs to another recording.
  const std::string truth = read_file(folder_ / "sequence/groundtruth.txt");
  write_file(folder_ / "sequence/groundtruth.txt", "9000 0 0 0 0 0 0 1\n9001 0 0 0 0 0 0 1\n");
  said("", "no comparison: only 0 of ");
  said("", "one recording, one clock?");
  write_file(folder_ / "sequence/groundtruth.txt", truth);
  const std::vector<std::uint16_t> none(160 * 120, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "sequence/depth"))
    ASSERT_TRUE(write_png(entry.path(), DepthView{none.data(), 160, 120, 160, 0.0002}).ok());
  said("", "the depth images are empty");
}

TEST_F(CliOutputs, KittiRowsWithoutStampsMustMatchInNumber) {
  std::string truth, estimate, times, fewer_times;
  for (int i = 0; i < 20; ++i) {
    const std::string row = "1 0 0 " + std::to_string(0.1 * i * i) + " 0 1 0 0 0 0 1 0\n";
    const std::string time = std::to_string(0.1 * i) + '\n';
    truth += row;
    times += time;
    if (i == 3) continue;  // a lost frame
    estimate += row;
    fewer_times += time;
  }
  write_file(folder_ / "truth", truth);
  write_file(folder_ / "estimate", estimate);
  write_file(folder_ / "times", times);
  write_file(folder_ / "fewer", fewer_times);
  const std::string eval = kPlvo + " eval --gt " + path("truth") + " --est " + path("estimate");
  const CommandResult refused = run_command(eval);
  EXPECT_EQ(refused.exit_code, 1) << refused.out;
  EXPECT_NE(refused.err.find("the truth has 20 rows and the estimate 19"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--kitti-times TRUTH ESTIMATE"), std::string::npos) << refused.err;
  const CommandResult timed =
      run_command(eval + " --json - --kitti-times " + path("times") + ' ' + path("fewer"));
  ASSERT_EQ(timed.exit_code, 0) << timed.err;
  EXPECT_LT(nlohmann::json::parse(timed.out)["ate_m"]["max"].get<double>(), 1e-6);
  EXPECT_EQ(plvo("eval --gt " + path("truth") + " --est " + path("truth")).exit_code, 0);
  // One file with row numbers and one with stamps.
  write_file(folder_ / "stamped", "50 0 0 0 0 0 0 1\n51 0 0 0 0 0 0 1\n");
  const CommandResult mixed = plvo("eval --gt " + path("truth") + " --est " + path("stamped"));
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_NE(mixed.err.find("the truth has no stamps"), std::string::npos) << mixed.err;
}

TEST_F(CliOutputs, KittiTimesMustMatchTheirRows) {
  std::string rows, times;
  for (int i = 0; i < 10; ++i) {
    rows += "1 0 0 " + std::to_string(0.1 * i) + " 0 1 0 0 0 0 1 0\n";
    times += std::to_string(0.1 * i) + '\n';
  }
  write_file(folder_ / "kitti", rows);
  write_file(folder_ / "times", times);
  write_file(folder_ / "more", times + "1.0\n");
  const std::string kitti =
      kPlvo + " eval --gt " + path("kitti") + " --est " + path("kitti") + " --kitti-times ";
  EXPECT_EQ(run_command(kitti + path("times")).exit_code, 0);
  const CommandResult more = run_command(kitti + path("more"));
  EXPECT_EQ(more.exit_code, 1);
  EXPECT_NE(more.err.find("11 stamps"), std::string::npos) << more.err;
  const std::string truth = path("sequence/groundtruth.txt");
  const CommandResult tum =
      plvo("eval --gt " + truth + " --est " + truth + " --kitti-times " + path("times"));
  EXPECT_EQ(tum.exit_code, 2);
  EXPECT_NE(tum.err.find("--kitti-times is for KITTI's rows"), std::string::npos) << tum.err;
}

}  // namespace
}  // namespace plvo
