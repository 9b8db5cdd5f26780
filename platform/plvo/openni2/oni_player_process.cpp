// SPDX-License-Identifier: Apache-2.0
// The child's side of OniPlayer: opens the recording with OpenNI2 and sends its images. A damaged file can
// crash this process, so the process has few resources: one socket, no files to write, bounded memory.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <thread>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/openni2/oni_messages.hpp"
#include "plvo/openni2/oni_player.hpp"
#include "plvo/openni2/openni2_device.hpp"

namespace plvo {
namespace {

constexpr int kSocket = STDIN_FILENO;
constexpr int kSlice_ms = 20;
constexpr int kSilence_ms = 10000;  // OpenNI2 reads a file; after so long a silence no more images will come

void limit(int resource, rlim_t most) {
  const rlimit value{most, most};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &value);
}

void limit_self() {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers map terabytes
  limit(RLIMIT_DATA, kMostReaderBytes);  // the writable memory, not the addresses that malloc reserves
#endif
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
}

// Ends the process if its parent is gone, even while OpenNI2 is in an endless loop.
void end_with_parent() {
  std::thread([] {
    char byte = 0;
    while (::recv(kSocket, &byte, 1, 0) != 0) {
      if (errno != EINTR && errno != EAGAIN) break;
    }
    ::_exit(1);
  }).detach();
}

void send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(kSocket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) ::_exit(1);  // the parent has closed the socket
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

// Sends an image with its rows without gaps.
void send(const DeviceImage& image, const StreamFormat& format) {
  send(oni_image_head(image));
  if (image.data == nullptr) return;
  const std::size_t row = format.row_bytes();
  if (image.stride_bytes == static_cast<std::ptrdiff_t>(row)) return send({image.data, format.image_bytes()});
  for (int y = 0; y < format.height; ++y) send({image.data + y * image.stride_bytes, row});
}

void play(const char* path) {
  std::shared_ptr<OpenNi2Runtime> runtime;
  Status status = OpenNi2Runtime::acquire(runtime);
  if (!status.ok()) return send(oni_failure(status));
  OpenNi2Device device(runtime);
  status = device.open(path, OpenNi2Options());
  if (status.ok() && !device.is_file())
    status = Status(StatusCode::kDamaged, "not an .oni file: ").append(path);
  if (status.ok()) status = device.start();
  if (!status.ok()) {
    send(oni_failure(status));
    ::_exit(0);  // no cleanup: a damaged file may have corrupted the memory
  }
  send(oni_hello({device.colour_format(), device.depth_format(), device.info(), device.recorded_frames()}));
  for (int silent_ms = 0; silent_ms < kSilence_ms;) {
    DeviceImage image;
    switch (device.wait(kSlice_ms, image)) {
      case ImageDevice::Wait::kImage:
        silent_ms = 0;
        send(image, image.stream == FramePairer::kColour ? device.colour_format() : device.depth_format());
        break;
      case ImageDevice::Wait::kTimeout:
        if (device.at_end()) {
          send(oni_end());
          ::_exit(0);
        }
        silent_ms += kSlice_ms;
        break;
      default: std::this_thread::sleep_for(std::chrono::milliseconds(1)); silent_ms += 1;
    }
  }
  send(oni_failure(
      Status(StatusCode::kIo, "the recording ends early: it is damaged or was cut: ").append(path)));
}

}  // namespace

std::optional<int> play_oni_if_asked(int argc, const char* const* argv) {
  if (argc != 2 || std::strcmp(argv[0], kOniPlayerName) != 0) return {};
  limit_self();
  end_with_parent();
  play(argv[1]);
  ::_exit(0);
}

}  // namespace plvo
