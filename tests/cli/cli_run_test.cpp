// SPDX-License-Identifier: Apache-2.0
// Tests `plvo run` and `plvo simulate` through the command line: a complete run, and every bad input with one
// line that says what to do. Unwritable folders are not made by permissions: the tests may run as root.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo_command.hpp"
#include "simulated_sequence.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::kPlvo;
using test::read_file;
using test::run_command;
using test::TemporaryFolder;
using test::write_file;

constexpr int kFrames = 6;

std::ptrdiff_t lines_of(const fs::path& file) {
  const std::string text = read_file(file);
  return std::count(text.begin(), text.end(), '\n');
}

bool contains(const std::string& text, std::string_view words) {
  return text.find(words) != std::string::npos;
}

// A sequence of a simulated room, rendered once; each test works on its own copy.
const fs::path& master_sequence() { return test::simulated_sequence<kFrames>(); }

class CliRun : public test::PlvoCommand {
 protected:
  CliRun() : sequence_(folder_ / "sequence") {
    fs::copy(master_sequence(), sequence_, fs::copy_options::recursive);
  }

  CommandResult run(const std::string& more) const { return plvo("run " + sequence_.string() + ' ' + more); }
  // Returns the file in the k-th line of a list.
  fs::path image(const char* kind, int k) const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(sequence_ / kind)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files.at(static_cast<std::size_t>(k));
  }
  void expect_refused(const CommandResult& result, std::string_view words) const {
    PlvoCommand::expect_refused(result, 1, words);
    EXPECT_EQ(result.err.rfind("plvo: error: ", 0), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  fs::path sequence_;
};

TEST_F(CliRun, WritesAllOutputsOfATrackedSequence) {
  const CommandResult r = run("--out " + path("t.txt") + " --covariance " + path("c.txt") + " --motions " +
                              path("m.txt") + " --stats " + path("s.csv") + " --json " + path("j.json"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.err, "plvo: wrote " + path("t.txt") + ", " + path("c.txt") + ", " + path("m.txt") + ", " +
                       path("s.csv") + ", " + path("j.json") + '\n');
  for (const char* words :
       {"tracked", "CPU per frame", "matching", "arena", "resident memory", "against the ground truth"})
    EXPECT_TRUE(contains(r.out, words)) << words << '\n' << r.out;
  EXPECT_EQ(lines_of(path("t.txt")), 1 + kFrames);
  EXPECT_EQ(lines_of(path("c.txt")), 1 + kFrames);
  EXPECT_EQ(lines_of(path("m.txt")), kFrames);
  EXPECT_EQ(lines_of(path("s.csv")), 1 + kFrames);
  const auto json = nlohmann::json::parse(read_file(path("j.json")));
  EXPECT_EQ(json["frames"], kFrames);
  EXPECT_EQ(json["lost"], 0);
  EXPECT_GT(json["memory_bytes"]["arena"], 0);
  EXPECT_LT(json["evaluation"]["ate_m"]["rmse"], 0.05);

  const CommandResult evaluated =
      plvo("eval --gt " + (sequence_ / "groundtruth.txt").string() + " --est " + path("t.txt") +
           " --est-covariance " + path("c.txt") + " --est-motions " + path("m.txt"));
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_TRUE(contains(evaluated.out, "of the motions     all, 6")) << evaluated.out;
}

TEST_F(CliRun, SameInputSameBytes) {
  ASSERT_EQ(run("--quiet --out " + path("a.txt") + " --covariance " + path("ca.txt")).exit_code, 0);
  ASSERT_EQ(run("--quiet --out " + path("b.txt") + " --covariance " + path("cb.txt")).exit_code, 0);
  EXPECT_EQ(read_file(path("a.txt")), read_file(path("b.txt")));
  EXPECT_EQ(read_file(path("ca.txt")), read_file(path("cb.txt")));
}

TEST_F(CliRun, TwoCoresGiveTheSameBytes) {
  ASSERT_EQ(run("--quiet --out " + path("1.txt") + " --covariance " + path("c1.txt")).exit_code, 0);
  const CommandResult two = run("--cores 2 --out " + path("2.txt") + " --covariance " + path("c2.txt") +
                                " --json " + path("j.json"));
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_TRUE(contains(two.out, "elapsed per frame")) << two.out;
  EXPECT_EQ(read_file(path("1.txt")), read_file(path("2.txt")));
  EXPECT_EQ(read_file(path("c1.txt")), read_file(path("c2.txt")));
  // The time of the second thread is included.
  const auto json = nlohmann::json::parse(read_file(path("j.json")));
  double stages = 0;
  for (const char* stage : {"image", "points", "lines", "matching", "motion"})
    stages += json["cpu_ms"][stage]["mean"].get<double>();
  EXPECT_GT(json["cpu_ms"]["total"]["mean"].get<double>(), 1.1 * stages);
  EXPECT_EQ(run("--cores 3").exit_code, 2);
}

TEST_F(CliRun, SurfacesAreUsedUnlessDisabled) {
  const auto trajectory = [&](const std::string& options) {
    EXPECT_EQ(run("--quiet --out " + path("t.txt") + ' ' + options).exit_code, 0);
    return read_file(path("t.txt"));
  };
  EXPECT_EQ(trajectory(""), trajectory("--surfaces 200"));
  EXPECT_NE(trajectory(""), trajectory("--surfaces 0"));
  EXPECT_EQ(trajectory("--preset paper"), trajectory("--preset paper --surfaces 0"));
  EXPECT_EQ(run("--preset paper --surfaces 200").exit_code, 2);
  EXPECT_EQ(trajectory("--preset tiny"), trajectory("--preset tiny --surfaces 0"));
  EXPECT_EQ(run("--surfaces 1001").exit_code, 2);
}

TEST_F(CliRun, AMaskHidesWhatTravelsWithTheCamera) {
  constexpr int kWidth = 160, kHeight = 120;  // of the sequence
  const auto write_mask = [&](int height, std::uint8_t lowest_rows) {
    std::vector<std::uint8_t> levels(static_cast<std::size_t>(kWidth * height), 255);
    std::fill(levels.end() - kWidth * 18, levels.end(), lowest_rows);
    EXPECT_TRUE(
        write_png(path("mask.png"), {levels.data(), kWidth, height, kWidth, PixelFormat::kGray8}).ok());
  };
  const auto trajectory = [&](const std::string& options) {
    const CommandResult r = run("--quiet --out " + path("t.txt") + ' ' + options);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return read_file(path("t.txt"));
  };
  const std::string mask = " --mask " + path("mask.png");
  write_mask(kHeight, 255);
  EXPECT_EQ(trajectory(mask), trajectory("")) << "a white mask hides nothing";
  write_mask(kHeight, 0);
  const std::string masked = trajectory(mask);
  EXPECT_NE(masked, trajectory(""));
  // What lies there has no influence.
  for (int k = 0; k < kFrames; ++k) {
    ImageDecoder decoder;
    std::vector<std::uint8_t> rgb(static_cast<std::size_t>(3 * kWidth * kHeight));
    ASSERT_TRUE(decoder.decode_rgb(image("rgb", k), kWidth, kHeight, rgb).ok());
    for (std::size_t i = rgb.size() - 3 * kWidth * 18; i < rgb.size(); ++i)
      rgb[i] = static_cast<std::uint8_t>(i * i % 251);
    ASSERT_TRUE(write_png(image("rgb", k),
                          {rgb.data(), kWidth, kHeight, 3 * std::ptrdiff_t{kWidth}, PixelFormat::kRgb8})
                    .ok());
  }
  EXPECT_EQ(trajectory(mask), masked);

  write_mask(kHeight - 1, 0);
  expect_refused(
      run(mask),
      "the mask has 160x119 pixels, the camera's images have 160x120; draw it over one of the colour");
  expect_refused(run("--mask " + path("none.png")), "none.png");
  EXPECT_EQ(run(mask + " --report " + path("mask.png")).exit_code, 2) << "the mask would be overwritten";
}

TEST_F(CliRun, SimulatedCameraEqualsItsRecording) {
  ASSERT_EQ(run("--quiet --out " + path("recorded.txt")).exit_code, 0);
  ASSERT_EQ(plvo("run --camera sim --scene bare --size 160x120 --seed 3 --quiet --frames :" +
                 std::to_string(kFrames) + " --out " + path("live.txt"))
                .exit_code,
            0);
  EXPECT_EQ(read_file(path("recorded.txt")), read_file(path("live.txt")));
}

TEST_F(CliRun, GyroAndAccelerometerBridgeACoveredLens) {
  const std::string simulated = " --scene desk --size 160x120 --seed 3 --covered 6:9 --quiet";
  const CommandResult made = plvo("simulate --frames 12 --out " + path("covered") + simulated);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string command = kPlvo + " run " + path("covered");
  const CommandResult lost = run_command(command + " --json " + path("lost.json"));
  ASSERT_EQ(lost.exit_code, 0) << lost.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(path("lost.json")))["lost"], 3);
  const CommandResult helped = run_command(command + " --imu --json " + path("helped.json") + " --stats " +
                                           path("s.csv") + " --out " + path("t.txt"));
  ASSERT_EQ(helped.exit_code, 0) << helped.err;
  const auto json = nlohmann::json::parse(read_file(path("helped.json")));
  EXPECT_EQ(json["lost"], 0);
  EXPECT_EQ(json["predicted"], 3);
  EXPECT_TRUE(contains(helped.out, "predicted")) << helped.out;
  EXPECT_TRUE(contains(read_file(path("s.csv")), "predicted,\"predicted: hardly anything")) << helped.out;
  EXPECT_EQ(lines_of(path("t.txt")), 1 + 12);
  // The simulator's readings equal those of its files up to the last digit.
  ASSERT_EQ(plvo("run --camera sim --frames 12 --imu --out " + path("live.txt") + simulated).exit_code, 0);
  EXPECT_EQ(lines_of(path("live.txt")), 1 + 12);
  // One of the two files is enough; at least one is required.
  fs::remove(path("covered") + "/gyroscope.txt");
  const CommandResult level = run_command(command + " --imu");
  EXPECT_EQ(level.exit_code, 0) << level.err;
  EXPECT_TRUE(contains(level.err, "no gyro")) << level.err;
  fs::remove(path("covered") + "/accelerometer.txt");
  expect_refused(run_command(command + " --imu"), "gyroscope.txt");
}

TEST_F(CliRun, ImuAxesAreThreeDifferentOnes) {
  EXPECT_EQ(run("--imu --imu-axes x,-y,z --quiet").exit_code, 0);
  for (const char* wrong : {"x,y", "x,x,z", "x,y,z,x", "a,b,c", "x,y,-"}) {
    const CommandResult r = run(std::string("--imu --imu-axes ") + wrong);
    EXPECT_EQ(r.exit_code, 2) << wrong;
    EXPECT_TRUE(contains(r.err, "x,-y,z")) << r.err;
  }
  EXPECT_EQ(run("--imu-axes x,y,z").exit_code, 2) << "without --imu";
  EXPECT_EQ(plvo("run --camera sim --frames 2 --imu --imu-axes x,y,z").exit_code, 2);
  EXPECT_EQ(plvo("run --camera sim --frames 2 --covered 3:2").exit_code, 2);
}

TEST_F(CliRun, UnreachableBudgetReducesFeatures) {
  const CommandResult free = run("--json " + path("free.json"));
  EXPECT_FALSE(contains(free.out, "frame budget"));
  EXPECT_EQ(nlohmann::json::parse(read_file(path("free.json")))["fewer_features"]["frames"], 0);
  const CommandResult tight = run("--frame-budget 0.001 --json " + path("tight.json"));
  EXPECT_EQ(tight.exit_code, 0) << tight.err;
  EXPECT_TRUE(contains(tight.out, "frame budget")) << tight.out;
  const auto fewer = nlohmann::json::parse(read_file(path("tight.json")))["fewer_features"];
  EXPECT_EQ(fewer["frames"], kFrames - 1) << "the first came before anything was known";
  EXPECT_GE(fewer["lowest_step"], 1);
  EXPECT_EQ(run("--frame-budget 0").exit_code, 2);
}

TEST_F(CliRun, TheTinyPresetTakesLessMemory) {
  const CommandResult tiny = run("--preset tiny --json " + path("tiny.json"));
  EXPECT_EQ(tiny.exit_code, 0) << tiny.err;
  (void)run("--json " + path("all.json"));
  const auto bytes = [this](const char* name) {
    return nlohmann::json::parse(read_file(path(name)))["memory_bytes"]["arena_peak"].get<long>();
  };
  EXPECT_LT(bytes("tiny.json"), bytes("all.json") / 2);
  for (const char* one : {"keyframe", "previous"})
    EXPECT_EQ(run(std::string("--preset tiny --reference ") + one).exit_code, 0) << one;
}

TEST_F(CliRun, QuietWritesNothing) {
  const CommandResult r = run("--quiet");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_TRUE(r.out.empty() && r.err.empty()) << r.out << r.err;
}

TEST_F(CliRun, TracksOnlyTheFramesOfARange) {
  ASSERT_EQ(run("--quiet --frames 1:4 --out " + path("t.txt")).exit_code, 0);
  EXPECT_EQ(lines_of(path("t.txt")), 1 + 3);
  expect_refused(run("--frames 50:60"), "the frame range is empty");
}

TEST_F(CliRun, StepEndsWithItsInput) {
  const CommandResult r =
      run("--pace step --out " + path("t.txt"));  // standard input is empty: no frame is released
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_TRUE(contains(r.err, "no frame could be tracked")) << r.err;
}

TEST_F(CliRun, StepSaysWhatItWaitsForAndShowsTheFrames) {
  const CommandResult r = test::run_command("sh -c 'printf \"\\n\\n\" | " + test::kPlvo + " run " +
                                            sequence_.string() + " --pace step'");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_TRUE(contains(r.err, "plvo: --pace step: Enter tracks the next frame, Ctrl-D ends the run\n"))
      << r.err;
  EXPECT_TRUE(contains(r.err, "plvo: frame 1/6 initialising")) << r.err;
  EXPECT_TRUE(contains(r.err, "plvo: frame 2/6 tracking")) << r.err;
  EXPECT_FALSE(contains(r.err, "frame 3/6")) << r.err;
}

TEST_F(CliRun, OverlayAndReportAreWritten) {
  const CommandResult r = run("--quiet --overlay " + path("overlay") + " --report " + path("r.html"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_TRUE(fs::exists(folder_ / "overlay/000000.png"));
  EXPECT_TRUE(fs::exists(folder_ / "overlay/000005.png"));
  const std::string page = read_file(path("r.html"));
  EXPECT_TRUE(contains(page, "data:image/jpeg;base64,"));
  EXPECT_FALSE(contains(page, "http:") || contains(page, "https:"));  // the page loads nothing
  EXPECT_FALSE(contains(page, "@DATA@") || contains(page, "@SCRIPT@") || contains(page, "@STYLE@"));
}

TEST_F(CliRun, RefusesAFolderWithoutLists) {
  fs::create_directory(folder_ / "empty");
  expect_refused(plvo("run " + path("empty")), "a sequence needs rgb.txt and depth.txt");
  expect_refused(plvo("run " + path("none")), "is not a folder");
}

TEST_F(CliRun, NamesTheDepthListWhenItIsMissing) {
  fs::remove(sequence_ / "depth.txt");
  expect_refused(run(""), "depth.txt; a sequence needs rgb.txt and depth.txt");
}

TEST_F(CliRun, TruncatedImageInTheMiddleIsSkipped) {
  const fs::path victim = image("rgb", 2);
  fs::resize_file(victim, fs::file_size(victim) / 2);
  const CommandResult r =
      run("--out " + path("t.txt") + " --stats " + path("s.csv") + " --json " + path("j.json"));
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_TRUE(contains(r.err, "plvo: warning: frame 2 skipped: rgb/")) << r.err;
  EXPECT_EQ(lines_of(path("t.txt")), 1 + kFrames - 1);
  EXPECT_TRUE(contains(read_file(path("s.csv")), ",damaged,\"rgb/")) << read_file(path("s.csv"));
  EXPECT_EQ(nlohmann::json::parse(read_file(path("j.json")))["damaged"], 1);
}

TEST_F(CliRun, RefusesDepthOfEightBits) {
  const std::vector<std::uint8_t> grey(160 * 120, 80);
  ASSERT_TRUE(write_png(image("depth", 0), ColourView{grey.data(), 160, 120, 160, PixelFormat::kGray8}).ok());
  expect_refused(run("--out " + path("t.txt")), "has 8 bits per channel; depth must be a 16-bit grey PNG");
  EXPECT_FALSE(fs::exists(path("t.txt")));  // refused before any output is written
}

TEST_F(CliRun, RefusesDepthOfAnotherSizeThanColour) {
  ASSERT_TRUE(write_png(image("depth", 0), test::TinyFrame(0).frame.depth).ok());
  expect_refused(run(""), "colour is 160x120 but depth is 96x64");
}

TEST_F(CliRun, StampsBackwardsOrDoubled) {
  const std::string list = read_file(sequence_ / "rgb.txt");
  const std::string last = list.substr(list.rfind('\n', list.size() - 2) + 1);
  write_file(sequence_ / "rgb.txt", list + last);
  expect_refused(run(""), "appears twice; sort the list by stamp and keep each stamp once");
  write_file(sequence_ / "rgb.txt", last + list);
  expect_refused(run(""), "runs backwards; sort the list by stamp");
}

TEST_F(CliRun, ExitsWithThreeWhenAllDepthIsZero) {
  const std::vector<std::uint16_t> none(160 * 120, 0);
  for (int k = 0; k < kFrames; ++k)
    ASSERT_TRUE(write_png(image("depth", k), DepthView{none.data(), 160, 120, 160, 0.0002}).ok());
  const CommandResult r = run("--quiet --out " + path("t.txt") + " --stats " + path("s.csv"));
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_TRUE(contains(r.err, "plvo: error: no frame could be tracked: ")) << r.err;
  EXPECT_EQ(lines_of(path("s.csv")), 1 + kFrames);
  EXPECT_EQ(lines_of(path("t.txt")), 1);  // the header: no frame has a pose
}

TEST_F(CliRun, RefusesACalibrationWithANaN) {
  write_file(sequence_ / "calibration.txt", "525 nan 79.5 59.5 5000\n");
  expect_refused(run(""), "fx and fy must be numbers from 1 to 100000");
}

TEST_F(CliRun, AsksForACalibrationWhenThereIsNone) {
  fs::remove(sequence_ / "calibration.txt");
  expect_refused(run(""), "no calibration: give --calibration FILE, --camera-model NAME");
  EXPECT_EQ(run("--quiet --fx 131 --fy 131 --cx 79.5 --cy 59.5").exit_code, 0);
}

TEST_F(CliRun, RefusesAnUnknownDistortionModel) {
  write_file(
      folder_ / "info.yaml",
      "image_width: 160\nimage_height: 120\ncamera_matrix: {data: [131, 0, 79.5, 0, 131, 59.5, 0, 0, 1]}\n"
      "distortion_model: thin_prism\ndistortion_coefficients: {data: [0.1, 0, 0, 0]}\n");
  expect_refused(run("--calibration " + path("info.yaml")), "'thin_prism' is not supported, only plumb_bob");
}

TEST_F(CliRun, RefusesALensThatFoldsTheImage) {
  expect_refused(run("--distortion-equidistant -3 0 0 0"), "the equidistant distortion folds the image");
  expect_refused(run("--distortion-rational 0 0 0 0 0 0 0 -90"), "the rational distortion folds the image");
}

TEST_F(CliRun, OutputsThatCannotBeWritten) {
  write_file(folder_ / "plain_file", "");
  const std::string below_a_file = path("plain_file") + "/t.txt";
  for (const char* option : {"--out ", "--covariance ", "--motions ", "--stats ", "--json ", "--report "}) {
    expect_refused(run("--quiet " + std::string(option) + below_a_file), "choose a path that can be written");
    expect_refused(run("--quiet " + std::string(option) + "/dev/full"), "No space left on device");
  }
  expect_refused(run("--quiet --overlay " + path("plain_file") + "/frames"), "cannot make the folder");
}

TEST_F(CliRun, FullDiskKeepsWhatWasWritten) {
  // A file may grow to 400 bytes: the header and the complete lines that fit.
  const CommandResult r = run_command("bash -c 'trap \"\" XFSZ; ulimit -f 1; exec " + kPlvo + " run " +
                                      sequence_.string() + " --quiet --covariance " + path("c.txt") + "'");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_TRUE(contains(r.err, "plvo: error: cannot write")) << r.err;
  const std::string text = read_file(path("c.txt"));
  ASSERT_FALSE(text.empty());
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ(text[0], '#');
}

TEST(CliSimulate, RejectsBadInputWithAMessage) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  const CommandResult r =
      test::run_plvo("simulate --scene bare --size 96x64 --frames 1 --out " + (folder / "file").string());
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_EQ(r.err.rfind("plvo: error: ", 0), 0u) << r.err;
}

TEST(CliRunReal, TracksAKinect) {
  const char* shared = std::getenv("PLVO_SHARED");
  const fs::path folder = fs::path(shared == nullptr ? "" : shared) / "data" / "fr1_xyz_10f";
  if (!fs::exists(folder)) GTEST_SKIP() << "the shared sequences are not here: " << folder;
  const TemporaryFolder out;
  const CommandResult r = test::run_plvo("run " + folder.string() + " --camera-model tum-fr1 --json " +
                                         (out / "j.json").string());
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const auto json = nlohmann::json::parse(read_file(out / "j.json"));
  EXPECT_EQ(json["lost"], 0);
  EXPECT_EQ(json["unpaired_images"], 1);
  EXPECT_LT(json["evaluation"]["rpe"][0]["translation_m"]["rmse"], 0.012);
  // There is no allocation after init; the bookkeeping of the summary stays below a few pages.
  EXPECT_LE(json["memory_bytes"]["anonymous_at_end"].get<long>() -
                json["memory_bytes"]["anonymous_after_start"].get<long>(),
            16384);
}

}  // namespace
}  // namespace plvo
