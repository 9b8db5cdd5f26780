// SPDX-License-Identifier: Apache-2.0
// Reads the output of valgrind's callgrind: the number of instructions of each function, including its
// callees.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>

namespace plvo::bench {

struct CallgrindCosts {
  std::uint64_t total = 0;
  std::map<std::string, std::uint64_t> inclusive;  // keyed by the demangled name of the function

  // Sum over all functions whose name starts with `name`; 0 if there are none. Lambdas that the compiler
  // emits as separate functions are excluded: the cost of the enclosing function includes them.
  std::uint64_t of(const std::string& name) const;
};

// Only the first event (Ir) of each line counts. The callees of a recursive function count more than once.
CallgrindCosts read_callgrind(std::istream& file);

}  // namespace plvo::bench
