// SPDX-License-Identifier: Apache-2.0
// Implements the driver of virtual_device.hpp.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "plvo/openni2/freenect_driver/driver_stream.hpp"
#include "raw_frames.hpp"
#include "virtual_device.hpp"
#include "virtual_settings.hpp"

namespace plvo_test {
namespace {

constexpr const char* kUri = "virtual://plvo";
constexpr float kFovX_rad = 1.0226f;  // 58.6° × 45.6°, the Kinect's nominal depth camera
constexpr float kFovY_rad = 0.7959f;

constexpr OniVideoMode kDepthModes[] = {
    // The default is QVGA, as it is with PS1080 sensors.
    {ONI_PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 30},   {ONI_PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 60},
    {ONI_PIXEL_FORMAT_DEPTH_1_MM, 640, 480, 30},   {ONI_PIXEL_FORMAT_DEPTH_100_UM, 320, 240, 30},
    {ONI_PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30},
};
constexpr OniVideoMode kColourModes[] = {
    {ONI_PIXEL_FORMAT_RGB888, 320, 240, 30},
    {ONI_PIXEL_FORMAT_RGB888, 320, 240, 60},
    {ONI_PIXEL_FORMAT_RGB888, 640, 480, 30},
};

class Stream : public plvo::DriverStream {
 public:
  using DriverStream::DriverStream;
  void be_mirrored() { mirrored_ = true; }

 private:
  bool set_mirrored(bool /*mirrored*/) override { return !mirrored_; }
};

class Device : public oni::driver::DeviceBase {
 public:
  Device() {
    thread_ = std::thread([this] { run(); });
  }
  ~Device() override {
    quit_ = true;
    thread_.join();
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    const std::lock_guard lock(mutex_);
    plvo::FieldOfView fov{kFovX_rad, kFovY_rad};
    const std::lock_guard settings_lock(settings_mutex);
    if (settings.no_fov) fov = {};
    auto made = sensor == ONI_SENSOR_DEPTH ? std::make_unique<Stream>(sensor, std::span(kDepthModes), fov)
                                           : std::make_unique<Stream>(sensor, std::span(kColourModes), fov);
    if (settings.mirror_stuck) made->be_mirrored();
    (sensor == ONI_SENSOR_DEPTH ? depth_ : colour_) = made.get();
    return made.release();
  }
  void destroyStream(oni::driver::StreamBase* stream) override {
    const std::lock_guard lock(mutex_);
    if (stream == depth_) {
      while (!late_.empty()) {
        depth_->drop(late_.front());
        late_.pop_front();
      }
      depth_ = nullptr;
    }
    if (stream == colour_) colour_ = nullptr;
    delete stream;
  }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    const std::lock_guard lock(settings_mutex);
    return mode == ONI_IMAGE_REGISTRATION_OFF || settings.registration ? TRUE : FALSE;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION ? TRUE : FALSE;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(registration_))
      return ONI_STATUS_NOT_SUPPORTED;
    // libfreenect's own OpenNI2 driver crashes here; tests with this driver must detect the mistake.
    if (depth_ == nullptr) std::abort();
    std::memcpy(&registration_, data, sizeof(registration_));
    return ONI_STATUS_OK;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || *size != sizeof(registration_))
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(data, &registration_, sizeof(registration_));
    return ONI_STATUS_OK;
  }

 private:
  void run() {
    auto due = std::chrono::steady_clock::now();
    while (!quit_) {
      due += std::chrono::microseconds(tick());
      const auto now = std::chrono::steady_clock::now();
      if (due < now) due = now;  // a machine that is too slow skips the lost time instead of catching up
      while (!quit_ && std::chrono::steady_clock::now() < due) {
        std::this_thread::sleep_until(
            std::min(due, std::chrono::steady_clock::now() + std::chrono::milliseconds(10)));
      }
    }
  }
  std::int64_t tick();
  void fill(Settings& now, VirtualTick& tick, Stream& colour);
  void hand_over(Settings& now, const VirtualTick& tick, Stream& stream);

  std::atomic<bool> quit_ = false;
  std::mutex mutex_;
  Stream* colour_ = nullptr;
  Stream* depth_ = nullptr;
  std::deque<OniFrame*> late_;
  std::vector<std::uint8_t> rgb_;
  std::vector<std::uint16_t> z_;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::vector<OniVideoMode> depth_modes_{std::begin(kDepthModes), std::end(kDepthModes)};
  std::vector<OniVideoMode> colour_modes_{std::begin(kColourModes), std::end(kColourModes)};
  OniSensorInfo sensors_[2] = {
      {ONI_SENSOR_DEPTH, static_cast<int>(std::size(kDepthModes)), depth_modes_.data()},
      {ONI_SENSOR_COLOR, static_cast<int>(std::size(kColourModes)), colour_modes_.data()}};
  std::thread thread_;
};

class Driver* driver = nullptr;

class Driver : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}
  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state, void* cookie) override {
    DriverBase::initialize(connected, disconnected, state, cookie);
    std::strcpy(info_.uri, kUri);
    std::strcpy(info_.vendor, "plvo");
    std::strcpy(info_.name, "Virtual RGB-D");
    driver = this;
    start_from_environment();
    bool plugged = false;
    {
      const std::lock_guard lock(settings_mutex);
      plugged = settings.plugged;
    }
    if (plugged) deviceConnected(&info_);
    ready_ = true;
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* /*uri*/, const char* /*mode*/) override {
    const std::lock_guard lock(settings_mutex);
    if (!settings.plugged) {
      getServices().errorLoggerAppend("the virtual device is not plugged in");
      return nullptr;
    }
    return new Device;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {
    quit_ = true;
    if (control_.joinable()) control_.join();
    driver = nullptr;
  }
  void set_plugged(bool plugged) {
    {
      const std::lock_guard lock(settings_mutex);
      if (settings.plugged == plugged) return;
      settings.plugged = plugged;
    }
    if (!ready_) return;  // initialize() reports the current state to OpenNI2
    plugged ? deviceConnected(&info_) : deviceDisconnected(&info_);
  }

 private:
  void start_from_environment();
  void listen(const std::string& pipe);

  OniDeviceInfo info_{};
  std::atomic<bool> ready_ = false;
  std::atomic<bool> quit_ = false;
  std::thread control_;
  std::unique_ptr<RawReader> raw_;
};

bool run_command(const std::string& line) {
  std::istringstream words(line);
  std::string verb, argument;
  words >> verb >> argument;
  if (verb != "plug" && verb != "unplug") return change_settings(verb, argument);
  if (driver != nullptr) driver->set_plugged(verb == "plug");
  return driver != nullptr;
}

void Driver::start_from_environment() {
  if (const char* frames = std::getenv("PLVO_VIRTUAL_FRAMES")) {
    raw_ = std::make_unique<RawReader>();
    if (!raw_->open(frames)) {
      std::fprintf(stderr, "virtual device: cannot read PLVO_VIRTUAL_FRAMES=%s\n", frames);
      std::abort();
    }
    const std::lock_guard lock(settings_mutex);
    settings.cookie = raw_.get();
    settings.source = [](void* cookie, VirtualTick* tick) {
      auto& raw = *static_cast<RawReader*>(cookie);
      tick->end = raw.width() != tick->width || raw.height() != tick->height;
      if (tick->end) return;
      tick->end = tick->to_and_fro ? !raw.read_to_and_fro(tick->rgb, tick->depth)
                                   : !raw.read(tick->colour_us, tick->depth_us, tick->rgb, tick->depth);
    };
  }
  if (const char* start = std::getenv("PLVO_VIRTUAL_START")) {
    std::istringstream lines(start);
    for (std::string line; std::getline(lines, line, ';');) {
      if (!run_command(line)) std::fprintf(stderr, "virtual device: cannot do '%s'\n", line.c_str());
    }
  }
  if (const char* pipe = std::getenv("PLVO_VIRTUAL_CONTROL")) {
    control_ = std::thread([this, path = std::string(pipe)] { listen(path); });
  }
}

void Driver::listen(const std::string& pipe) {
  // Opened for writing as well, so that the pipe has no end of file when a writer leaves.
  const int fd = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  std::string pending;
  while (fd >= 0 && !quit_) {
    pollfd wait{fd, POLLIN, 0};
    if (::poll(&wait, 1, 20) <= 0) continue;
    char text[256];
    const ssize_t got = ::read(fd, text, sizeof(text));
    if (got > 0) pending.append(text, static_cast<std::size_t>(got));
    for (std::size_t end = 0; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1)) {
      const std::string line = pending.substr(0, end);
      if (!run_command(line)) std::fprintf(stderr, "virtual device: cannot do '%s'\n", line.c_str());
    }
  }
  if (fd >= 0) ::close(fd);
}

void Device::fill(Settings& now, VirtualTick& tick, Stream& colour) {
  const std::lock_guard lock(source_mutex);
  {
    const std::lock_guard settings_lock(settings_mutex);
    now.source = settings.source;
    now.cookie = settings.cookie;
  }
  const OniVideoMode mode = colour.mode();
  tick.width = mode.resolutionX;
  tick.height = mode.resolutionY;
  rgb_.resize(static_cast<std::size_t>(tick.width) * static_cast<std::size_t>(tick.height) * 3);
  z_.resize(static_cast<std::size_t>(tick.width) * static_cast<std::size_t>(tick.height));
  tick.rgb = rgb_.data();
  tick.depth = z_.data();
  if (now.source != nullptr) {
    now.source(now.cookie, &tick);
  } else {
    for (int y = 0; y < tick.height; ++y) {
      for (int x = 0; x < tick.width; ++x) {
        const auto i = static_cast<std::size_t>(y * tick.width + x);
        for (int c = 0; c < 3; ++c)
          rgb_[i * 3 + static_cast<std::size_t>(c)] = pattern_colour(tick.index, x, y, c);
        z_[i] = pattern_depth(tick.index, x, y);
      }
    }
  }
  if (now.dark) std::fill(rgb_.begin(), rgb_.end(), std::uint8_t{0});
  if (now.zero_depth) std::fill(z_.begin(), z_.end(), std::uint16_t{0});
}

void Device::hand_over(Settings& now, const VirtualTick& tick, Stream& stream) {
  const bool is_depth = &stream == depth_;
  OniFrame* frame = stream.acquire();
  if (frame == nullptr) return;
  frame->frameIndex = static_cast<int>(tick.index + 1);
  std::int64_t stamp_us = is_depth ? tick.depth_us : tick.colour_us;
  if (now.wraps) stamp_us %= kWrap_us;
  frame->timestamp = static_cast<std::uint64_t>(stamp_us);
  const auto* bytes = is_depth ? reinterpret_cast<const std::uint8_t*>(z_.data()) : rgb_.data();
  const auto pixel =
      static_cast<std::size_t>(plvo::DriverStream::bytes_per_pixel(frame->videoMode.pixelFormat));
  auto* to = static_cast<std::uint8_t*>(frame->data);
  const auto width = static_cast<std::size_t>(tick.width);
  for (std::size_t i = 0; i < width * static_cast<std::size_t>(tick.height); ++i) {
    const std::size_t from = stream.mirrored() ? i + width - 1 - 2 * (i % width) : i;
    std::memcpy(to + i * pixel, bytes + from * pixel, pixel);
  }
  if (is_depth && now.damage > 0) {
    frame->height /= 2;
    --now.damage;
  }
  if (!is_depth) return stream.deliver(frame);
  late_.push_back(frame);
  while (late_.size() > now.late) {
    stream.deliver(late_.front());
    late_.pop_front();
  }
}

// Runs one tick of the sensor; returns the time until the next one.
std::int64_t Device::tick() {
  Settings now;
  {
    const std::lock_guard lock(settings_mutex);
    now = settings;
  }
  const std::lock_guard lock(mutex_);
  // Like a real sensor's clock, this clock runs only while a stream is open: ticks are counted from the first
  // open stream.
  const bool both = colour_ != nullptr && depth_ != nullptr && colour_->running() && depth_->running();
  if (!both || !now.plugged || now.allowed == 0) return 1000;
  const OniVideoMode mode = colour_->mode();
  const std::int64_t period_us = now.period_us > 0 ? now.period_us : 1000000 / mode.fps;
  VirtualTick tick;
  tick.index = now.ticks;
  tick.colour_us = now.clock_us;
  tick.depth_us = now.clock_us + now.shift_us;
  tick.to_and_fro = now.to_and_fro;
  fill(now, tick, *colour_);
  if (tick.end) {
    if (now.unplug_at_end && driver != nullptr) driver->set_plugged(false);
    return 1000;
  }
  const int damage = now.damage;
  if (now.colour_runs) hand_over(now, tick, *colour_);
  if (now.depth_runs) hand_over(now, tick, *depth_);
  const std::lock_guard settings_lock(settings_mutex);
  settings.ticks = now.ticks + 1;
  if (settings.allowed > 0) --settings.allowed;
  // A command may have set the clock in the meantime; its value then takes precedence.
  if (settings.clock_us == now.clock_us) settings.clock_us += period_us;
  if (settings.damage == damage) settings.damage = now.damage;
  return period_us;
}

}  // namespace
}  // namespace plvo_test

extern "C" {
__attribute__((visibility("default"))) int plvo_virtual_command(const char* text) {
  return plvo_test::run_command(text) ? 0 : -1;
}
__attribute__((visibility("default"))) void plvo_virtual_set_source(plvo_test::VirtualSource source,
                                                                    void* cookie) {
  const std::lock_guard source_lock(plvo_test::source_mutex);
  const std::lock_guard lock(plvo_test::settings_mutex);
  plvo_test::settings.source = source;
  plvo_test::settings.cookie = cookie;
}
__attribute__((visibility("default"))) std::int64_t plvo_virtual_ticks() {
  const std::lock_guard lock(plvo_test::settings_mutex);
  return plvo_test::settings.ticks;
}
}

ONI_EXPORT_DRIVER(plvo_test::Driver)
