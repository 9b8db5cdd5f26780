// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/openni2_camera.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <thread>

#include "plvo/openni2/camera_impl.hpp"
#include "plvo/openni2/oni_player.hpp"
#include "plvo/openni2/openni2_recorder.hpp"

namespace plvo {
namespace {

using Clock = std::chrono::steady_clock;

// Longest single wait in OpenNI2; an unplug is noticed within this time.
constexpr int kWaitSlice_ms = 20;

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

// Copies rows, reversed if the driver cannot disable mirroring.
template <std::size_t pixel_bytes>
void copy_rows(const DeviceImage& from, std::uint8_t* to, bool mirrored) {
  const std::uint8_t* source = from.data;
  const auto width = static_cast<std::size_t>(from.width);
  for (int y = 0; y < from.height; ++y) {
    if (!mirrored) {
      std::memcpy(to, source, width * pixel_bytes);
    } else {
      for (std::size_t x = 0; x < width; ++x) {
        std::memcpy(to + x * pixel_bytes, source + (width - 1 - x) * pixel_bytes, pixel_bytes);
      }
    }
    source += from.stride_bytes;
    to += width * pixel_bytes;
  }
}

}  // namespace

OpenNi2Camera::OpenNi2Camera() : impl_(std::make_unique<Impl>()) {}
OpenNi2Camera::~OpenNi2Camera() { close(); }

Status OpenNi2Camera::list(std::vector<OpenNi2DeviceInfo>& devices) {
  devices.clear();
  std::shared_ptr<OpenNi2Runtime> runtime;
  if (Status status = OpenNi2Runtime::acquire(runtime); !status.ok()) return status;
  openni::Array<openni::DeviceInfo> infos;
  openni::OpenNI::enumerateDevices(&infos);
  for (int i = 0; i < infos.getSize(); ++i) {
    const openni::DeviceInfo& info = infos[i];
    devices.push_back(
        {info.getUri(), info.getVendor(), info.getName(), info.getUsbVendorId(), info.getUsbProductId()});
  }
  return {};
}

Status OpenNi2Camera::open(const OpenNi2Options& options) {
  close();
  impl_ = std::make_unique<Impl>();
  impl_->options = options;
  Status status = impl_->open();
  if (!status.ok()) close();
  return status;
}

void OpenNi2Camera::close() {
  if (impl_->recorder != nullptr) impl_->recorder->stop();
  impl_->device.reset();
  impl_->sensor = nullptr;
  impl_->runtime.reset();
}

CameraModel OpenNi2Camera::model() const { return impl_->model; }
Status OpenNi2Camera::next(RgbdFrame& frame) { return impl_->next(frame); }
OpenNi2DeviceInfo OpenNi2Camera::device() const { return impl_->info; }
bool OpenNi2Camera::registered_by_device() const { return impl_->registered_by_device; }
int OpenNi2Camera::recorded_frames() const { return impl_->device ? impl_->device->recorded_frames() : -1; }

OpenNi2Counters OpenNi2Camera::counters() const {
  OpenNi2Counters counters = impl_->counters;
  counters.unmatched_colour = impl_->pairer.unmatched(FramePairer::kColour);
  counters.unmatched_depth = impl_->pairer.unmatched(FramePairer::kDepth);
  return counters;
}

void OpenNi2Camera::Impl::log(LogLevel level, const Status& status) const {
  if (options.log != nullptr) options.log->write(level, status.message());
}

Status OpenNi2Camera::Impl::open() {
  if (options.timeout_ms <= 0) return {StatusCode::kInvalidArgument, "timeout_ms must be positive"};
  if (Status status = open_device(); !status.ok()) return status;
  info = device->info();

  const StreamFormat& colour = device->colour_format();
  const StreamFormat& depth = device->depth_format();
  if (Status status = choose_model(colour); !status.ok()) return status;
  const auto pixels = static_cast<std::size_t>(colour.width) * static_cast<std::size_t>(colour.height);
  period_us = 1000000 / std::max(1, colour.fps);
  const std::int64_t half_us = period_us / 2;
  const bool given = options.pair_tolerance_us > 0 && options.pair_tolerance_us < half_us;
  pairer.reset(colour.image_bytes(), depth.image_bytes(), given ? options.pair_tolerance_us : half_us);
  tracker.reset(period_us, !device->is_file());
  metres_per_unit = depth.format == ImageFormat::kDepth100Um ? 0.0001 : 0.001;

  registered_by_device = device->registered();
  warp = !registered_by_device && options.registration != OpenNi2Registration::kNone;
  if (warp) {
    registered.resize(pixels);
    registration.reset(pinhole_from_fov(depth.width, depth.height, depth.fov_x_rad, depth.fov_y_rad), model,
                       metres_per_unit);
    log(LogLevel::kWarning, Status(StatusCode::kUnsupported,
                                   "depth is registered to colour in software, with a nominal "
                                   "baseline of 25 mm: expect errors of a few pixels"));
  }
  return device->start();
}

Status OpenNi2Camera::Impl::open_device() {
  if (options.uri.ends_with(".oni")) {
    auto player = std::make_unique<OniPlayer>();
    Status status =
        player->open(options.uri, options.oni_player, std::chrono::milliseconds(options.oni_patience_ms));
    device = std::move(player);
    return status;
  }
  if (Status status = OpenNi2Runtime::acquire(runtime); !status.ok()) return status;
  auto opened = std::make_unique<OpenNi2Device>(runtime);
  Status status = opened->open(options.uri, options);
  sensor = opened.get();
  device = std::move(opened);
  return status;
}

Status OpenNi2Camera::Impl::choose_model(const StreamFormat& colour) {
  if (options.model.has_value()) {
    model = *options.model;
    if (model.width != colour.width || model.height != colour.height) {
      return Status(StatusCode::kInvalidArgument, "the calibration is for ")
          .append(model.width)
          .append("x")
          .append(model.height)
          .append(", the camera gives ")
          .append(colour.width)
          .append("x")
          .append(colour.height);
    }
    return model.validate();
  }
  if (!(colour.fov_x_rad > 0.1 && colour.fov_x_rad < 3.0 && colour.fov_y_rad > 0.1 &&
        colour.fov_y_rad < 3.0)) {
    return {StatusCode::kInvalidArgument,
            "the device states no field of view: give a calibration of the camera"};
  }
  model = CameraModel{};
  model.width = colour.width;
  model.height = colour.height;
  model.pinhole = pinhole_from_fov(colour.width, colour.height, colour.fov_x_rad, colour.fov_y_rad);
  const bool kinect = info.uri.rfind("freenect://", 0) == 0;  // our driver supports only Kinects
  model.readout_s = options.readout_s.value_or(kinect ? kKinectReadout_s : 0);
  Status warning(StatusCode::kInvalidArgument,
                 "no calibration given: intrinsics guessed from the field of view (fx ");
  warning.append(static_cast<std::ptrdiff_t>(model.pinhole.fx + 0.5))
      .append(
          " px, no lens); expect a few per cent of error "
          "in every distance, or give a calibration");
  log(LogLevel::kWarning, warning);
  return {};
}

Status OpenNi2Camera::Impl::next(RgbdFrame& frame) {
  if (device == nullptr && !unplugged) return {StatusCode::kInvalidArgument, "the camera is not open"};
  pairer.release();
  const auto start = Clock::now();
  const auto deadline = start + std::chrono::milliseconds(options.timeout_ms);
  seen_in_call = {};
  for (;;) {
    if (unplugged) {
      if (Status status = replug(deadline); !status.ok()) return status;
    }
    FramePairer::Pair pair;
    if (pairer.take(pair)) {
      deliver(pair, frame);
      return {};
    }
    if (device->gone()) return lose();
    const auto now = Clock::now();
    if (now >= deadline) return timeout();
    const auto left_ms = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - now).count();
    DeviceImage image;
    switch (device->wait(static_cast<int>(std::clamp<std::int64_t>(left_ms, 1, kWaitSlice_ms)), image)) {
      case ImageDevice::Wait::kImage:
        if (Status status = take(image); !status.ok()) return status;
        break;
      case ImageDevice::Wait::kTimeout:
        if (device->at_end()) return {StatusCode::kEndOfStream, "the recording is over"};
        break;
      case ImageDevice::Wait::kError:
        // OpenNI2 returns errors while a device is being removed; the event follows.
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        break;
      case ImageDevice::Wait::kBroken: return device->failure();
    }
  }
}

Status OpenNi2Camera::Impl::take(const DeviceImage& image) {
  const FramePairer::Stream stream = image.stream;
  const bool is_colour = stream == FramePairer::kColour;
  const StreamFormat& format = is_colour ? device->colour_format() : device->depth_format();
  seen_in_call[stream] = true;
  (is_colour ? counters.colour_images : counters.depth_images)++;
  count_dropped(stream, image.index);
  if (image.data == nullptr) {
    ++counters.damaged;
    return Status(StatusCode::kDamaged, is_colour ? "a colour" : "a depth")
        .append(" image came in another size or format than the stream's: ")
        .append(image.width)
        .append("x")
        .append(image.height);
  }
  std::uint8_t* to = pairer.next_buffer(stream).data();
  switch (bytes_per_pixel(format.format)) {
    case 3: copy_rows<3>(image, to, format.mirrored); break;
    case 2: copy_rows<2>(image, to, format.mirrored); break;
    default: copy_rows<1>(image, to, format.mirrored); break;
  }

  const StampTracker::Result stamp = tracker.map(stream, image.stamp_us, now_us());
  // A step of the device's clock appears on both streams; it is counted on one.
  if (is_colour && stamp.step == StampTracker::Step::kWrap) ++counters.clock_wraps;
  if (is_colour && stamp.step == StampTracker::Step::kJump) {
    ++counters.clock_jumps;
    log(LogLevel::kWarning, Status(StatusCode::kDamaged,
                                   "the camera's clock jumped; stamps now come from this computer's clock"));
  }
  pairer.commit(stream, stamp.stamp_us);
  return {};
}

void OpenNi2Camera::Impl::count_dropped(FramePairer::Stream stream, int index) {
  int& last = last_index[stream];
  const int lost = index - last - 1;
  // A recording is delivered completely; a counter that restarts does not indicate a loss.
  if (last >= 0 && lost > 0 && !device->is_file()) {
    (stream == FramePairer::kColour ? counters.dropped_colour : counters.dropped_depth) +=
        static_cast<std::uint64_t>(lost);
  }
  last = index;
}

void OpenNi2Camera::Impl::deliver(const FramePairer::Pair& pair, RgbdFrame& frame) {
  const int width = model.width;
  const int height = model.height;
  const bool rgb = device->colour_format().format == ImageFormat::kRgb888;
  frame.stamp_ns = pair.colour.stamp_us * 1000;
  frame.depth_stamp_ns = pair.depth.stamp_us * 1000;
  frame.colour = {pair.colour.bytes.data(), width, height, static_cast<std::ptrdiff_t>(width) * (rgb ? 3 : 1),
                  rgb ? PixelFormat::kRgb8 : PixelFormat::kGray8};
  // The buffers have the allocator's alignment and depth images have even sizes, so the cast is aligned.
  const auto* depth = reinterpret_cast<const std::uint16_t*>(pair.depth.bytes.data());
  if (warp) {
    registration.warp(depth, registered.data());
    depth = registered.data();
  }
  frame.depth = {depth, width, height, width, metres_per_unit};

  if (counters.frames > 0 && !after_gap) {
    const std::int64_t steps = (pair.colour.stamp_us - last_delivered_us + period_us / 2) / period_us;
    if (steps > 1) counters.missing += static_cast<std::uint64_t>(steps - 1);
  }
  after_gap = false;
  last_delivered_us = pair.colour.stamp_us;
  ++counters.frames;
}

Status OpenNi2Camera::Impl::timeout() {
  ++counters.timeouts;
  const bool colour = seen_in_call[FramePairer::kColour];
  const bool depth = seen_in_call[FramePairer::kDepth];
  Status status(StatusCode::kTimeout, "");
  if (colour && depth) {
    status.append("colour and depth come, but their stamps lie ");
    status.append(static_cast<std::ptrdiff_t>(pairer.last_miss_us() / 1000));
    status.append(" ms apart: no pair within half a frame for ");
  } else if (colour) {
    status.append("the depth stream stopped, colour goes on: nothing for ");
  } else if (depth) {
    status.append("the colour stream stopped, depth goes on: nothing for ");
  } else {
    status.append("no frames from ").append(info.name).append(" for ");
  }
  return status.append(options.timeout_ms).append(" ms");
}

Status OpenNi2Camera::Impl::lose() {
  if (recorder != nullptr) recorder->stop();
  device.reset();
  sensor = nullptr;
  pairer.clear();
  unplugged = true;
  after_gap = true;
  last_index = {-1, -1};
  ++counters.unplugged;
  Status status(StatusCode::kUnplugged, info.name);
  status.append(" was unplugged; plug it in again to go on");
  log(LogLevel::kWarning, status);
  return status;
}

// Finds the device at the requested URI or, if it has a new URI at another port, one of the same make.
bool OpenNi2Camera::Impl::find_again(std::string& uri) const {
  openni::Array<openni::DeviceInfo> infos;
  openni::OpenNI::enumerateDevices(&infos);
  for (int i = 0; i < infos.getSize(); ++i) {
    if (info.uri == infos[i].getUri()) {
      uri = info.uri;
      return true;
    }
  }
  for (int i = 0; i < infos.getSize(); ++i) {
    if (info.usb_vendor_id == infos[i].getUsbVendorId() &&
        info.usb_product_id == infos[i].getUsbProductId() && info.name == infos[i].getName()) {
      uri = infos[i].getUri();
      return true;
    }
  }
  return false;
}

Status OpenNi2Camera::Impl::replug(Clock::time_point deadline) {
  Status status(StatusCode::kUnplugged, info.name);
  status.append(" is still unplugged");
  for (;;) {
    std::string uri;
    if (find_again(uri)) {
      auto candidate = std::make_unique<OpenNi2Device>(runtime);
      Status opened = candidate->open(uri, options);
      if (opened.ok()) opened = candidate->start();
      if (opened.ok()) {
        sensor = candidate.get();
        device = std::move(candidate);
        info = device->info();
        tracker.restart();
        unplugged = false;
        ++counters.replugged;
        log(LogLevel::kInfo, Status(StatusCode::kOk, info.name).append(" is back"));
        return {};
      }
      // A device just plugged in may not be ready, or udev may not have set its permissions yet; try again.
      status = Status(StatusCode::kUnplugged, "it is back but does not open yet: ").append(opened.message());
    }
    if (Clock::now() >= deadline) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(kWaitSlice_ms));
  }
}

}  // namespace plvo
