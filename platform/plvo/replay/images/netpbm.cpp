// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/netpbm.hpp"

#include <algorithm>
#include <string_view>

namespace plvo {
namespace {

using Bytes = std::span<const unsigned char>;

constexpr int kMostValue = 65535;
constexpr std::string_view kBlank = " \t\n\v\f\r";

bool is_blank(unsigned char c) { return kBlank.find(static_cast<char>(c)) != kBlank.npos; }

// Takes the next whole number of the header, from 1 to 65535. Skips blanks and comments, which go from # to
// the end of the line. Returns 0 for anything else.
int take_number(Bytes file, std::size_t& at) {
  while (at < file.size() && (is_blank(file[at]) || file[at] == '#')) {
    if (file[at] == '#')
      while (at < file.size() && file[at] != '\n') ++at;
    else
      ++at;
  }
  int number = 0;
  for (; at < file.size() && file[at] >= '0' && file[at] <= '9'; ++at) {
    number = 10 * number + (file[at] - '0');
    if (number > kMostValue) return 0;
  }
  return number;
}

std::size_t bytes_of_number(const NetpbmHeader& header) { return header.most > 255 ? 2 : 1; }

// The bytes of the pixels; empty if the file ends before they do.
Bytes pixels_of(Bytes file, const NetpbmHeader& header) {
  const std::size_t pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  const std::size_t wanted = pixels * (header.grey ? 1 : 3) * bytes_of_number(header);
  return file.size() - header.size < wanted ? Bytes() : file.subspan(header.size, wanted);
}

const Status kCutOff(StatusCode::kDamaged, "damaged or cut off (it has fewer pixels than its header says)");

}  // namespace

bool is_netpbm(Bytes file) {
  return file.size() > 2 && file[0] == 'P' && file[1] >= '1' && file[1] <= '7' && is_blank(file[2]);
}

Status read_netpbm_header(Bytes file, NetpbmHeader& header) {
  header = {};
  if (file[1] != '5' && file[1] != '6')
    return {StatusCode::kUnsupported,
            "of the Netpbm formats only binary PGM and PPM (P5 and P6) are read; "
            "convert it, or save it as PNG"};
  header.grey = file[1] == '5';
  std::size_t at = 2;
  header.width = take_number(file, at);
  header.height = take_number(file, at);
  header.most = take_number(file, at);
  if (header.width == 0 || header.height == 0 || header.most == 0 || at >= file.size() || !is_blank(file[at]))
    return {
        StatusCode::kDamaged,
        "damaged: the header of a PGM or PPM has a width, a height and the value of white, from 1 to 65535"};
  header.size = at + 1;
  return {};
}

Status read_netpbm_rgb(Bytes file, const NetpbmHeader& header, std::span<std::uint8_t> rgb) {
  const Bytes pixels = pixels_of(file, header);
  if (pixels.empty()) return kCutOff;
  const std::size_t bytes = bytes_of_number(header);
  const std::size_t repeated = header.grey ? 3 : 1;
  auto out = rgb.begin();
  for (std::size_t i = 0; i < pixels.size(); i += bytes) {
    const int value = bytes == 2 ? pixels[i] << 8 | pixels[i + 1] : pixels[i];
    const int scaled = (255 * std::min(value, header.most) + header.most / 2) / header.most;
    out = std::fill_n(out, repeated, static_cast<std::uint8_t>(scaled));
  }
  return {};
}

Status read_netpbm_depth(Bytes file, const NetpbmHeader& header, std::span<std::uint16_t> depth) {
  const Bytes pixels = pixels_of(file, header);
  if (pixels.empty()) return kCutOff;
  for (std::size_t i = 0; i < depth.size(); ++i)
    depth[i] = static_cast<std::uint16_t>(pixels[2 * i] << 8 | pixels[2 * i + 1]);
  return {};
}

}  // namespace plvo
