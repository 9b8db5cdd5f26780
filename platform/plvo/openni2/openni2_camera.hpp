// SPDX-License-Identifier: Apache-2.0
// Live RGB-D sensors and .oni recordings through OpenNI2. Colour and depth are paired by their stamps,
// independent of the driver's synchronisation. Every image is copied into a buffer of the camera when it
// arrives, so the frames of next() do not refer to OpenNI2's memory, and next() allocates none. Errors of a
// sensor are returned as a Status within the time limit: no call blocks longer, and no call throws. Only one
// thread at a time may use a camera. A thread that used one must not end before the last camera of the
// process is closed: OpenNI2 2.2 accesses every thread that ever called it, and crashes if the stack of one
// is gone.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/hal/log.hpp"
#include "plvo/hal/rgbd_camera.hpp"

namespace plvo {

struct OpenNi2DeviceInfo {
  std::string uri;
  std::string vendor;
  std::string name;
  std::uint16_t usb_vendor_id = 0;
  std::uint16_t usb_product_id = 0;
};

enum class OpenNi2Registration : std::uint8_t {
  kAuto,  // by the device if it can, else in software (see software_registration.hpp); .oni files are assumed
          // registered, since the format does not tell and plvo records registered depth
  kSoftware,  // in software, even if the device can
  kNone,      // unregistered depth, for callers that register it themselves
};

enum class OpenNi2DepthUnit : std::uint8_t { kMillimetre, kTenthMillimetre };

struct OpenNi2Options {
  std::string uri;  // a device's URI, or the path of an .oni file; empty: the first device
  int width = 640;  // width of both streams; ignored for .oni files
  int height = 480;
  int fps = 30;
  OpenNi2DepthUnit depth_unit =
      OpenNi2DepthUnit::kMillimetre;  // preferred unit; the other one is used if it is not available
  OpenNi2Registration registration = OpenNi2Registration::kAuto;
  int timeout_ms = 1000;  // longest wait of next()
  std::int64_t pair_tolerance_us =
      0;  // largest |colour − depth| of the stamps of a pair; 0, or more than half a frame: half a frame
  std::optional<CameraModel>
      model;  // calibration of the colour camera; without it, the model is derived from the field of view
  // Read-out time of the colour camera's rolling shutter, used if there is no model. Default: the value of
  // the Kinect for a Kinect, else 0.
  std::optional<double> readout_s;
  // The program that plays an .oni file in a child process; empty: this program, whose main() must then begin
  // with play_oni_if_asked().
  std::string oni_player;
  int oni_patience_ms = 60000;  // longest silence of the child, which reads a local file
  Log* log = nullptr;           // borrowed; must outlive the camera
};

// Must be called first in main(), with its argc and argv. OpenNI2's reader of .oni files does not validate
// them, and a damaged file makes it crash. A recording is therefore played by a child process, another
// instance of this program, which sends the images; its crash becomes a Status. Returns the exit code if this
// process is that child, else nullopt.
std::optional<int> play_oni_if_asked(int argc, const char* const* argv);

// Counters since open(). Images are counted per stream; frames are pairs.
struct OpenNi2Counters {
  std::uint64_t frames = 0;         // delivered by next()
  std::uint64_t colour_images = 0;  // read from OpenNI2
  std::uint64_t depth_images = 0;
  std::uint64_t dropped_colour =
      0;  // replaced by a newer image before they were read (according to OpenNI2's frame index)
  std::uint64_t dropped_depth = 0;
  std::uint64_t unmatched_colour = 0;  // no partner within the tolerance
  std::uint64_t unmatched_depth = 0;
  std::uint64_t missing = 0;      // frames missing between delivered ones, according to the stamps
  std::uint64_t damaged = 0;      // images of a wrong size or format
  std::uint64_t clock_wraps = 0;  // wraps of the Kinect's 32-bit counter
  std::uint64_t clock_jumps = 0;  // other steps of the device's clock
  std::uint64_t timeouts = 0;
  std::uint64_t unplugged = 0;
  std::uint64_t replugged = 0;
};

class OpenNi2Camera final : public RgbdCamera {
 public:
  OpenNi2Camera();
  ~OpenNi2Camera();
  OpenNi2Camera(const OpenNi2Camera&) = delete;
  OpenNi2Camera& operator=(const OpenNi2Camera&) = delete;

  // Lists the connected devices that have a driver. Returns kOk with an empty list if there is none, and
  // kNotFound if OpenNI2 finds no driver.
  static Status list(std::vector<OpenNi2DeviceInfo>& devices);

  // Opens and starts a device or a recording. Returns kNotFound, kPermission, kBusy, kUnsupported (the mode),
  // kDamaged (the file) or kInvalidArgument (the model), each with a remedy in its message.
  Status open(const OpenNi2Options& options);
  void close();

  CameraModel model() const override;

  // See RgbdCamera. After kUnplugged, further calls wait for the device (at the same URI, or one of the same
  // make at another port). The stamps then continue by the host's clock.
  Status next(RgbdFrame& frame) override;

  OpenNi2Counters counters() const;
  OpenNi2DeviceInfo device() const;
  // True if depth is registered by the device (or in the file), not by software_registration.hpp or the
  // caller.
  bool registered_by_device() const;
  // Number of pairs in the recording, or -1 for a live device.
  int recorded_frames() const;

 private:
  friend class OpenNi2Recorder;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
