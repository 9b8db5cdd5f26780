// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/openni2_device.hpp"

#include <chrono>
#include <filesystem>
#include <mutex>
#include <sstream>
#include <string_view>
#include <thread>

namespace plvo {
namespace {

std::mutex runtime_mutex;
std::weak_ptr<OpenNi2Runtime> shared_runtime;

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// The error text of OpenNI2 and its drivers as one line.
std::string extended_error() {
  std::string line;
  std::istringstream words(openni::OpenNI::getExtendedError());
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

// OpenNI2 has one error code for almost all errors; the driver's text is more specific.
Status open_error(const std::string& uri) {
  const std::string text = extended_error();
  if (uri.empty() && contains(text, "no devices found")) {
    return {
        StatusCode::kNotFound,
        "no sensor: none is plugged in, or OpenNI2 has no driver for it; plvo doctor says what is missing"};
  }
  Status status(StatusCode::kNotFound, "");
  if (contains(text, "LIBUSB_ERROR_ACCESS") || contains(text, "ermission")) {
    status = Status(
        StatusCode::kPermission,
        "no permission to use the sensor: install the udev rule (60-plvo-rgbd.rules) and plug it in again; "
        "over ssh, be in the group video. ");
  } else if (contains(text, "LIBUSB_ERROR_BUSY") || contains(text, "busy")) {
    status = Status(StatusCode::kBusy,
                    "another program holds the sensor: close it, or unplug and plug in again. ");
  } else if (uri.ends_with(".oni")) {
    return Status(StatusCode::kDamaged,
                  "OpenNI2 cannot read the recording (broken, or libOniFile is missing): ")
        .append(uri);
  } else {
    status = Status(StatusCode::kNotFound, "cannot open the OpenNI2 device '");
    status.append(uri.empty() ? "(first)" : uri).append("': ");
  }
  return status.append(text);
}

Status mode_error(openni::SensorType sensor, const OpenNi2Options& options,
                  const openni::Array<openni::VideoMode>& modes) {
  Status status(StatusCode::kUnsupported, sensor == openni::SENSOR_COLOR ? "colour" : "depth");
  status.append(" does not come in ").append(options.width).append("x").append(options.height);
  status.append("@").append(options.fps).append("; this device offers");
  for (int i = 0; i < modes.getSize(); ++i) {
    status.append(" ").append(modes[i].getResolutionX()).append("x").append(modes[i].getResolutionY());
    status.append("@").append(modes[i].getFps());
  }
  return status;
}

// Finds the requested mode in the first of two pixel formats that the stream supports.
bool find_mode(const openni::Array<openni::VideoMode>& modes, const OpenNi2Options& options,
               openni::PixelFormat first, openni::PixelFormat second, openni::VideoMode& found) {
  for (const openni::PixelFormat format : {first, second}) {
    for (int i = 0; i < modes.getSize(); ++i) {
      const openni::VideoMode& mode = modes[i];
      if (mode.getPixelFormat() == format && mode.getResolutionX() == options.width &&
          mode.getResolutionY() == options.height && mode.getFps() == options.fps) {
        found = mode;
        return true;
      }
    }
  }
  return false;
}

// Returns false for a format that plvo does not support on this stream.
bool to_format(openni::SensorType sensor, openni::PixelFormat from, ImageFormat& format) {
  const bool colour = sensor == openni::SENSOR_COLOR;
  if (colour && from == openni::PIXEL_FORMAT_RGB888) {
    format = ImageFormat::kRgb888;
  } else if (colour && from == openni::PIXEL_FORMAT_GRAY8) {
    format = ImageFormat::kGray8;
  } else if (!colour && from == openni::PIXEL_FORMAT_DEPTH_1_MM) {
    format = ImageFormat::kDepth1Mm;
  } else if (!colour && from == openni::PIXEL_FORMAT_DEPTH_100_UM) {
    format = ImageFormat::kDepth100Um;
  } else {
    return false;
  }
  return true;
}

}  // namespace

Status OpenNi2Runtime::acquire(std::shared_ptr<OpenNi2Runtime>& runtime) {
  const std::lock_guard lock(runtime_mutex);
  runtime = shared_runtime.lock();
  if (runtime != nullptr) return {};
  if (openni::OpenNI::initialize() != openni::STATUS_OK) {
    Status status(StatusCode::kNotFound,
                  "OpenNI2 does not start: are its drivers (OpenNI2/Drivers) installed? ");
    return status.append(extended_error());
  }
  runtime.reset(new OpenNi2Runtime);
  shared_runtime = runtime;
  return {};
}

OpenNi2Runtime::~OpenNi2Runtime() {
  // OpenNI2 counts its initialisations, so another runtime that starts concurrently only increments the
  // count.
  openni::OpenNI::shutdown();
}

OpenNi2Device::OpenNi2Device(std::shared_ptr<OpenNi2Runtime> runtime) : runtime_(std::move(runtime)) {}

OpenNi2Device::~OpenNi2Device() { close(); }

Status OpenNi2Device::open(const std::string& uri, const OpenNi2Options& options) {
  gone_ = false;
  at_end_ = false;
  if (uri.ends_with(".oni") && !std::filesystem::exists(uri)) {
    return Status(StatusCode::kNotFound, "there is no file ").append(uri);
  }
  // The listeners are added first, so that the removal of a device during open() is not missed.
  openni::OpenNI::addDeviceDisconnectedListener(this);
  openni::OpenNI::addDeviceStateChangedListener(this);
  listening_ = true;
  if (device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK)
    return open_error(uri);
  const openni::DeviceInfo& info = device_.getDeviceInfo();
  {
    const std::lock_guard lock(mutex_);
    info_ = {info.getUri(), info.getVendor(), info.getName(), info.getUsbVendorId(), info.getUsbProductId()};
  }
  is_file_ = device_.isFile();

  if (Status status = create_stream(depth_, openni::SENSOR_DEPTH, options, depth_format_); !status.ok())
    return status;
  if (Status status = create_stream(colour_, openni::SENSOR_COLOR, options, colour_format_); !status.ok()) {
    return status;
  }
  if (colour_format_.width != depth_format_.width || colour_format_.height != depth_format_.height) {
    return Status(StatusCode::kUnsupported, "colour and depth differ in size in ").append(info_.uri);
  }
  if (is_file_) {
    // Manual playback delivers records on request, so a slow reader loses none.
    openni::PlaybackControl* playback = device_.getPlaybackControl();
    if (playback != nullptr) {
      playback->setSpeed(-1.0f);
      playback->setRepeatEnabled(false);
    }
  } else {
    // OpenNI2's own synchronisation pairs by frame index and withholds unpaired images; plvo pairs by stamp.
    device_.setDepthColorSyncEnabled(false);
  }
  set_registration(options);
  return {};
}

Status OpenNi2Device::create_stream(openni::VideoStream& stream, openni::SensorType sensor,
                                    const OpenNi2Options& options, StreamFormat& format) {
  const char* name = sensor == openni::SENSOR_COLOR ? "colour" : "depth";
  if (stream.create(device_, sensor) != openni::STATUS_OK) {
    return Status(is_file_ ? StatusCode::kDamaged : StatusCode::kUnsupported, "no ")
        .append(name)
        .append(" stream in ")
        .append(info_.uri)
        .append(": ")
        .append(extended_error());
  }
  if (!is_file_) {
    const bool tenths = options.depth_unit == OpenNi2DepthUnit::kTenthMillimetre;
    const openni::PixelFormat fine = openni::PIXEL_FORMAT_DEPTH_100_UM;
    const openni::PixelFormat coarse = openni::PIXEL_FORMAT_DEPTH_1_MM;
    const bool is_colour = sensor == openni::SENSOR_COLOR;
    const openni::PixelFormat first = is_colour ? openni::PIXEL_FORMAT_RGB888 : tenths ? fine : coarse;
    const openni::PixelFormat second = is_colour ? openni::PIXEL_FORMAT_GRAY8 : tenths ? coarse : fine;
    openni::VideoMode mode;
    const openni::Array<openni::VideoMode>& modes = stream.getSensorInfo().getSupportedVideoModes();
    if (!find_mode(modes, options, first, second, mode)) return mode_error(sensor, options, modes);
    // The mode is set even if it is the default, because PS1080 sensors start in 320x240.
    if (stream.setVideoMode(mode) != openni::STATUS_OK) return mode_error(sensor, options, modes);
    stream.setMirroringEnabled(false);
    if (stream.isCroppingSupported()) stream.resetCropping();
  }
  const openni::VideoMode mode = stream.getVideoMode();
  format.width = mode.getResolutionX();
  format.height = mode.getResolutionY();
  format.fps = mode.getFps();
  format.fov_x_rad = static_cast<double>(stream.getHorizontalFieldOfView());
  format.fov_y_rad = static_cast<double>(stream.getVerticalFieldOfView());
  format.mirrored = stream.getMirroringEnabled();
  if (!to_format(sensor, mode.getPixelFormat(), format.format)) {
    return Status(StatusCode::kUnsupported, name)
        .append(" comes in a pixel format that plvo does not read: ")
        .append(static_cast<std::ptrdiff_t>(mode.getPixelFormat()));
  }
  return {};
}

void OpenNi2Device::set_registration(const OpenNi2Options& options) {
  registered_ = is_file_;
  if (is_file_) return;
  const bool wanted = options.registration == OpenNi2Registration::kAuto;
  const openni::ImageRegistrationMode mode =
      wanted ? openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR : openni::IMAGE_REGISTRATION_OFF;
  if (device_.isImageRegistrationModeSupported(mode)) device_.setImageRegistrationMode(mode);
  registered_ = device_.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
}

Status OpenNi2Device::start() {
  for (openni::VideoStream* stream : {&depth_, &colour_}) {
    if (stream->start() != openni::STATUS_OK) {
      return Status(StatusCode::kIo, stream == &depth_ ? "depth" : "colour")
          .append(" does not start on ")
          .append(info_.uri)
          .append(": ")
          .append(extended_error());
    }
  }
  return {};
}

OpenNi2Device::Wait OpenNi2Device::wait(int timeout_ms, DeviceImage& image) {
  openni::VideoStream* streams[] = {&colour_, &depth_};
  int ready = -1;
  const openni::Status status = openni::OpenNI::waitForAnyStream(streams, 2, &ready, timeout_ms);
  if (status == openni::STATUS_TIME_OUT) return Wait::kTimeout;
  if (status != openni::STATUS_OK) return Wait::kError;
  const bool is_colour = ready == 0;
  // If the frame cannot be read, the device was just removed; an event follows.
  if (streams[ready]->readFrame(&lent_) != openni::STATUS_OK || !lent_.isValid()) return Wait::kError;
  const StreamFormat& format = is_colour ? colour_format_ : depth_format_;
  image = {};
  image.stream = is_colour ? FramePairer::kColour : FramePairer::kDepth;
  image.index = lent_.getFrameIndex();
  image.width = lent_.getWidth();
  image.height = lent_.getHeight();
  image.stamp_us = static_cast<std::int64_t>(lent_.getTimestamp());
  const auto row = static_cast<int>(format.row_bytes());
  const int stride = lent_.getStrideInBytes();
  ImageFormat came{};
  const openni::SensorType sensor = is_colour ? openni::SENSOR_COLOR : openni::SENSOR_DEPTH;
  const bool whole =
      image.width == format.width && image.height == format.height && !lent_.getCroppingEnabled() &&
      to_format(sensor, lent_.getVideoMode().getPixelFormat(), came) && came == format.format &&
      stride >= row && lent_.getDataSize() >= stride * (format.height - 1) + row;
  if (whole) image.data = static_cast<const std::uint8_t*>(lent_.getData());
  image.stride_bytes = stride;
  return Wait::kImage;
}

int OpenNi2Device::recorded_frames() {
  openni::PlaybackControl* playback = is_file_ ? device_.getPlaybackControl() : nullptr;
  return playback == nullptr ? -1 : playback->getNumberOfFrames(depth_);
}

void OpenNi2Device::close() {
  if (listening_) {
    openni::OpenNI::removeDeviceDisconnectedListener(this);
    openni::OpenNI::removeDeviceStateChangedListener(this);
    listening_ = false;
  }
  lent_.release();
  const bool streams = colour_.isValid() || depth_.isValid();
  if (colour_.isValid()) colour_.stop();
  if (depth_.isValid()) depth_.stop();
  // Some drivers (OpenNI2's own Dummy) do not join their thread in stop(); this wait lets it finish.
  if (streams && !is_file_) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  colour_.destroy();
  depth_.destroy();
  device_.close();
}

void OpenNi2Device::onDeviceDisconnected(const openni::DeviceInfo* info) {
  const std::lock_guard lock(mutex_);
  if (info_.uri == info->getUri()) gone_ = true;
}

void OpenNi2Device::onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) {
  const std::lock_guard lock(mutex_);
  if (info_.uri == info->getUri() && state == openni::DEVICE_STATE_EOF) at_end_ = true;
}

}  // namespace plvo
