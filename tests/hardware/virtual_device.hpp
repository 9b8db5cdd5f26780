// SPDX-License-Identifier: Apache-2.0
// A virtual RGB-D sensor: an OpenNI2 driver (libPlvoVirtual.so.0) that OpenNI2 loads like any other, and the
// controls with which a test reproduces the behaviour of real sensors. A test in the same process obtains the
// controls from VirtualDevice::find() after OpenNI2 is initialised. Another process (the command line under
// test) is controlled by the environment:
//   PLVO_VIRTUAL_FRAMES   raw frames (raw_frames.hpp) to serve in order, instead of the test pattern
//   PLVO_VIRTUAL_START    commands (see below), one after the other, separated by ';'
//   PLVO_VIRTUAL_CONTROL  a named pipe; each line that arrives is a command
#pragma once

#include <dlfcn.h>

#include <cstdint>

namespace plvo_test {

// One tick of the sensor. The source fills the images (rows without gaps) and may change the stamps.
struct VirtualTick {
  std::int64_t index = 0;  // 0, 1, 2 … since the device was first opened
  int width = 0, height = 0;
  std::uint8_t* rgb = nullptr;
  std::uint16_t* depth = nullptr;  // in the units of the depth mode
  std::int64_t colour_us = 0;
  std::int64_t depth_us = 0;
  bool to_and_fro = false;  // a source of recorded frames plays them forwards and backwards endlessly
  bool end = false;         // set by the source: neither this tick nor a later one exists
};
using VirtualSource = void (*)(void* cookie, VirtualTick* tick);

// The built-in pattern: every pixel depends on its position and on the tick.
inline std::uint8_t pattern_colour(std::int64_t index, int x, int y, int channel) {
  return static_cast<std::uint8_t>(x * 3 + y * 5 + channel * 85 + index * 7);
}
inline std::uint16_t pattern_depth(std::int64_t index, int x, int y) {
  return static_cast<std::uint16_t>(500 + (x * 7 + y * 3 + index * 11) % 4000);
}
constexpr std::int64_t kPatternDepthOffset_us = 4000;  // offset of the depth stamps from those of colour

// Commands (return 0: done, -1: not understood). Images are counted in ticks of the sensor.
//   plug | unplug            appear to OpenNI2, vanish from it
//   reset                    restores the initial value of all settings below
//   run | stall              both streams
//   stop colour|depth        one stream; run undoes it
//   period N                 microseconds from tick to tick: stamps and pace; default from the video mode
//   allow N                  N more ticks, then none until the next allow: a test that allows one tick after
//                            it has read the last one loses none, whatever the load of the machine
//   clock N                  the next tick is stamped N microseconds, and the clock continues from there
//   wrap N                   stamps wrap as the Kinect's do, first N microseconds from now
//   late N                   depth arrives N ticks after its colour image, with its own stamps
//   shift N                  depth is stamped N microseconds after colour
//   dark 0|1, zero_depth 0|1 the camera is covered; the depth image is empty
//   damage N                 the next N depth images have a wrong size
//   after_end unplug|silence what happens when the source has no more frames (default silence)
//   to_and_fro 0|1           recorded frames are played forwards, backwards, … endlessly
// Only before the device is opened:
//   registration 0|1, mirror_stuck 0|1, no_fov 0|1
class VirtualDevice {
 public:
  // Returns false if OpenNI2 has not loaded the driver (not initialised, or another driver folder).
  bool find() {
    void* library = dlopen("libPlvoVirtual.so.0", RTLD_NOLOAD | RTLD_NOW);
    if (library == nullptr) return false;
    command_ = reinterpret_cast<int (*)(const char*)>(dlsym(library, "plvo_virtual_command"));
    set_source_ = reinterpret_cast<void (*)(VirtualSource, void*)>(dlsym(library, "plvo_virtual_set_source"));
    ticks_ = reinterpret_cast<std::int64_t (*)()>(dlsym(library, "plvo_virtual_ticks"));
    dlclose(library);  // OpenNI2 still holds a reference
    return command_ != nullptr && set_source_ != nullptr && ticks_ != nullptr;
  }
  bool command(const char* text) const { return command_(text) == 0; }
  // null selects the pattern. The device's thread calls the source until the next set_source() returns.
  void set_source(VirtualSource source, void* cookie) const { set_source_(source, cookie); }
  std::int64_t ticks() const { return ticks_(); }

 private:
  int (*command_)(const char*) = nullptr;
  void (*set_source_)(VirtualSource, void*) = nullptr;
  std::int64_t (*ticks_)() = nullptr;
};

}  // namespace plvo_test
