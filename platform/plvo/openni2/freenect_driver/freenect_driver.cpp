// SPDX-License-Identifier: Apache-2.0
// The OpenNI2 driver for the Kinect v1 (models 1414 and 1473, and Kinect for Windows), based on Debian's
// libfreenect. It delivers colour and depth in 640x480 at 30 Hz, depth in millimetres. On request libfreenect
// registers depth to colour with the sensor's own calibration. The driver watches the bus itself and reports
// plugging and unplugging to OpenNI2. Written from OniDriverAPI.h and libfreenect.h.
#include <libusb.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

#include "plvo/openni2/freenect_driver/driver_stream.hpp"
#include "plvo/openni2/freenect_driver/kinect.hpp"

namespace plvo {
namespace {

constexpr char kScheme[] = "freenect://";
constexpr auto kWatch_ms = std::chrono::milliseconds(100);

// Nominal fields of view of the Kinect v1, as reported by the other OpenNI2 driver for it.
constexpr float kRadians = 3.14159265f / 180.0f;
constexpr FieldOfView kDepthFov{58.5f * kRadians, 45.6f * kRadians};
constexpr FieldOfView kColourFov{62.0f * kRadians, 48.6f * kRadians};

constexpr OniVideoMode kDepthMode{ONI_PIXEL_FORMAT_DEPTH_1_MM, Kinect::kWidth, Kinect::kHeight, 30};
constexpr OniVideoMode kColourMode{ONI_PIXEL_FORMAT_RGB888, Kinect::kWidth, Kinect::kHeight, 30};

class KinectDevice;

class KinectStream : public DriverStream {
 public:
  KinectStream(KinectDevice& device, OniSensorType sensor)
      : DriverStream(sensor, std::span(sensor == ONI_SENSOR_DEPTH ? &kDepthMode : &kColourMode, 1),
                     sensor == ONI_SENSOR_DEPTH ? kDepthFov : kColourFov),
        device_(device) {}
  OniStatus start() override;
  void stop() override;

  // Called on the Kinect's thread.
  void take(const void* pixels, std::uint64_t stamp_us) {
    if (!running()) return;
    OniFrame* frame = acquire();
    if (frame == nullptr) return;
    std::memcpy(frame->data, pixels, static_cast<std::size_t>(frame->dataSize));
    frame->timestamp = stamp_us;
    frame->frameIndex = ++index_;
    deliver(frame);
  }

 private:
  KinectDevice& device_;
  int index_ = 0;
};

class KinectDevice : public oni::driver::DeviceBase, private KinectListener {
 public:
  std::string open(const std::string& port) { return kinect_.open(port); }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    if (sensor != ONI_SENSOR_DEPTH && sensor != ONI_SENSOR_COLOR) return nullptr;
    const std::lock_guard lock(mutex_);
    std::shared_ptr<KinectStream>& slot = sensor == ONI_SENSOR_DEPTH ? depth_ : colour_;
    if (slot != nullptr) return nullptr;  // OpenNI2 itself shares one stream among its clients
    slot = std::make_shared<KinectStream>(*this, sensor);
    return slot.get();
  }
  void destroyStream(oni::driver::StreamBase* stream) override {
    static_cast<KinectStream*>(stream)->stop();
    const std::lock_guard lock(mutex_);
    (stream == depth_.get() ? depth_ : colour_).reset();
  }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || mode == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR ? TRUE : FALSE;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_DRIVER_VERSION ? TRUE
                                                                                                    : FALSE;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION && *size == sizeof(registration_)) {
      std::memcpy(data, &registration_, sizeof(registration_));
      return ONI_STATUS_OK;
    }
    const OniVersion version{0, 1, 0, 0};
    if (id == ONI_DEVICE_PROPERTY_DRIVER_VERSION && *size == sizeof(version)) {
      std::memcpy(data, &version, sizeof(version));
      return ONI_STATUS_OK;
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }
  // May be called before or after the depth stream exists, whether it is running or not.
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    if (size != sizeof(registration_)) return ONI_STATUS_BAD_PARAMETER;
    OniImageRegistrationMode wanted = ONI_IMAGE_REGISTRATION_OFF;
    std::memcpy(&wanted, data, sizeof(wanted));
    if (isImageRegistrationModeSupported(wanted) == FALSE) return ONI_STATUS_NOT_SUPPORTED;
    if (wanted == registration_) return ONI_STATUS_OK;
    registration_ = wanted;
    return kinect_.set_registered(wanted == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR) ? ONI_STATUS_OK
                                                                                   : ONI_STATUS_ERROR;
  }

  bool start(OniSensorType sensor) {
    return sensor == ONI_SENSOR_COLOR ? kinect_.start_colour() : kinect_.start_depth();
  }
  void stop(OniSensorType sensor) {
    sensor == ONI_SENSOR_DEPTH ? kinect_.stop_depth() : kinect_.stop_colour();
  }

 private:
  // Another thread may destroy the stream at the same time. keep() holds it while the image is delivered, and
  // destroyStream() waits for this thread. No lock is held during delivery, because the receiver may call
  // back.
  void on_depth(const std::uint16_t* depth_mm, std::uint64_t stamp_us) override {
    if (const auto stream = keep(depth_)) stream->take(depth_mm, stamp_us);
  }
  void on_colour(const std::uint8_t* rgb, std::uint64_t stamp_us) override {
    if (const auto stream = keep(colour_)) stream->take(rgb, stamp_us);
  }
  std::shared_ptr<KinectStream> keep(const std::shared_ptr<KinectStream>& stream) {
    const std::lock_guard lock(mutex_);
    return stream;
  }

  std::mutex mutex_;
  std::shared_ptr<KinectStream> depth_;
  std::shared_ptr<KinectStream> colour_;
  std::atomic<OniImageRegistrationMode> registration_ = ONI_IMAGE_REGISTRATION_OFF;
  OniVideoMode depth_mode_ = kDepthMode;
  OniVideoMode colour_mode_ = kColourMode;
  OniSensorInfo sensors_[2] = {{ONI_SENSOR_DEPTH, 1, &depth_mode_}, {ONI_SENSOR_COLOR, 1, &colour_mode_}};
  Kinect kinect_{*this};  // last member: its thread uses all members above
};

OniStatus KinectStream::start() {
  DriverStream::start();
  if (device_.start(sensor())) return ONI_STATUS_OK;
  DriverStream::stop();
  return ONI_STATUS_ERROR;
}

// Also if the stream is not running: when this returns, no image of it is being delivered.
void KinectStream::stop() {
  DriverStream::stop();
  device_.stop(sensor());
}

class FreenectDriver : public oni::driver::DriverBase {
 public:
  explicit FreenectDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state, void* cookie) override {
    DriverBase::initialize(connected, disconnected, state, cookie);
    if (libusb_init(&usb_) != 0) {
      usb_ = nullptr;
      return ONI_STATUS_ERROR;
    }
    look();
    watch_ = std::thread([this] {
      while (!quit_) {
        std::this_thread::sleep_for(kWatch_ms);
        look();
      }
    });
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    const std::string text = uri;
    auto device = std::make_unique<KinectDevice>();
    const std::string error =
        device->open(text.starts_with(kScheme) ? text.substr(sizeof(kScheme) - 1) : text);
    if (error.empty()) return device.release();
    getServices().errorLoggerAppend("Kinect %s: %s", uri, error.c_str());
    return nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }

  void shutdown() override {
    quit_ = true;
    if (watch_.joinable()) watch_.join();
    if (usb_ != nullptr) libusb_exit(usb_);
    usb_ = nullptr;
  }

 private:
  // libfreenect has no hot-plug events, and OpenNI2 depends on its drivers for them.
  void look() {
    const std::vector<KinectPlug> now = list_kinects(usb_);
    const auto has = [](const std::vector<KinectPlug>& list, const KinectPlug& plug) {
      return std::find(list.begin(), list.end(), plug) != list.end();
    };
    for (const KinectPlug& plug : known_) {
      if (!has(now, plug)) tell(plug, false);
    }
    for (const KinectPlug& plug : now) {
      if (!has(known_, plug)) tell(plug, true);
    }
    known_ = now;
  }

  void tell(const KinectPlug& plug, bool connected) {
    OniDeviceInfo info{};
    std::snprintf(info.uri, sizeof(info.uri), "%s%s", kScheme, plug.port.c_str());
    std::strcpy(info.vendor, "Microsoft");
    std::strcpy(info.name, "Kinect v1");
    info.usbVendorId = plug.vendor;
    info.usbProductId = plug.product;
    connected ? deviceConnected(&info) : deviceDisconnected(&info);
  }

  libusb_context* usb_ = nullptr;
  std::vector<KinectPlug> known_;
  std::atomic<bool> quit_ = false;
  std::thread watch_;
};

}  // namespace
}  // namespace plvo

ONI_EXPORT_DRIVER(plvo::FreenectDriver)
