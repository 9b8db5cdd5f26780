// SPDX-License-Identifier: Apache-2.0
// Live RGB-D sensors, and .oni recordings, through OpenNI2. Colour and depth are paired by their stamps,
// whatever the driver claims about synchronisation; every image is copied into a buffer of the camera's own
// as it arrives, so nothing behind next() touches OpenNI2's memory or takes any. What goes wrong with a
// sensor comes back as a Status within the time limit: no call blocks for longer, no call throws. One thread
// at a time may use a camera. A thread that used one must not end before the last camera of the process is
// closed: OpenNI2 2.2 asks after every thread that ever called it, and crashes on one whose stack is gone.
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
  kAuto,      // by the device where it can, else in software (see software_registration.hpp); .oni files are
              // taken as registered, for the format does not say, and plvo records registered depth
  kSoftware,  // in software, even where the device could
  kNone,      // leave the depth image as it is: only for whoever registers it elsewhere
};

enum class OpenNi2DepthUnit : std::uint8_t { kMillimetre, kTenthMillimetre };

struct OpenNi2Options {
  std::string uri;  // a device's URI, or the path of an .oni file; empty: the first device
  int width = 640;  // of both streams; .oni files keep their own mode
  int height = 480;
  int fps = 30;
  OpenNi2DepthUnit depth_unit =
      OpenNi2DepthUnit::kMillimetre;  // asked for; the other one is taken where it is missing
  OpenNi2Registration registration = OpenNi2Registration::kAuto;
  int timeout_ms = 1000;  // the longest that next() waits
  std::int64_t pair_tolerance_us =
      0;  // largest |colour − depth| of a pair; 0, or more than half a frame: half a frame
  std::optional<CameraModel> model;  // the colour camera's calibration; without it, the field of view serves
  // Of the colour camera's rolling shutter, where there is no model: without it, a Kinect's for a Kinect,
  // else 0.
  std::optional<double> readout_s;
  // The program that plays an .oni file in a process of its own; empty: this one, whose main() must then
  // begin with play_oni_if_asked().
  std::string oni_player;
  int oni_patience_ms = 60000;  // how long it may be silent; it reads a file that lies on this machine
  Log* log = nullptr;           // borrowed; must outlive the camera
};

// OpenNI2's reader of .oni files trusts what is in them, and a damaged one makes it crash. So a recording is
// played by a child process, this program once more, which hands the images over; its crash is a Status here.
// The first thing in main(): the exit code, when this process is that child (argc and argv as main() got
// them), else nothing.
std::optional<int> play_oni_if_asked(int argc, const char* const* argv);

// What happened since open(). Images are counted per stream, frames are pairs.
struct OpenNi2Counters {
  std::uint64_t frames = 0;         // delivered by next()
  std::uint64_t colour_images = 0;  // read from OpenNI2
  std::uint64_t depth_images = 0;
  std::uint64_t dropped_colour =
      0;  // replaced by a newer one before they were read (by OpenNI2's frame index)
  std::uint64_t dropped_depth = 0;
  std::uint64_t unmatched_colour = 0;  // no partner within the tolerance
  std::uint64_t unmatched_depth = 0;
  std::uint64_t missing = 0;      // frames that should lie between delivered ones, judged by their stamps
  std::uint64_t damaged = 0;      // images of a wrong size or format
  std::uint64_t clock_wraps = 0;  // the Kinect's 32-bit counter went round
  std::uint64_t clock_jumps = 0;  // the device's clock stepped for another reason
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

  // What is plugged in and has a driver. Empty with kOk when nothing is; kNotFound when OpenNI2 finds no
  // driver.
  static Status list(std::vector<OpenNi2DeviceInfo>& devices);

  // Opens and starts a device or a recording. kNotFound, kPermission, kBusy, kUnsupported (the mode),
  // kDamaged (the file), kInvalidArgument (the model), each with what to do.
  Status open(const OpenNi2Options& options);
  void close();

  CameraModel model() const override;

  // See RgbdCamera. After kUnplugged, further calls wait for the device (at the same URI, or the same make at
  // another plug) and go on with stamps that continue by the host's clock.
  Status next(RgbdFrame& frame) override;

  OpenNi2Counters counters() const;
  OpenNi2DeviceInfo device() const;
  // Depth comes registered from the device (or the file), not by software_registration.hpp.
  bool registered_by_device() const;
  // Pairs in the recording, or -1 for a live device.
  int recorded_frames() const;

 private:
  friend class OpenNi2Recorder;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
