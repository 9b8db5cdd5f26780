// SPDX-License-Identifier: Apache-2.0
// The stages of a frame whose time is measured.
#pragma once

#include <array>
#include <cstdint>

namespace plvo {

enum class Stage : std::uint8_t { kImage, kPoints, kLines, kMatching, kMotion };
inline constexpr int kStageCount = 5;
using StageTimes = std::array<std::int64_t, kStageCount>;  // ns
const char* to_string(Stage stage);

}  // namespace plvo
