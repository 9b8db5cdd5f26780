// SPDX-License-Identifier: Apache-2.0
// A program with everything that a board's must not have, linked with a C library: linked_symbols.py must
// name it.
#include <cmath>
#include <cstdio>
#include <vector>

#include "plvo/odometry/odometry.hpp"

volatile double number = 0.5;

int main() {
  std::vector<double> values(8, std::atan2(number, 2.0));
  const plvo::Status status = plvo::Odometry().init({}, plvo::CameraModel{});
  std::printf("%g %s\n", values[0], status.message());
  return 0;
}

// What Debian's newlib asks of a system.
extern "C" {
void* __dso_handle = nullptr;
char heap[4096];
void* _sbrk(int) { return heap; }
int _write(int, const char*, int count) { return count; }
int _close(int) { return -1; }
int _fstat(int, void*) { return -1; }
int _isatty(int) { return 1; }
int _lseek(int, int, int) { return 0; }
int _read(int, char*, int) { return 0; }
void _exit(int) {
  for (;;) {
  }
}
int _kill(int, int) { return -1; }
int _getpid() { return 1; }
}
