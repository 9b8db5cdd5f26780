// SPDX-License-Identifier: Apache-2.0
// The simulated Kinect's images as libfreenect itself delivers them, and a check whether this machine is fast
// enough for tests of speed.
#pragma once

#include <libfreenect.h>
#include <libfreenect_registration.h>

#include <chrono>
#include <cstdint>
#include <vector>

#include "simulated_kinect.hpp"

namespace plvo_test {

// A sanitizer slows the program down and retains freed memory, so figures of time and memory are meaningless.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kFiguresCount = false;
#elif defined(__has_feature)
inline constexpr bool kFiguresCount = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer);
#else
inline constexpr bool kFiguresCount = true;
#endif

// Time limit of a wait. It detects a hang; it does not judge speed.
inline constexpr double kPatience_s = 120;

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Images that libfreenect, used directly, delivers from the simulated Kinect. They are the reference for the
// output of OpenNI2.
struct Reference {
  std::vector<std::uint8_t> rgb[SimulatedKinect::kPictures];
  std::vector<std::uint16_t> registered[SimulatedKinect::kPictures];
  std::vector<std::uint16_t> raw_to_mm;

  // Index of the image whose Bayer mosaic an RGB image comes from: any reasonable interpolation keeps the
  // values of the green sites.
  static int picture_of(const std::uint8_t* rgb) {
    for (int p = 0; p < SimulatedKinect::kPictures; ++p) {
      int wrong = 0;
      for (int y = 10; y < 470; ++y) {
        for (int x = 10; x < 630; ++x) {
          const int channel = (x + y) % 2 == 0 ? 1 : y % 2 == 0 ? 0 : 2;  // GR over BG
          wrong += rgb[3 * (y * 640 + x) + channel] != SimulatedKinect::bayer(p, x, y);
        }
      }
      if (wrong == 0) return p;
    }
    return -1;
  }

  bool take() {
    freenect_context* context = nullptr;
    freenect_device* device = nullptr;
    if (freenect_init(&context, nullptr) < 0) return false;
    freenect_set_log_level(context, FREENECT_LOG_ERROR);
    freenect_select_subdevices(context, FREENECT_DEVICE_CAMERA);
    if (freenect_open_device(context, &device, 0) < 0) return false;
    freenect_registration registration = freenect_copy_registration(device);
    raw_to_mm.assign(registration.raw_to_mm_shift, registration.raw_to_mm_shift + 2048);
    freenect_destroy_registration(&registration);
    freenect_set_user(device, this);
    freenect_set_depth_mode(device,
                            freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_REGISTERED));
    freenect_set_video_mode(device, freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_RGB));
    freenect_set_depth_callback(device, [](freenect_device* from, void* image, std::uint32_t ticks) {
      auto& self = *static_cast<Reference*>(freenect_get_user(from));
      const auto* depth = static_cast<const std::uint16_t*>(image);
      self.keep(self.registered, picture(ticks - 300000), depth);  // depth is stamped 5 ms later
    });
    freenect_set_video_callback(device, [](freenect_device* from, void* image, std::uint32_t ticks) {
      auto& self = *static_cast<Reference*>(freenect_get_user(from));
      self.keep(self.rgb, picture(ticks), static_cast<const std::uint8_t*>(image));
    });
    freenect_start_depth(device);
    freenect_start_video(device);
    const auto start = std::chrono::steady_clock::now();
    while (!complete() && seconds_since(start) < kPatience_s) {
      timeval wait{0, 10000};
      freenect_process_events_timeout(context, &wait);
    }
    freenect_stop_depth(device);
    freenect_stop_video(device);
    freenect_close_device(device);
    freenect_shutdown(context);
    return complete();
  }

 private:
  static int picture(std::uint32_t ticks) {
    const std::int64_t ns = static_cast<std::int64_t>(ticks - 1000) * 50 / 3;
    return static_cast<int>((ns + SimulatedKinect::kFrame_ns / 2) / SimulatedKinect::kFrame_ns %
                            SimulatedKinect::kPictures);
  }
  template <typename T>
  static void keep(std::vector<T>* images, int at, const T* image) {
    images[at].assign(image, image + SimulatedKinect::kPixels * (sizeof(T) == 1 ? 3 : 1));
  }
  bool complete() const {
    for (int p = 0; p < SimulatedKinect::kPictures; ++p) {
      if (rgb[p].empty() || registered[p].empty()) return false;
    }
    return true;
  }
};

}  // namespace plvo_test
