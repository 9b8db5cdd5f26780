// SPDX-License-Identifier: Apache-2.0
#include "plvo/bare_metal/semihosting.hpp"

namespace plvo::bare_metal {
namespace {

// The used operations of the specification.
enum Operation : std::uint32_t {
  kOpen = 0x01,
  kClose = 0x02,
  kWrite = 0x05,
  kRead = 0x06,
  kExitExtended = 0x20
};
constexpr std::uint32_t kOpenBinary = 1;     // fopen's "rb"
constexpr std::uint32_t kOpenTextWrite = 4;  // fopen's "w"; with the name ":tt" the standard output
constexpr std::uint32_t kApplicationExit = 0x20026;

std::int32_t call(Operation operation, const std::uint32_t* block) {
  register std::uint32_t r0 asm("r0") = operation;
  register const std::uint32_t* r1 asm("r1") = block;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

std::uint32_t address(const void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

std::int32_t open(const char* path, std::uint32_t mode) {
  std::uint32_t length = 0;
  while (path[length] != '\0') ++length;
  const std::uint32_t block[] = {address(path), mode, length};
  return call(kOpen, block);
}

}  // namespace

void write_text(std::string_view text) {
  static std::int32_t output = -1;
  if (output == -1) output = open(":tt", kOpenTextWrite);
  const std::uint32_t block[] = {static_cast<std::uint32_t>(output), address(text.data()),
                                 static_cast<std::uint32_t>(text.size())};
  call(kWrite, block);
}

HostFile::HostFile(const char* path) : handle_(open(path, kOpenBinary)) {}

HostFile::~HostFile() {
  if (!ok()) return;
  const std::uint32_t block[] = {static_cast<std::uint32_t>(handle_)};
  call(kClose, block);
}

bool HostFile::read(std::span<std::byte> bytes) {
  if (!ok()) return false;
  const std::uint32_t block[] = {static_cast<std::uint32_t>(handle_), address(bytes.data()),
                                 static_cast<std::uint32_t>(bytes.size())};
  return call(kRead, block) == 0;  // the result is the number of bytes not read
}

void exit(int code) {
  const std::uint32_t block[] = {kApplicationExit, static_cast<std::uint32_t>(code)};
  call(kExitExtended, block);
  for (;;) asm volatile("wfi");
}

}  // namespace plvo::bare_metal
