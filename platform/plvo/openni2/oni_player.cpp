// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/oni_player.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>
#include <vector>

extern char** environ;

namespace plvo {
namespace {

using Clock = std::chrono::steady_clock;

// Time limit for the end of a process that has closed its socket.
constexpr std::chrono::milliseconds kLastMoments(5000);

Status check_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    return Status(StatusCode::kNotFound, "there is no file ").append(path);
  if (!std::filesystem::is_regular_file(status))
    return Status(StatusCode::kInvalidArgument, "not an .oni file, but a folder, a pipe or a device: ")
        .append(path);
  return {};
}

}  // namespace

Status OniPlayer::open(const std::string& path, const std::string& program,
                       std::chrono::milliseconds patience) {
  close();
  path_ = path;
  patience_ = patience;
  if (Status status = check_file(path); !status.ok()) return status;
  if (Status status = spawn(path, program); !status.ok()) return status;
  last_heard_ = Clock::now();
  for (;;) {
    switch (receive(last_heard_ + patience_)) {
      case OniMessageReader::Message::kHello: return {};
      case OniMessageReader::Message::kPartial:
        if (!closed_by_child_ && Clock::now() < last_heard_ + patience_) continue;
        // No image was read yet, so the file itself is invalid.
        failure_ = closed_by_child_
                       ? obituary()
                       : Status(StatusCode::kIo, "OpenNI2 does not finish reading ").append(path);
        return {StatusCode::kDamaged, failure_.message()};
      default: return reader_.failure();
    }
  }
}

Status OniPlayer::spawn(const std::string& path, const std::string& program) {
  if (std::getenv(kOniPlayerVariable) != nullptr)
    return {StatusCode::kUnsupported,
            "this program cannot play .oni files: its main() must begin with play_oni_if_asked(), or name a "
            "program "
            "whose main() does"};
  int sockets[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
    return Status(StatusCode::kIo, "cannot make a socket: ").append(std::strerror(errno));
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, sockets[1], STDIN_FILENO);
  // The output of OpenNI2 and of the C library about a damaged file is discarded; the Status replaces it.
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
#endif
  // The child has its own process group, so Ctrl-C reaches only this program, which then ends the child
  // properly.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::string name = kOniPlayerName;
  std::string argument = path;
  std::string variable = std::string(kOniPlayerVariable) + "=1";
  char* arguments[] = {name.data(), argument.data(), nullptr};
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
  environment.push_back(variable.data());
  environment.push_back(nullptr);
  const char* file = program.empty() ? "/proc/self/exe" : program.c_str();
  const int error = ::posix_spawn(&child_, file, &files, &attributes, arguments, environment.data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  ::close(sockets[1]);
  socket_ = sockets[0];
  if (error == 0) return {};
  child_ = -1;
  close();
  return Status(StatusCode::kIo, "cannot start a process that plays the recording: ")
      .append(std::strerror(error));
}

// Receives one message. Returns kPartial if none arrives by the deadline or the child closed the socket
// (closed_by_child_).
OniMessageReader::Message OniPlayer::receive(Clock::time_point deadline) {
  for (;;) {
    const std::span<std::uint8_t> space = reader_.space();
    const ssize_t got = ::recv(socket_, space.data(), space.size(), MSG_DONTWAIT);
    if (got > 0) {
      last_heard_ = Clock::now();
      const OniMessageReader::Message message = reader_.advance(static_cast<std::size_t>(got));
      if (message != OniMessageReader::Message::kPartial) return message;
      continue;
    }
    if (got < 0 && errno == EINTR) continue;
    if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK)) {
      closed_by_child_ = true;
      return OniMessageReader::Message::kPartial;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return OniMessageReader::Message::kPartial;
    pollfd ready{socket_, POLLIN, 0};
    ::poll(&ready, 1, static_cast<int>(left < INT_MAX ? left : INT_MAX));
  }
}

ImageDevice::Wait OniPlayer::wait(int timeout_ms, DeviceImage& image) {
  if (!failure_.ok()) return Wait::kBroken;
  if (at_end_) return Wait::kTimeout;
  switch (receive(Clock::now() + std::chrono::milliseconds(timeout_ms))) {
    case OniMessageReader::Message::kImage: image = reader_.image(); return Wait::kImage;
    case OniMessageReader::Message::kEnd: at_end_ = true; return Wait::kTimeout;
    case OniMessageReader::Message::kPartial:
      if (closed_by_child_) {
        break_off(obituary());
      } else if (Clock::now() - last_heard_ > patience_) {
        break_off(Status(StatusCode::kIo, "OpenNI2 makes no progress in the recording, which is damaged: ")
                      .append(path_));
      } else {
        return Wait::kTimeout;
      }
      return Wait::kBroken;
    case OniMessageReader::Message::kHello: break;  // the reader accepts only one
    case OniMessageReader::Message::kFailure:
    case OniMessageReader::Message::kInvalid: break_off(reader_.failure()); break;
  }
  return Wait::kBroken;
}

void OniPlayer::break_off(const Status& failure) {
  // Never kDamaged, because a caller continues after kDamaged, but no more images follow.
  failure_ =
      Status(failure.code() == StatusCode::kDamaged ? StatusCode::kIo : failure.code(), failure.message());
}

// Waits for the end of the child and returns its cause.
Status OniPlayer::obituary() {
  int how = 0;
  pid_t ended = 0;
  const Clock::time_point deadline = Clock::now() + kLastMoments;
  while ((ended = ::waitpid(child_, &how, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
    if (Clock::now() > deadline) ::kill(child_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  child_ = -1;
  Status status(StatusCode::kIo, "OpenNI2's reader ");
  if (ended > 0 && WIFSIGNALED(how)) {
    status.append("crashed (").append(::strsignal(WTERMSIG(how))).append(")");
  } else {
    status.append("ended (exit code ").append(WIFEXITED(how) ? WEXITSTATUS(how) : -1).append(")");
  }
  return status.append(" in the recording, which is damaged: ").append(path_);
}

void OniPlayer::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  child_ = -1;
  reader_ = OniMessageReader();
  at_end_ = closed_by_child_ = false;
  failure_ = Status();
}

}  // namespace plvo
