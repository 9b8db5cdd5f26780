// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/chunked_file.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace plvo {

namespace fs = std::filesystem;

Status ChunkedFile::open_file(const fs::path& path) {
  path_ = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return {StatusCode::kNotFound, fmt::format("{} is not there", path.string())};
  if (!fs::is_regular_file(status))
    return {StatusCode::kInvalidArgument, fmt::format("{} is not a regular file", path.string())};
  file_bytes_ = fs::file_size(path, error);
  file_.open(path, std::ios::binary);
  if (error || !file_) return {StatusCode::kPermission, fmt::format("{} cannot be read", path.string())};
  return check_beginning();
}

Status ChunkedFile::scan(const Take& take) {
  failure_ = {};
  broken_chunks_ = large_chunks_ = 0;
  take_ = &take;
  Source file;
  file.read = [this](std::uint64_t position, std::span<unsigned char> bytes) {
    return read_file(position, bytes);
  };
  const End end = scan_records(file, first_record(), file_bytes_, nullptr);
  take_ = nullptr;
  if (failure_.ok()) set_remark(damage(end));
  return failure_;
}

Status ChunkedFile::cannot_be_read_any_more() const {
  return {StatusCode::kIo, fmt::format("{} cannot be read any more", path_.string())};
}

bool ChunkedFile::read_file(std::uint64_t position, std::span<unsigned char> bytes) {
  if (position > file_bytes_ || bytes.size() > file_bytes_ - position) return false;
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(file_);
}

ChunkedFile::End ChunkedFile::scan_chunk(Source& file, const Chunk& chunk, bool whole) {
  // In an uncompressed chunk, the messages before a cut can be read in place.
  if (chunk.compression == Compression::kNone) {
    const std::uint64_t bytes = std::min(chunk.bytes, file_bytes_ - chunk.position);
    return scan_records(file, chunk.position, chunk.position + bytes, &whole);
  }
  if (!whole) return End::kCut;
  if (std::max(chunk.bytes, chunk.unpacked) > kMaxPiece) {
    ++large_chunks_;
    return End::kWhole;
  }
  Unpacked& place = next_in_cache();
  if (!unpack(chunk, place.bytes).ok()) return End::kBroken;
  Source unpacked;
  unpacked.unpacked = &chunk;
  unpacked.read = [&bytes = place.bytes](std::uint64_t position, std::span<unsigned char> out) {
    if (position > bytes.size() || out.size() > bytes.size() - position) return false;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(position), out.size(), out.begin());
    return true;
  };
  const End end = scan_records(unpacked, 0, place.bytes.size(), &whole);
  place.chunk = unpacked.number;
  return end == End::kWhole ? End::kWhole : End::kBroken;
}

void ChunkedFile::take_message(Source& source, std::size_t topic, std::int64_t received_ns,
                               std::uint64_t position, std::uint64_t bytes) {
  Found found;
  found.topic = topic;
  found.received_ns = received_ns;
  found.place.position = position;
  found.place.bytes = static_cast<std::uint32_t>(std::min<std::uint64_t>(bytes, UINT32_MAX));
  found.read = [&](std::span<unsigned char> out) { return source.read(position, out); };
  found.keep = [&] {
    if (source.unpacked != nullptr && source.number == BagMessage::kInFile) {
      source.number = chunks_.size();
      chunks_.push_back(*source.unpacked);
    }
    found.place.chunk = source.number;
  };
  failure_ = (*take_)(found);
}

ChunkedFile::Unpacked& ChunkedFile::next_in_cache() {
  Unpacked& place = cache_[next_in_cache_];
  next_in_cache_ = 1 - next_in_cache_;
  place.chunk = BagMessage::kInFile;
  return place;
}

Status ChunkedFile::unpack(const Chunk& chunk, std::vector<unsigned char>& bytes) {
  resize_anew(packed_, static_cast<std::size_t>(chunk.bytes));
  if (!read_file(chunk.position, packed_)) return cannot_be_read_any_more();
  resize_anew(bytes, static_cast<std::size_t>(chunk.unpacked));
  return unpack_chunk(chunk.compression, packed_, bytes);
}

Status ChunkedFile::read_stored(const BagMessage& place, std::span<unsigned char> bytes) {
  if (place.chunk == BagMessage::kInFile)
    return read_file(place.position, bytes) ? Status() : cannot_be_read_any_more();
  auto cached = std::find_if(cache_.begin(), cache_.end(),
                             [&](const Unpacked& unpacked) { return unpacked.chunk == place.chunk; });
  if (cached == cache_.end()) {
    cached = cache_.begin() + static_cast<std::ptrdiff_t>(next_in_cache_);
    if (Status status = unpack(chunks_[place.chunk], next_in_cache().bytes); !status.ok()) return status;
    cached->chunk = place.chunk;
  }
  std::copy_n(cached->bytes.begin() + static_cast<std::ptrdiff_t>(place.position), bytes.size(),
              bytes.begin());
  return {};
}

void ChunkedFile::release() {
  for (Unpacked& unpacked : cache_) unpacked = {};
  std::vector<unsigned char>().swap(packed_);
}

std::string ChunkedFile::damage(End end) const {
  std::string sentences;
  const std::string name = path_.filename().string();
  const auto add = [&sentences](const std::string& sentence) {
    sentences += (sentences.empty() ? "" : "; ") + sentence;
  };
  if (end == End::kBroken && is_closed())
    add(fmt::format("{} is damaged from byte {} on; what lies before is used", name, stopped_at_));
  else if (end != End::kWhole || !is_closed())
    add(fmt::format("{} is cut short; what lies before byte {} is used", name,
                    end == End::kWhole ? file_bytes_ : stopped_at_));
  if (broken_chunks_ > 0) add(fmt::format("{} damaged pieces of {} are left out", broken_chunks_, name));
  if (large_chunks_ > 0)
    add(fmt::format(
        "{} compressed pieces of {} are larger than the {} MiB that are read, and left out: store it "
        "without compression",
        large_chunks_, name, kMaxPiece >> 20));
  return sentences;
}

}  // namespace plvo
