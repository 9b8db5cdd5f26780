// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/tum_folder.hpp"

#include <spng.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

namespace plvo {
namespace {

namespace fs = std::filesystem;

Status failure(int error, const fs::path& path) {
  const bool forbidden = error == EACCES || error == EPERM || error == EROFS;
  Status status(forbidden ? StatusCode::kPermission : StatusCode::kIo, "cannot write ");
  status.append(path.string().substr(0, 120)).append(": ").append(std::strerror(error));
  if (forbidden) return status.append("; choose a folder that you may write to");
  if (error == ENOSPC || error == EDQUOT)
    return status.append("; free some space, what was written so far is valid");
  return status;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// Writes all or nothing: a file that could not be completed is removed.
Status write_file(const fs::path& path, const void* data, std::size_t size) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) return failure(errno, path);
  const bool written = std::fwrite(data, 1, size, file.get()) == size;
  int error = errno;
  const bool closed = std::fclose(file.release()) == 0;
  if (written && closed) return {};
  if (written) error = errno;
  std::error_code ignored;
  fs::remove(path, ignored);
  return failure(error, path);
}

struct FreePng {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

// Pixels in the machine's byte order; rows without gaps. Level 1: three times the size of a picture is not
// worth three times the time.
Status write_png(const fs::path& path, const void* pixels, std::size_t size, int width, int height,
                 int bit_depth, int colour_type) {
  const std::unique_ptr<spng_ctx, FreePng> context(spng_ctx_new(SPNG_CTX_ENCODER));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = static_cast<std::uint8_t>(bit_depth);
  header.color_type = static_cast<std::uint8_t>(colour_type);
  int error = context == nullptr ? SPNG_EMEM : spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  if (error == 0) error = spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 1);
  if (error == 0) error = spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
  if (error == 0) error = spng_set_ihdr(context.get(), &header);
  if (error == 0) error = spng_encode_image(context.get(), pixels, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  if (error == 0) {
    std::size_t length = 0;
    const std::unique_ptr<void, FreeMemory> png(spng_get_png_buffer(context.get(), &length, &error));
    if (png != nullptr && error == 0) return write_file(path, png.get(), length);
  }
  return Status(StatusCode::kIo, "cannot encode ")
      .append(path.string().substr(0, 120))
      .append(": ")
      .append(spng_strerror(error));
}

// A text file that grows by whole lines. When a line cannot be written completely, the file is cut back to
// before it.
class LineFile {
 public:
  Status open(const fs::path& path, const std::string& heading) {
    path_ = path;
    file_.reset(std::fopen(path.c_str(), "wb"));
    if (!file_) return failure(errno, path);
    return append(heading);
  }
  Status append(const std::string& line) {
    if (std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size() &&
        std::fflush(file_.get()) == 0) {
      size_ += line.size();
      return {};
    }
    const int error = errno;
    std::fclose(file_.release());
    std::error_code ignored;
    fs::resize_file(path_, size_, ignored);
    return failure(error, path_);
  }

 private:
  fs::path path_;
  File file_;
  std::uintmax_t size_ = 0;
};

std::string seconds(std::int64_t stamp_ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%06lld", static_cast<long long>(stamp_ns / 1'000'000'000),
                static_cast<long long>(stamp_ns % 1'000'000'000 / 1000));
  return text;
}

std::string pose_line(const std::string& stamp, const Se3& T) {
  const Quaternion q = to_quaternion(T.R);
  char text[240];
  std::snprintf(text, sizeof text, "%s %.9f %.9f %.9f %.10f %.10f %.10f %.10f\n", stamp.c_str(), T.t.x(),
                T.t.y(), T.t.z(), q.x, q.y, q.z, q.w);
  return text;
}

std::string calibration_line(const CameraModel& camera, double metres_per_unit) {
  const Pinhole& k = camera.pinhole;
  const Distortion& d = camera.distortion;
  char text[320];
  const int n = std::snprintf(text, sizeof text, "%.9g %.9g %.9g %.9g %.9g", k.fx, k.fy, k.cx, k.cy,
                              1 / metres_per_unit);
  std::string line(text, static_cast<std::size_t>(n));
  if (!d.is_zero() || camera.readout_s > 0) {
    std::snprintf(text, sizeof text, " %.9g %.9g %.9g %.9g %.9g", d.k1, d.k2, d.p1, d.p2, d.k3);
    line += text;
  }
  if (camera.readout_s > 0) {
    std::snprintf(text, sizeof text, " %.9g", camera.readout_s);
    line += text;
  }
  return line + "\n";
}

struct Folder {
  fs::path path;
  LineFile rgb, depth, ground_truth;
};

Status open_folder(const std::string& name, Folder& folder) {
  folder.path = name;
  std::error_code error;
  if (fs::exists(folder.path / "rgb.txt", error) || fs::exists(folder.path / "depth.txt", error))
    return Status(StatusCode::kInvalidArgument, name.substr(0, 120))
        .append(" already holds a recording; choose another folder or remove it first");
  for (const fs::path& directory : {folder.path, folder.path / "rgb", folder.path / "depth"}) {
    fs::create_directories(directory, error);
    if (error) return failure(error.value(), directory);
  }
  Status status = folder.rgb.open(folder.path / "rgb.txt", "# colour images\n# timestamp filename\n");
  if (status.ok())
    status = folder.depth.open(folder.path / "depth.txt", "# depth images\n# timestamp filename\n");
  if (status.ok())
    status =
        folder.ground_truth.open(folder.path / "groundtruth.txt",
                                 "# exact camera poses, camera to world\n# timestamp tx ty tz qx qy qz qw\n");
  return status;
}

// Images first, then the lists: a list never names a file that is not there.
Status write_frame(const SimulatedCamera& camera, const RgbdFrame& frame, Folder& folder) {
  const std::string stamp = seconds(frame.stamp_ns);
  const std::string rgb_name = "rgb/" + stamp + ".png";
  const std::string depth_stamp = seconds(frame.depth_stamp_ns);
  const std::string depth_name = "depth/" + depth_stamp + ".png";
  const auto pixels =
      static_cast<std::size_t>(frame.colour.width) * static_cast<std::size_t>(frame.colour.height);
  Status status = write_png(folder.path / rgb_name, frame.colour.data, 3 * pixels, frame.colour.width,
                            frame.colour.height, 8, SPNG_COLOR_TYPE_TRUECOLOR);
  if (status.ok())
    status = write_png(folder.path / depth_name, frame.depth.data, 2 * pixels, frame.depth.width,
                       frame.depth.height, 16, SPNG_COLOR_TYPE_GRAYSCALE);
  if (status.ok()) status = folder.ground_truth.append(pose_line(stamp, camera.ground_truth(frame.stamp_ns)));
  if (status.ok()) status = folder.depth.append(depth_stamp + " " + depth_name + "\n");
  if (status.ok()) status = folder.rgb.append(stamp + " " + rgb_name + "\n");
  return status;
}

}  // namespace

Status write_tum_folder(SimulatedCamera& camera, const std::string& name, const WriteProgress& progress) {
  Folder folder;
  Status status = open_folder(name, folder);
  RgbdFrame frame;
  int written = 0;
  while (status.ok()) {
    status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (!status.ok()) return status;
    if (written == 0) {
      const std::string line = calibration_line(camera.model(), frame.depth.metres_per_unit);
      status = write_file(folder.path / "calibration.txt", line.data(), line.size());
      if (!status.ok()) return status;
    }
    status = write_frame(camera, frame, folder);
    if (!status.ok()) return status;
    ++written;
    if (progress && !progress(written, camera.frames())) return {};
  }
  return status;
}

}  // namespace plvo
