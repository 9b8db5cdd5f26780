// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/openni2_recorder.hpp"

#include <OpenNI.h>
#include <sys/resource.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "plvo/openni2/camera_impl.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

// Reserve for the data that OpenNI2 still holds in memory and for the index that it writes last.
constexpr std::uintmax_t kReserve_bytes = 64u << 20;

// Bytes that may still be added to the file; the most there are where that is not known.
std::uintmax_t room_on_disk(const fs::path& path) {
  std::error_code error;
  const fs::space_info space = fs::space(fs::absolute(path).parent_path(), error);
  return error ? UINTMAX_MAX : space.available;
}
std::uintmax_t room_within_limit(const fs::path& path) {
  rlimit limit{};
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || ::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return UINTMAX_MAX;
  return limit.rlim_cur > size ? limit.rlim_cur - size : 0;
}

}  // namespace

struct OpenNi2Recorder::Impl {
  openni::Recorder recorder;
  OpenNi2Camera::Impl* camera = nullptr;
  std::string path;
};

OpenNi2Recorder::OpenNi2Recorder() = default;
OpenNi2Recorder::~OpenNi2Recorder() { stop(); }

bool OpenNi2Recorder::recording() const { return impl_ != nullptr; }

Status OpenNi2Recorder::start(OpenNi2Camera& camera, const std::string& path) {
  stop();
  OpenNi2Camera::Impl& source = *camera.impl_;
  if (source.device == nullptr) return {StatusCode::kInvalidArgument, "open the camera before recording it"};
  if (source.sensor == nullptr) {
    return {StatusCode::kUnsupported,
            "what is played is an .oni file already: copy it, or record a folder of images from it"};
  }
  if (source.recorder != nullptr) return {StatusCode::kBusy, "this camera is being recorded already"};
  if (source.warp) {
    return {StatusCode::kUnsupported,
            "an .oni file of this sensor would hold unregistered depth: record a folder of images instead"};
  }
  if (!path.ends_with(".oni")) return {StatusCode::kInvalidArgument, "the file's name must end in .oni"};
  if (!std::ofstream(path, std::ios::binary)) return Status(StatusCode::kIo, "cannot write ").append(path);

  auto impl = std::make_unique<Impl>();
  impl->camera = &source;
  impl->path = path;
  // Lossless, because lossy compression would change the input of the odometry.
  if (impl->recorder.create(path.c_str()) != openni::STATUS_OK ||
      impl->recorder.attach(source.sensor->depth(), false) != openni::STATUS_OK ||
      impl->recorder.attach(source.sensor->colour(), false) != openni::STATUS_OK ||
      impl->recorder.start() != openni::STATUS_OK) {
    return Status(StatusCode::kIo, "OpenNI2 cannot record to ")
        .append(path)
        .append(": ")
        .append(openni::OpenNI::getExtendedError());
  }
  impl_ = std::move(impl);
  source.recorder = this;
  return check();
}

Status OpenNi2Recorder::check() {
  if (impl_ == nullptr) return {};
  const std::string path = impl_->path;
  const char* problem = room_on_disk(path) < kReserve_bytes
                            ? "the disk is almost full: free some space or choose another disk"
                        : room_within_limit(path) < kReserve_bytes
                            ? "the limit on the size of files is almost reached: raise it (ulimit -f)"
                            : nullptr;
  if (problem == nullptr) return {};
  stop();
  return Status(StatusCode::kIo, problem)
      .append("; the recording was ended and is complete so far: ")
      .append(path);
}

void OpenNi2Recorder::stop() {
  if (impl_ == nullptr) return;
  impl_->recorder.stop();
  impl_->recorder.destroy();
  impl_->camera->recorder = nullptr;
  impl_.reset();
}

}  // namespace plvo
