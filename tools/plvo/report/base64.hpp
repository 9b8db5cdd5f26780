// SPDX-License-Identifier: Apache-2.0
// RFC 4648: bytes as text, so that a picture can live inside a page.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace plvo::report {

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace plvo::report
