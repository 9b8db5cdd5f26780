// SPDX-License-Identifier: Apache-2.0
// Base64 (RFC 4648), to embed images in a page.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace plvo::report {

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace plvo::report
