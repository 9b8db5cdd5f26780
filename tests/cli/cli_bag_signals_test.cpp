// SPDX-License-Identifier: Apache-2.0
// A signal while a bag is opened ends the program at once, in every command, because no output exists yet.
// The exit status shows it: a program that deferred the signal would read the whole bag and exit normally.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bag_writer.hpp"
#include "plvo/rosbag/containers/bag_file.hpp"
#include "plvo_binary.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

// A few kB that take minutes to unpack.
std::string bag_that_takes_long() {
  test::BagWriter writer;
  writer.put(std::string(kMaxPiece, '\0'));
  const std::string chunk = writer.packed_chunk("bz2");
  for (int i = 0; i < 300; ++i) writer.put_chunks(chunk);
  return writer.file();
}

bool has_open(pid_t process, const fs::path& file) {
  std::error_code error;
  const fs::path folder = "/proc/" + std::to_string(process) + "/fd";
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (fs::read_symlink(entry->path(), error) == file) return true;
  return false;
}

TEST(CliBagSignals, TerminationWhileABagIsOpened) {
  const TemporaryFolder folder;
  const std::string bag = fs::canonical(folder.path()) / "a.bag";
  test::write_file(bag, bag_that_takes_long());
  const std::string made = (folder / "made").string();
  const std::vector<std::vector<std::string>> commands = {{"run", bag},
                                                          {"live", "--device", bag},
                                                          {"record", made, "--device", bag},
                                                          {"calibrate", bag, "--out", made}};
  for (const std::vector<std::string>& command : commands)
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
      std::vector<std::string> words = command;
      words.insert(words.begin(), test::kPlvo);
      const pid_t child = ::fork();
      if (child == 0) {
        ::signal(signal, SIG_DFL);  // the caller of the tests may ignore it
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
      }
      int how = 0;
      while (!has_open(child, bag) && ::waitpid(child, &how, WNOHANG) == 0) ::usleep(1000);
      ::usleep(100'000);
      ::kill(child, signal);
      ASSERT_EQ(::waitpid(child, &how, 0), child);
      EXPECT_TRUE(WIFSIGNALED(how) && WTERMSIG(how) == signal) << command[0] << ' ' << signal << ' ' << how;
    }
  EXPECT_FALSE(fs::exists(made));
}

}  // namespace
}  // namespace plvo
