// SPDX-License-Identifier: Apache-2.0
// Tests wrong command lines: each ends with exit code 2, before anything is opened or written, and with one
// line that names the allowed values.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "plvo_command.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::run_plvo;
using test::TemporaryFolder;

void expect_usage(const std::string& arguments, const std::string& words) {
  SCOPED_TRACE("plvo " + arguments);
  const CommandResult r = run_plvo(arguments);
  EXPECT_EQ(r.exit_code, 2) << r.out << r.err;
  EXPECT_TRUE(r.out.empty()) << r.out;
  EXPECT_NE(r.err.find(words), std::string::npos) << r.err;
  EXPECT_EQ(r.err.rfind("plvo: error: ", 0), 0u) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  EXPECT_LT(r.err.size(), 300u) << r.err;
}

TEST(CliUsage, AllowedValuesAreNamedInWords) {
  expect_usage("run x --features circles", "--features: expected points, lines or both, not 'circles'");
  expect_usage("run x --preset fast", "--preset: expected default, paper or tiny, not 'fast'");
  expect_usage("run x --reference next",
               "--reference: expected previous, keyframe, both or window, not 'next'");
  expect_usage("run x --pace slow", "--pace: expected fast, realtime or step, not 'slow'");
  expect_usage("run --camera film", "--camera: expected sim, not 'film'");
  expect_usage("run x --camera-model tum-fr9",
               "expected tum-fr1, tum-fr2, tum-fr3, 7scenes or kinect-v1-default");
  expect_usage("simulate --out x --scene moon",
               "expected corridor, staircase, hall, desk or bare, not 'moon'");
  expect_usage("eval --gt a --est b --gt-sampling some", "expected nearest or interpolated, not 'some'");
  expect_usage("eval --gt a --est b --est-format csv", "expected auto, tum, euroc or kitti, not 'csv'");
  expect_usage("eval --gt a --est b --rpe-delta 3x",
               "expected frames, seconds or metres, such as 1f, 0.5s or 2m");
  expect_usage("tilt --led pink", "--led: expected off, green, red, yellow, blink-green or blink-red-yellow");
}

TEST(CliUsage, NumbersHaveReadableLimits) {
  for (const char* number : {"nan", "inf", "-1", "0", "1e300", "", "1x", "0x1"})
    expect_usage("run x --tolerance '" + std::string(number) + "'",
                 "expected a number above 0 and up to 3600, not");
  expect_usage("run x --depth-scale 0", "--depth-scale: expected a number from 1 to 100000, not '0'");
  expect_usage("run x --fx nan", "--fx: expected a number from 1 to 100000, not 'nan'");
  expect_usage("run x --readout 20", "--readout: expected a number from 0 to 1, not '20'");
  expect_usage("run x --stamp-sigma 0.2", "--stamp-sigma: expected a number from 0 to 0.1, not '0.2'");
  expect_usage("run x --distortion 1 2 3 nan",
               "--distortion: expected a number from -1000 to 1000, not 'nan'");
  expect_usage("run x --distortion-rational 1 2 3 4 5", "--distortion-rational: takes 8 values, not 5");
  expect_usage("run x --distortion-equidistant 1 2 x 4",
               "--distortion-equidistant: expected a number from -1000 to 1000, not 'x'");
  expect_usage("run x --distortion 1 2 3 4 --distortion-equidistant 1 2 3 4",
               "give one of --distortion, --distortion-rational and --distortion-equidistant");
  for (const char* command : {"run x", "live"}) {
    const std::string base = std::string(command) + " --out t --base-camera ";
    expect_usage(base + "0.1 0 0.5", "--base-camera: takes 7 values, not 3");
    expect_usage(base + "0.1 0 0.5 0 0 0 0", "the quaternion qx qy qz qw must have the length 1, not 0");
    expect_usage(base + "0.1 0 0.5 1 0.5 -0.5 0.5", "come qx qy qz qw, w last");
    expect_usage(base + "0.1 0 x 0 0 0 1", "--base-camera: expected a number from -1000 to 1000, not 'x'");
    expect_usage(base + "nan 0 0 0 0 0 1", "--base-camera: expected a number from -1000 to 1000, not 'nan'");
    expect_usage(std::string(command) + " --base-camera 0 0 0 -0.5 0.5 -0.5 0.5",
                 "changes what is written: add --out, --covariance, --motions, --mavlink or --stream");
  }
  for (const char* factor : {"0", "-1", "17", "1.5", "half"})
    expect_usage("run x --scale " + std::string(factor),
                 "--scale: expected a whole number from 1 to 16, not '" + std::string(factor) + "'");
  expect_usage("run --camera sim --scale 2", "is for recorded sequences, not for the simulated camera");
  expect_usage("run x.oni --scale 2", "--scale: is for folders of images, not for an .oni file");
  expect_usage("run x --frames 4:1",
               "--frames: expected a number of frames such as 20, or a range such as 10:20");
  expect_usage("run x --frames 0", "--frames: expected");
  expect_usage("run x --report r --report-frames -1", "expected a whole number from 1 to 100000, not '-1'");
  expect_usage("run x --ransac-seed 18446744073709551616",
               "expected a whole number from 0 to 18446744073709551615");
  expect_usage("simulate --out x --frames 1e9", "expected a whole number from 1 to 1000000, not '1e9'");
  expect_usage("simulate --out x --fps nan", "--fps: expected a number from 1 to 1000, not 'nan'");
  expect_usage("simulate --out x --size 8x8",
               "expected WIDTHxHEIGHT from 64x64 to 2047x2047, such as 320x240");
  expect_usage("simulate --out x --threads 0", "expected a whole number from 1 to 256, not '0'");
  expect_usage("eval --gt a --est b --offset nan",
               "--offset: expected a number from -4000000000 to 4000000000");
  expect_usage("eval --gt a --est b --gt-sampling nearest --max-dt nan",
               "--max-dt: expected a number above 0");
  expect_usage("live --max-rate nan", "--max-rate: expected a number above 0 and up to 1000, not 'nan'");
  expect_usage("live --seconds inf", "--seconds: expected a number above 0");
  expect_usage("record x --frames -1", "--frames: expected a whole number from 1");
  expect_usage("doctor --seconds 1e300", "--seconds: expected a number above 0");
  expect_usage("tilt 900", "angle: expected a number from -31 to 31, not '900'");
  expect_usage("tilt nan", "angle: expected a number from -31 to 31, not 'nan'");
}

TEST(CliUsage, UnknownWordsAreNamedAndMisspellingsCorrected) {
  expect_usage(
      "",
      "a command is needed: run, live, record, convert, info, map, calibrate, eval, simulate, doctor or "
      "tilt (see plvo --help)");
  expect_usage("rnu x", "there is no command 'rnu'");
  expect_usage("recrod x", "there is no command 'recrod'; did you mean record?");
  expect_usage("x --out y", "there is no command 'x'; choose run, live,");
  expect_usage("--verbose", "there is no option --verbose");
  expect_usage("run x --featurse both",
               "run: there is no option --featurse; did you mean --features? (see plvo run");
  expect_usage("run x --zoom=3 y", "run: there is no option --zoom");
  expect_usage("run x y", "run: 'y' is one word too many");
  expect_usage("run x -- y", "run: 'y' is one word too many");
  // Also if a required argument is missing: it may be the misspelt one.
  for (const char* command : {"run", "record", "eval", "calibrate", "simulate"})
    expect_usage(std::string(command) + " --bogus", std::string(command) + ": there is no option --bogus");
  expect_usage("eval --gt a --esst b", "eval: there is no option --esst; did you mean --est?");
  expect_usage("record", "record: path is required");
  expect_usage("eval --gt a", "--est is required");
  expect_usage("run x --out", "--out");
  expect_usage("run x --out ''", "--out: expected a path, not an empty word");
}

TEST(CliUsage, NumberOfValuesOfAnOptionIsStated) {
  expect_usage("run x --frames 5 --frames 6", "run: --frames: may be given once, not 2 times (see");
  expect_usage("run x --out a --out b --out c", "--out: may be given once, not 3 times");
  expect_usage("run x --preset", "run: --preset: a value is missing: default, paper or tiny (see");
  expect_usage("run x --fx 500", "--fx: pixels are square");
  expect_usage("live --fy 500", "give --fx as well");
  expect_usage("run x --fx", "--fx: a value is missing: PIXELS");
  expect_usage("run x --out=", "--out: a value is missing: FILE");
  expect_usage("live --stream", "--stream: a value is missing: [ADDR:]PORT, unix:PATH or -");
  expect_usage("run x --distortion 1 2", "--distortion: takes 4 to 5 values, not 2");
  expect_usage("run x --distortion 1 2 3 4 --distortion 1 2 3 4", "--distortion: takes 4 to 5 values, not 8");
  expect_usage("run x --quiet=3", "--quiet: is a switch and takes no value");
  expect_usage("run x --quiet=maybe", "--quiet: is a switch and takes no value");
}

TEST(CliUsage, OptionsThatDoNotApplyAreRefused) {
  expect_usage("run", "a sequence is needed: plvo run DIR, plvo run FILE.oni or plvo run --camera sim");
  expect_usage("calibrate", "recordings is required");
  expect_usage("calibrate x", "--out is required");
  expect_usage("calibrate x --out y --find scale", "--find: expected all or delay, not 'scale'");
  expect_usage("calibrate x --out y --frames 10", "--frames: expected a whole number from 60 to 5000");
  expect_usage("calibrate x.oni --out y --depth-scale 1000", "--depth-scale: does not apply to an .oni file");
  expect_usage("calibrate x --out y --report y", "--report: y is already written by --out");
  expect_usage("run x --camera sim", "exclude each other");
  expect_usage("run x --scene hall", "--scene: is for the simulated camera");
  expect_usage("run x --clean", "--clean: is for the simulated camera");
  expect_usage("run --camera sim --calibration c", "--calibration: is for recorded sequences");
  expect_usage("run --camera sim --readout 0.02", "--readout: is for recorded sequences");
  expect_usage("run --camera sim --tolerance 1", "--tolerance: is for recorded sequences");
  expect_usage("run --camera sim --frames 5:9", "a simulated sequence starts at frame 0");
  expect_usage("run x.oni --depth-scale 1000", "--depth-scale: does not apply to an .oni file");
  expect_usage("run x --calibration c --camera-model tum-fr1", "cannot be combined with --calibration");
  expect_usage("run x --preset tiny --reference both",
               "--reference: both and window do not apply to --preset tiny");
  expect_usage("live --preset tiny --reference window",
               "--reference: both and window do not apply to --preset tiny");
  expect_usage("run x --report-frames 3", "--report-frames: is for a report");
  expect_usage("live --device x.oni --mode 320x240@30", "--mode: does not apply to a recording");
  expect_usage("live --device x.oni --every-frame",
               "--every-frame: is what a recording and the simulated camera do anyway");
  expect_usage("record x.oni --camera-model tum-fr1", "an .oni file keeps no calibration");
  expect_usage("record x.oni --imu", "--imu: an .oni file keeps no readings of it; record a folder instead");
  expect_usage("doctor --no-capture --seconds 2", "--seconds: is for the capture");
  expect_usage("eval --gt a --est b --max-dt 0.1", "--max-dt: is for --gt-sampling nearest");
}

// This machine has no sensor: opening one first would fail with exit code 4.
TEST(CliUsage, WrongUsageIsFoundBeforeASensorIsOpened) {
  expect_usage("live --view abc", "--view: expected [ADDRESS:]PORT");
  expect_usage("live --view 70000", "--view: expected [ADDRESS:]PORT");
  expect_usage("live --stream abc", "--stream: expected [ADDRESS:]PORT, unix:PATH or -, not 'abc'");
  expect_usage("live --stream unix:" + std::string(120, 'x'), "a path of 1 to 107 characters");
  expect_usage("live --mode 640", "--mode: expected WIDTHxHEIGHT@FPS");
  expect_usage("live --out a --json a", "--json: a is already written by --out");
}

// Opening the sensor first would fail here with exit code 4, or would start a sensor if there is one.
TEST(CliUsage, OutputsAreTestedBeforeASensorIsOpened) {
  const TemporaryFolder folder;
  const auto at = [&folder](const std::string& name) { return (folder / name).string(); };
  std::filesystem::create_directory(folder / "sequence");
  test::write_file(folder / "sequence/depth.txt", "mine");
  test::write_file(folder / "recording.oni", "mine");
  test::write_file(folder / "poses.txt", "mine");
  const auto expect_refused = [](const std::string& arguments, const std::string& words) {
    const CommandResult r = run_plvo(arguments);
    EXPECT_EQ(r.exit_code, 1) << arguments << ": " << r.err;
    EXPECT_NE(r.err.find(words), std::string::npos) << arguments << ": " << r.err;
  };
  for (const char* command : {"record ", "live --record "}) {
    expect_refused(command + at("sequence"), "holds a recording already");
    expect_refused(command + at("recording.oni"), "exists already");
    expect_refused(command + at("no/such/folder"), "cannot make the folder");
    expect_refused(command + at("poses.txt"), "it is a file");
    expect_refused(command + at("no/such.oni"), "cannot create " + at("no/such.oni"));
  }
  test::write_file(folder / "accelerometer.txt", "mine");
  expect_refused("record --imu " + folder.path().string(), "has accelerometer.txt already");
  expect_refused("live --imu --record " + folder.path().string(), "has accelerometer.txt already");
  for (const char* output : {"--out ", "--covariance ", "--motions ", "--stats ", "--json "})
    expect_refused("live " + (output + at("no/such.txt")), "cannot create " + at("no/such.txt"));
  expect_refused("live --stream unix:" + at("no/socket"), at("no/socket"));
  expect_refused("live --view 192.0.2.1:0", "192.0.2.1");
  // Valid outputs are only tested: without a sensor no file is created and none is lost.
  run_plvo("record " + at("new") + " --seconds 0.01 --device freenect://9-9");
  run_plvo("live --device freenect://9-9 --record " + at("new.oni") + " --out " + at("poses.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder / "new"));
  EXPECT_FALSE(std::filesystem::exists(folder / "new.oni"));
  EXPECT_EQ(test::read_file(folder / "poses.txt"), "mine");
}

// Returns for each flag of a command its type and its description in the help, on one line.
std::map<std::string, std::string> flags_of(const std::string& command) {
  std::map<std::string, std::string> flags;
  std::istringstream help(run_plvo(command + " --help").out);
  std::string* told = nullptr;
  for (std::string line; std::getline(help, line);) {
    if (line.rfind("  --", 0) == 0) {
      told = &flags[line.substr(2, line.find(' ', 2) - 2)];
    } else if (line.rfind("    ", 0) != 0) {
      told = nullptr;
    }
    if (told == nullptr) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) *told += word + ' ';
  }
  return flags;
}

// Number of meanings of each flag that has more than one, and the reason.
const std::map<std::string, std::size_t>& flags_of_several_meanings() {
  static const std::map<std::string, std::size_t> flags = {
      {"--frames", 4},  // a number of frames; run also takes a range, calibrate the total over all recordings
      {"--imu", 3},     // a gyro and an accelerometer; each command uses them differently
      {"--calibration", 2},  // the same files; the default depends on the source of the frames
      {"--threads", 2},      // a number of threads; their task depends on the command
      {"--out", 3},          // the command's first result
      {"--json", 2},         // JSON; - prints it instead of the text if the text is the result
      {"--report", 3},       // a page; its content depends on the command
      {"--device", 2},       // doctor does not capture from a ROS bag
      {"--seconds", 2},      // doctor ends by itself
      {"--camera", 2},       // the simulated camera; the length of its sequence depends on the command
      {"--wheels", 2},       // a file beside a recording; live, what comes through a pipe
      {"--pace", 2},         // live has a pace of its own without a sensor, and no steps
  };
  return flags;
}

TEST(CliUsage, SameFlagHasTheSameMeaning) {
  std::map<std::string, std::set<std::string>> meanings;
  std::map<std::string, std::string> where;
  for (const char* command : {"run", "live", "record", "convert", "info", "map", "calibrate", "eval",
                              "simulate", "doctor", "tilt"}) {
    const auto flags = flags_of(command);
    EXPECT_FALSE(flags.empty()) << command;
    for (const auto& [flag, words] : flags) {
      meanings[flag].insert(words);
      where[flag] += std::string(command) + ": " + words + '\n';
    }
  }
  for (const auto& [flag, words] : meanings) {
    const auto several = flags_of_several_meanings().find(flag);
    EXPECT_EQ(words.size(), several == flags_of_several_meanings().end() ? 1u : several->second)
        << where[flag];
  }
  for (const auto& [flag, count] : flags_of_several_meanings())
    EXPECT_EQ(meanings.count(flag), 1u) << flag << " is no flag any more";
}

TEST(CliUsage, SameFlagHasTheSameEffect) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder / "sequence", 5).ok());
  const std::string recording = (folder / "sequence").string();
  // --frames N: the first N; --json FILE, and - for standard output, whatever the command.
  const CommandResult first = run_plvo("run " + recording + " --frames 2 --quiet --json -");
  const CommandResult range = run_plvo("run " + recording + " --frames 0:2 --quiet --json -");
  EXPECT_NE(first.out.find("\"frames\": 2,"), std::string::npos) << first.out << first.err;
  EXPECT_NE(range.out.find("\"frames\": 2,"), std::string::npos) << range.out << range.err;
  for (const char* command : {"run", "live", "eval", "doctor", "tilt"})
    EXPECT_NE(run_plvo(std::string(command) + " --help").out.find("--json FILE"), std::string::npos)
        << command;
  for (const char* command : {"run", "live", "record", "simulate"})
    EXPECT_NE(run_plvo(std::string(command) + " --help").out.find("Warnings and errors only"),
              std::string::npos)
        << command;
}

}  // namespace
}  // namespace plvo
