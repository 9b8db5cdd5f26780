// SPDX-License-Identifier: Apache-2.0
// `plvo record` leaves complete files however it ends, including a full disk and Ctrl-C; `plvo doctor` with
// the virtual device.
#include <sys/mount.h>

#include <nlohmann/json.hpp>

#include "live_command.hpp"

namespace plvo_test {
namespace {

using plvo::test::CommandResult;

class CliRecord : public LiveCommand {
 protected:
  ~CliRecord() override {
    if (mounted_) ::umount2(path("disk").c_str(), MNT_DETACH);
  }
  // Mounts a disk of this size; returns false if the user may not mount one.
  bool small_disk(const std::string& size) {
    std::filesystem::create_directory(path("disk"));
    mounted_ = ::mount("none", path("disk").c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    return mounted_;
  }
  // Number of frames of a folder or a file, as the program itself reads them.
  long playable(const std::string& recording) {
    const CommandResult r = plvo("run " + recording + " --quiet --json " + path("p"));
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const auto json = nlohmann::json::parse(read_file(path("p")));
    EXPECT_EQ(json["damaged"], 0);
    return json["frames"];
  }
  long listed(const std::string& folder) {
    EXPECT_EQ(lines_in(read_file(folder + "/rgb.txt")), lines_in(read_file(folder + "/depth.txt")));
    return lines_in(read_file(folder + "/rgb.txt")) - 1;
  }
  // Waits until the recording must contain some frames. OpenNI2 buffers its output before it writes to disk,
  // so the test waits for more frames if it records to an OpenNI2 file.
  void wait_for_bytes(const std::string& recording) const {
    if (recording.ends_with(".oni")) {
      comes_true([&] {
        return std::filesystem::exists(recording) && std::filesystem::file_size(recording) > 8u << 20;
      });
    } else {
      comes_true([&] { return lines_in(read_file(recording + "/depth.txt")) > 8; });
    }
  }
  bool mounted_ = false;
};

TEST_F(CliRecord, WritesAFolderWithTheGivenNumberOfFrames) {
  const CommandResult r = plvo("record " + path("sequence") + " --frames 12 --mode 320x240");
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_TRUE(contains(r.out, "12 frames in")) << r.out;
  EXPECT_TRUE(contains(r.out, "next: plvo run ")) << r.out;
  EXPECT_EQ(listed(path("sequence")), 12);
  EXPECT_EQ(playable(path("sequence")), 12);
}

TEST_F(CliRecord, CtrlCLeavesCompleteFiles) {
  for (const std::string name : {"sequence", "recording.oni"}) {
    start("record " + path(name));
    ASSERT_TRUE(says("Ctrl-C ends")) << err();
    wait_for_bytes(path(name));
    EXPECT_EQ(interrupt(), 0) << err();
    EXPECT_TRUE(contains(out(), "ended by a signal")) << out();
    EXPECT_GE(playable(path(name)), 5) << name;
    EXPECT_FALSE(contains(err(), "plvo: error")) << err();
  }
}

TEST_F(CliRecord, UnplugEndsAnOniFileButNotAFolder) {
  for (const std::string name : {"recording.oni", "sequence"}) {
    start("record " + path(name));
    ASSERT_TRUE(says("Ctrl-C ends")) << err();
    wait_for_bytes(path(name));
    tell_device("unplug");
    if (name == "recording.oni") {
      EXPECT_EQ(wait(), 4) << err();
      EXPECT_TRUE(contains(err(), "it is complete so far")) << err();
    } else {
      EXPECT_TRUE(says("was unplugged")) << err();
      const long before = listed(path(name));
      tell_device("plug");
      EXPECT_TRUE(says("frames arrive again")) << err();
      comes_true([&] { return lines_in(read_file(path(name) + "/depth.txt")) - 1 > before; });
      EXPECT_EQ(interrupt(), 0) << err();
      EXPECT_GT(listed(path(name)), before);
    }
    EXPECT_GE(playable(path(name)), 5) << name;
  }
}

TEST_F(CliRecord, ExistingFilesAreNotOverwritten) {
  std::filesystem::create_directory(path("sequence"));
  plvo::test::write_file(path("sequence/rgb.txt"), "mine");
  plvo::test::write_file(path("mine.oni"), "mine");
  for (const std::string name : {"sequence", "mine.oni"}) {
    const CommandResult r = plvo("record " + path(name), device("unplug"));
    EXPECT_EQ(r.exit_code, 1) << "told before a sensor is missed";
    EXPECT_TRUE(contains(r.err, "remove it or choose another")) << r.err;
  }
  EXPECT_EQ(read_file(path("sequence/rgb.txt")), "mine");
  EXPECT_EQ(read_file(path("mine.oni")), "mine");
  EXPECT_EQ(plvo("record").exit_code, 2);
  EXPECT_EQ(plvo("record " + path("x"), device("unplug")).exit_code, 4);
  EXPECT_FALSE(std::filesystem::exists(path("x"))) << "no sensor, no folder";
}

TEST_F(CliRecord, FullDiskEndsTheRecordingWithAdviceAndACompleteFolder) {
  if (!small_disk("400k")) GTEST_SKIP() << "this user may not mount a small disk";
  const CommandResult r = plvo("record " + path("disk/sequence") + " --seconds 20 --mode 320x240");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_TRUE(contains(r.err, "No space left on device; free some space or choose another disk")) << r.err;
  const long frames = listed(path("disk/sequence"));
  EXPECT_GE(frames, 3);
  EXPECT_EQ(playable(path("disk/sequence")), frames);
  EXPECT_TRUE(contains(r.out, std::to_string(frames) + " frames in")) << r.out;
}

TEST_F(CliRecord, AlmostFullDiskLeavesAPlayableOniFile) {
  if (!small_disk("80m")) GTEST_SKIP() << "this user may not mount a small disk";
  const CommandResult r = plvo("record " + path("disk/recording.oni") + " --seconds 20");
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_TRUE(contains(r.err, "the disk is almost full")) << r.err;
  EXPECT_GE(playable(path("disk/recording.oni")), 2);
}

TEST_F(CliRecord, ALimitOnTheSizeOfFilesEndsItInWholeFiles) {
  const auto record = [&](const std::string& limit, const std::string& words) {
    return run_command("prlimit --fsize=" + limit + ' ' + kPlvo + " record " + words);
  };
  const CommandResult folder = record("3000", path("sequence") + " --seconds 20");  // less than an image
  EXPECT_EQ(folder.exit_code, 1);
  EXPECT_TRUE(contains(folder.err, "File too large; raise the limit on the size of files (ulimit -f)"))
      << folder.err;
  EXPECT_EQ(listed(path("sequence")), 0);
  EXPECT_TRUE(std::filesystem::is_empty(path("sequence/rgb")));
  const CommandResult oni = record("80000000", path("recording.oni") + " --seconds 20");
  EXPECT_EQ(oni.exit_code, 1);
  EXPECT_TRUE(contains(oni.err, "the limit on the size of files is almost reached")) << oni.err;
  EXPECT_GE(playable(path("recording.oni")), 2);
}

TEST_F(CliRecord, DoctorChecksTheFrames) {
  const auto examine = [&](const std::string& commands, int& code) {
    const CommandResult r = plvo("doctor --json - --seconds 1 --mode 320x240", device(commands));
    code = r.exit_code;
    return nlohmann::json::parse(r.out);
  };
  const auto has = [](const nlohmann::json& json, const std::string& code) {
    return std::any_of(json["findings"].begin(), json["findings"].end(),
                       [&](const nlohmann::json& f) { return f["code"] == code; });
  };
  int code = -1;
  nlohmann::json json = examine("", code);
  // On a loaded machine the frames may arrive too slowly; the doctor must then report it.
  EXPECT_EQ(code, has(json, "slow") ? 4 : 0) << json;
  EXPECT_TRUE(has(json, "capture_good") || has(json, "slow")) << json;
  EXPECT_EQ(has(json, "slow"), json["capture"]["hz"].get<double>() < 27) << json;
  EXPECT_EQ(json["cameras"][0]["uri"], "virtual://plvo");
  json = examine("period 100000", code);
  EXPECT_TRUE(has(json, "slow")) << json;
  EXPECT_EQ(code, 4);
  json = examine("dark 1;zero_depth 1", code);
  EXPECT_TRUE(has(json, "dark") && has(json, "no_depth")) << json;
  EXPECT_EQ(code, 4);
  json = examine("stall", code);
  EXPECT_TRUE(has(json, "no_frames")) << json;
  EXPECT_EQ(code, 4);
}

}  // namespace
}  // namespace plvo_test
