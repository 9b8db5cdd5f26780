// SPDX-License-Identifier: Apache-2.0
// File format of raw frames for the virtual device: "PLVORAW1", width, height (int32), then for each frame
// the two stamps (int64 microseconds), width·height RGB pixels and width·height depth values in millimetres.
// The byte order is that of the machine.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include "plvo/image/frame.hpp"

namespace plvo_test {

inline constexpr char kRawMagic[8] = {'P', 'L', 'V', 'O', 'R', 'A', 'W', '1'};

class RawWriter {
 public:
  ~RawWriter() { close(); }
  bool open(const char* path, int width, int height) {
    file_ = std::fopen(path, "wb");
    const std::int32_t size[2] = {width, height};
    return file_ != nullptr && std::fwrite(kRawMagic, sizeof(kRawMagic), 1, file_) == 1 &&
           std::fwrite(size, sizeof(size), 1, file_) == 1;
  }
  // The frame must be RGB or BGR with depth in millimetres.
  bool write(const plvo::RgbdFrame& frame) {
    const std::int64_t stamps[2] = {frame.stamp_ns / 1000, frame.depth_stamp_ns / 1000};
    bool good = std::fwrite(stamps, sizeof(stamps), 1, file_) == 1;
    const auto width = static_cast<std::size_t>(frame.colour.width);
    std::vector<std::uint8_t> row(width * 3);
    for (int y = 0; y < frame.colour.height; ++y) {
      std::memcpy(row.data(), frame.colour.data + y * frame.colour.stride_bytes, row.size());
      if (frame.colour.format == plvo::PixelFormat::kBgr8) {
        for (std::size_t x = 0; x < width; ++x) std::swap(row[3 * x], row[3 * x + 2]);
      }
      good = good && std::fwrite(row.data(), row.size(), 1, file_) == 1;
    }
    for (int y = 0; y < frame.depth.height; ++y) {
      good = good && std::fwrite(frame.depth.data + y * frame.depth.stride, width * 2, 1, file_) == 1;
    }
    return good;
  }
  bool close() {
    const bool good = file_ == nullptr || std::fclose(file_) == 0;
    file_ = nullptr;
    return good;
  }

 private:
  std::FILE* file_ = nullptr;
};

class RawReader {
 public:
  ~RawReader() {
    if (file_ != nullptr) std::fclose(file_);
  }
  bool open(const char* path) {
    file_ = std::fopen(path, "rb");
    char magic[sizeof(kRawMagic)];
    std::int32_t size[2];
    if (file_ == nullptr || std::fread(magic, sizeof(magic), 1, file_) != 1 ||
        std::memcmp(magic, kRawMagic, sizeof(magic)) != 0 || std::fread(size, sizeof(size), 1, file_) != 1) {
      return false;
    }
    width_ = size[0];
    height_ = size[1];
    if (width_ <= 0 || height_ <= 0 || std::fseek(file_, 0, SEEK_END) != 0) return false;
    count_ = (std::ftell(file_) - kHeader_bytes) / frame_bytes();
    return std::fseek(file_, kHeader_bytes, SEEK_SET) == 0;
  }
  int width() const { return width_; }
  int height() const { return height_; }
  bool read(std::int64_t& colour_us, std::int64_t& depth_us, std::uint8_t* rgb, std::uint16_t* depth) {
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::int64_t stamps[2];
    if (std::fread(stamps, sizeof(stamps), 1, file_) != 1 || std::fread(rgb, pixels * 3, 1, file_) != 1 ||
        std::fread(depth, pixels * 2, 1, file_) != 1) {
      return false;
    }
    colour_us = stamps[0];
    depth_us = stamps[1];
    return true;
  }

  // Plays the frames forwards, backwards, forwards … endlessly and without their stamps.
  bool read_to_and_fro(std::uint8_t* rgb, std::uint16_t* depth) {
    if (count_ < 2) return false;
    if (at_ + step_ < 0 || at_ + step_ >= count_) step_ = -step_;
    at_ += step_;
    std::int64_t colour_us = 0, depth_us = 0;
    return std::fseek(file_, kHeader_bytes + at_ * frame_bytes(), SEEK_SET) == 0 &&
           read(colour_us, depth_us, rgb, depth);
  }

 private:
  static constexpr long kHeader_bytes = sizeof(kRawMagic) + 2 * sizeof(std::int32_t);
  long frame_bytes() const { return 16 + 5L * width_ * height_; }

  std::FILE* file_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  long count_ = 0, at_ = -1, step_ = 1;
};

}  // namespace plvo_test
