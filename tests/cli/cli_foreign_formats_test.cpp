// SPDX-License-Identifier: Apache-2.0
// Recordings that are not read are recognised by their names and first bytes, in every command that takes
// one; those that are read, too.
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
      EXPECT_NE(r.err.find("share/doc/plvo/user/ros_recordings.md"), std::string::npos)
          << "it says what to do: " << r.err;
    }
    EXPECT_FALSE(fs::exists(path("made")));
  }
};

TEST_F(CliForeignFormats, RecognisesNameOrFirstBytes) {
  write_file(path("t.txt"), "1 0 0 0 0 0 0 1\n");
  const std::string matroska("\x1a\x45\xdf\xa3 and so on");
  for (const auto& [file, content, what] :
       {std::tuple<const char*, std::string, const char*>{"a.mkv", "", "a Matroska video"},
        {"d.data", matroska, "a Matroska video"}}) {
    write_file(path(file), content);
    expect_told(file, what);
  }
}

// A recording of ROS is told by its first bytes, whatever its name, or else by its name.
TEST_F(CliForeignFormats, RecordingsOfRosAreToldByContentAndName) {
  const std::string mcap("\x89MCAP0\r\n\x06 and so on");
  const std::string sqlite("SQLite format 3\0 and so on", 26);
  for (const auto& [file, content, words] :
       {std::tuple<const char*, std::string, const char*>{"a.mcap", "", "is not an MCAP file"},
        {"b.data", mcap, "b.data is cut short"},
        {"b.bag", mcap, "b.bag is cut short"},
        {"a.db3", "", "is not a database of rosbag2"},
        {"c.data", sqlite, "is not a database of SQLite"},
        {"recording.bag.active", "#ROSBAG V2.0\n", "recording.bag.active is cut short"},
        {"recording.bag", "", "is not a ROS 1 bag"}}) {
    write_file(path(file), content);
    const CommandResult r = plvo("run " + path(file));
    EXPECT_EQ(r.exit_code, 1) << file << r.err;
    EXPECT_NE(r.err.find(words), std::string::npos) << file << r.err;
  }
  fs::create_directory(path("ros2"));
  write_file(path("ros2/metadata.yaml"), "rosbag2_bagfile_information:\n  version: 5\n");
  const CommandResult r = plvo("run " + path("ros2"));
  EXPECT_NE(r.err.find("but no .db3 and no .mcap file"), std::string::npos) << r.err;
}

TEST_F(CliForeignFormats, AcceptsOtherFiles) {
  fs::create_directory(path("mine"));
  write_file(path("mine/metadata.yaml"), "author: me\n");
  const CommandResult r = plvo("run " + path("mine"));
  EXPECT_NE(r.err.find("rgb.txt"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace plvo
