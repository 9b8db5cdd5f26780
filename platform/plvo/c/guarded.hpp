// SPDX-License-Identifier: Apache-2.0
// Turns exceptions of the modules that use the heap and files into a status before they reach C.
#pragma once

#include <exception>
#include <new>

#include "plvo/c/boundary.hpp"

namespace plvo::c {

template <typename Work>
plvo_status guarded(Work work) noexcept {
  try {
    return to_c(work());
  } catch (const std::bad_alloc&) {
    return to_c(Status(StatusCode::kOutOfMemory, "the machine has no memory left"));
  } catch (const std::exception& error) {
    return to_c(Status(StatusCode::kIo, error.what()));
  }
}

inline Status missing(const char* what) {
  return Status(StatusCode::kInvalidArgument, what).append(" is NULL");
}

}  // namespace plvo::c
