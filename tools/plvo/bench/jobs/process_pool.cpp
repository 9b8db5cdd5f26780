// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/process_pool.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <map>

namespace plvo::bench {
namespace {

pid_t start(const std::vector<std::string>& command) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  pid_t child = -1;
  const int failure = posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failure == 0 ? child : -1;
}

}  // namespace

std::size_t run_commands(const std::vector<std::vector<std::string>>& commands, int at_a_time,
                         const CommandEnded& ended) {
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0, done = 0, failed = 0;
  const auto finish = [&](std::size_t index, bool success) {
    if (!success) ++failed;
    ended(index, success, ++done);
  };
  while (next < commands.size() || !running.empty()) {
    if (next < commands.size() && running.size() < static_cast<std::size_t>(at_a_time)) {
      const pid_t child = start(commands[next]);
      if (child < 0) {
        finish(next, false);
      } else {
        running[child] = next;
      }
      ++next;
      continue;
    }
    int status = 0;
    const pid_t child = waitpid(-1, &status, 0);
    if (child < 0 && errno == EINTR) continue;
    if (child < 0) break;
    const auto found = running.find(child);
    if (found == running.end()) continue;
    const std::size_t index = found->second;
    running.erase(found);
    finish(index, WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  return failed;
}

std::string own_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

}  // namespace plvo::bench
