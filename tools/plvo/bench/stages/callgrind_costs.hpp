// SPDX-License-Identifier: Apache-2.0
// Reads what valgrind's callgrind wrote: how many instructions each function took, its callees included.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>

namespace plvo::bench {

struct CallgrindCosts {
  std::uint64_t total = 0;
  std::map<std::string, std::uint64_t> inclusive;  // by the function's demangled name

  // Of all functions whose name begins so; 0 for none. A lambda that the compiler left a function of its own
  // is in the costs of the one that it stands in.
  std::uint64_t of(const std::string& name) const;
};

// The first event (Ir) of each line counts. A function that calls itself counts what it calls more than once.
CallgrindCosts read_callgrind(std::istream& file);

}  // namespace plvo::bench
