// SPDX-License-Identifier: Apache-2.0
// .oni recordings on the command line: a faulty file, or one that kills the process that plays it, gives an
// error message and exit code 1.
#include <nlohmann/json.hpp>

#include "live_command.hpp"
#include "plvo/base/random.hpp"

namespace plvo_test {
namespace {

using plvo::test::CommandResult;

class CliOni : public LiveCommand {
 protected:
  void record(int frames) {
    const CommandResult r =
        plvo("record " + path("a.oni") + " --quiet --mode 320x240 --frames " + std::to_string(frames));
    ASSERT_EQ(r.exit_code, 0) << r.err;
  }
  // Process id of the child of the started program; 0 if no child appears.
  pid_t player(double limit_s = 30) const {
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::duration<double>(limit_s)) {
      std::ifstream file("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) + "/children");
      for (pid_t child = 0; file >> child;)
        if (contains(read_file("/proc/" + std::to_string(child) + "/cmdline"), "plvo-oni-player"))
          return child;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return 0;
  }
};

TEST_F(CliOni, CrashOfTheReaderIsAnErrorMessage) {
  record(20);
  start("live --quiet --device " + path("a.oni"));
  const pid_t child = player();
  ASSERT_GT(child, 0);
  ASSERT_EQ(::kill(child, SIGSEGV), 0);
  EXPECT_EQ(wait(60), 1) << err();
  EXPECT_TRUE(contains(err(), "plvo: error: ")) << err();
  EXPECT_TRUE(contains(err(), "crashed (Segmentation fault)")) << err();
  EXPECT_TRUE(contains(err(), "a.oni")) << err();
}

// About one in six of these files crashes OpenNI2 2.2's reader.
TEST_F(CliOni, DamagedHeadersNeverCrashTheProgram) {
  record(4);
  const std::string whole = read_file(path("a.oni"));
  plvo::Random random(5);
  for (int i = 0; i < 12; ++i) {
    std::string bytes = whole;
    for (int n = 0; n < 3; ++n) bytes[random.below(2000)] = static_cast<char>(random.below(256));
    plvo::test::write_file(path("b.oni"), bytes);
    const CommandResult r = plvo("live --quiet --device " + path("b.oni"));
    // Exit code 3: no frame of the file could be tracked.
    EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 1 || r.exit_code == 3)
        << i << ": " << r.exit_code << r.err;
    EXPECT_EQ(r.exit_code == 0, !contains(r.err, "plvo: error: ")) << i << ": " << r.err;
  }
}

TEST_F(CliOni, FilesThatAreNotRecordingsGiveAnError) {
  plvo::test::write_file(path("text.oni"), "no recording");
  const CommandResult text = plvo("live --device " + path("text.oni"));
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_TRUE(contains(text.err, "OpenNI2 cannot read the recording")) << text.err;
  std::filesystem::create_directory(path("folder.oni"));
  const CommandResult folder = plvo("live --device " + path("folder.oni"));
  EXPECT_EQ(folder.exit_code, 1);
  EXPECT_TRUE(contains(folder.err, "not an .oni file, but a folder")) << folder.err;
}

}  // namespace
}  // namespace plvo_test
