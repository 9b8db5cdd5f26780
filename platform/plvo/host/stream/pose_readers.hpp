// SPDX-License-Identifier: Apache-2.0
// Who listens to a pose stream, and who has to go when somebody new comes and the places are taken. A reader
// says nothing, so all that tells a robot from a connection that somebody forgot is whether it reads.
//
// The rule. kMaxReaders places in all, kMaxPerAddress of them for one address. When the address of a newcomer
// has its share, one of the same address must go; when all places are taken, one of any address:
//   1. the one that has kept lines waiting for longest, counted in lines written meanwhile;
//   2. if all keep up, the oldest of those that have not taken kProvenBytes yet: what systems hold back for a
//      program that does not read is less, so that whoever took more does read;
//   3. if all are proven readers, the newcomer.
// So idle connections can only push out each other, and never a reader that has been served for a while (ten
// seconds at 30 poses/s).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/host/stream/bounded_writer.hpp"

namespace plvo {

class PoseReaders {
 public:
  static constexpr std::size_t kMaxReaders = 32;
  static constexpr std::size_t kMaxPerAddress = 16;
  static constexpr std::size_t kBufferBytes = 64 * 1024;  // of one reader: about two seconds of poses
  static constexpr std::uint64_t kProvenBytes = 256 * 1024;

  // Takes the socket over. address: of its machine; empty for a Unix socket, where all readers are of one
  // machine and share kMaxReaders. False, and the socket is closed, when there is no place for it.
  bool add_socket(int descriptor, const std::string& address);
  // A descriptor that stays its owner's, such as standard output; it keeps its place.
  void add_borrowed(int descriptor);

  // line: with its newline. Forgets the readers that are gone.
  void write(std::string_view line);
  // Gives each a moment for its last lines, and lets all go.
  void close();

  std::size_t count() const { return readers_.size(); }
  std::uint64_t dropped_lines() const;
  std::uint64_t turned_out() const { return turned_out_; }  // for a newcomer, or as one without a place

 private:
  struct Reader {
    BoundedWriter writer;
    std::string address;
    bool borrowed = false;
    std::uint64_t waiting_lines = 0;  // written since everything was sent for the last time
  };
  bool make_room(const std::string& address);
  void forget(std::size_t index);

  std::vector<Reader> readers_;  // the oldest first
  std::uint64_t dropped_by_gone_ = 0;
  std::uint64_t turned_out_ = 0;
};

}  // namespace plvo
