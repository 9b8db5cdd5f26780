// SPDX-License-Identifier: Apache-2.0
// Unsupported recordings are recognised by their names and first bytes, in every command that takes one.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "plvo_command.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::write_file;

class CliForeignFormats : public test::PlvoCommand {
 protected:
  void expect_told(const std::string& name, const std::string& what) const {
    const std::string recording = path(name);
    for (const std::string& command : {"run " + recording, "live --device " + recording,
                                       "record " + path("made") + " --device " + recording,
                                       "calibrate " + recording + " --out " + path("c.yaml"),
                                       "eval --gt " + recording + " --est " + path("t.txt")}) {
      const CommandResult r = plvo(command);
      EXPECT_EQ(r.exit_code, 1) << command << r.err;
      EXPECT_NE(r.err.find(recording + " is " + what), std::string::npos) << command << '\n' << r.err;
      EXPECT_NE(r.err.find("share/doc/plvo/user/recordings.md"), std::string::npos)
          << "it says what to do: " << r.err;
    }
    EXPECT_FALSE(fs::exists(path("made")));
  }
};

TEST_F(CliForeignFormats, RecognisesNameOrFirstBytes) {
  write_file(path("t.txt"), "1 0 0 0 0 0 0 1\n");
  const std::string mcap("\x89MCAP0\r\n and so on");
  const std::string sqlite("SQLite format 3\0 and so on", 26);
  const std::string matroska("\x1a\x45\xdf\xa3 and so on");
  for (const auto& [file, content, what] :
       {std::tuple<const char*, std::string, const char*>{"a.mcap", "", "an MCAP file"},
        {"b.data", mcap, "an MCAP file"},
        {"b.bag", mcap, "an MCAP file"},
        {"a.db3", "", "an SQLite file"},
        {"c.data", sqlite, "an SQLite file"},
        {"a.mkv", "", "a Matroska video"},
        {"d.data", matroska, "a Matroska video"},
        {"walk.bag.active", "#ROSBAG V2.0\n", "a ROS 1 bag, which is read under a name that ends in .bag"}}) {
    write_file(path(file), content);
    expect_told(file, what);
  }
  fs::create_directory(path("ros2"));
  write_file(path("ros2/metadata.yaml"), "rosbag2_bagfile_information:\n  version: 5\n");
  expect_told("ros2", "a folder of rosbag2 (ROS 2)");
}

TEST_F(CliForeignFormats, AcceptsOtherFiles) {
  fs::create_directory(path("mine"));
  write_file(path("mine/metadata.yaml"), "author: me\n");
  const CommandResult r = plvo("run " + path("mine"));
  EXPECT_NE(r.err.find("rgb.txt"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace plvo
