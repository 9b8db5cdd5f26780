// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/difficulties.hpp"

#include <array>

namespace plvo {
namespace {

struct NamedDifficulty {
  const char* name;
  void (*add)(Difficulties&);
};

constexpr std::array kDifficulties = {
    NamedDifficulty{"board", [](Difficulties& d) { d.board.emplace(); }},
    NamedDifficulty{"person", [](Difficulties& d) { d.person.emplace(); }},
    NamedDifficulty{"person-ahead", [](Difficulties& d) { d.person.emplace().ahead = true; }},
    NamedDifficulty{"mirror", [](Difficulties& d) { d.mirror = true; }},
    NamedDifficulty{"bumper", [](Difficulties& d) { d.bumper_share = 0.15; }},
    NamedDifficulty{"dots", [](Difficulties& d) { d.dots_share = 0.015; }},
    NamedDifficulty{"clock", [](Difficulties& d) { d.clock = true; }},
    NamedDifficulty{"comb", [](Difficulties& d) { d.comb = true; }},
    NamedDifficulty{"frozen-depth", [](Difficulties& d) { d.frozen_depth = 20; }},
    NamedDifficulty{"repeated-frames", [](Difficulties& d) { d.repeated_frames = true; }},
};

Status refuse(const char* what) { return Status(StatusCode::kInvalidArgument, "simulator: ").append(what); }

bool is_interval(double from_s, double to_s) { return from_s >= 0 && to_s > from_s && to_s < 1e6; }

}  // namespace

Status Difficulties::validate() const {
  if (board) {
    if (!is_interval(board->from_s, board->to_s))
      return refuse("the board must appear at 0 seconds or later and disappear after that");
    if (!(board->distance_m >= 0.2 && board->distance_m <= 10))
      return refuse("the distance of the board must lie in 0.2 ... 10 metres");
    if (!(board->share > 0 && board->share <= 1)) return refuse("the share of the board must lie in 0 ... 1");
    if (!(board->first_column >= -2 && board->first_column <= 2))
      return refuse("the first column of the board must lie in -2 ... 2 image widths");
    if (!(board->speed_mps >= -5 && board->speed_mps <= 5))
      return refuse("the speed of the board must lie in -5 ... 5 metres per second");
  }
  if (person) {
    if (!is_interval(person->from_s, person->to_s))
      return refuse("the person must appear at 0 seconds or later and disappear after that");
    if (!(person->distance_m >= 0.5 && person->distance_m <= 10))
      return refuse("the distance of the person must lie in 0.5 ... 10 metres");
    if (!(person->speed_mps > 0 && person->speed_mps <= 5))
      return refuse("the speed of the person must lie in 0 ... 5 metres per second");
  }
  if (!(bumper_share >= 0 && bumper_share <= 0.5))
    return refuse("the share of the bumper must lie in 0 ... 0.5");
  if (!(dots_share >= 0 && dots_share <= 1)) return refuse("the share of the dots must lie in 0 ... 1");
  if (frozen_depth && *frozen_depth < 0) return refuse("depth must freeze at frame 0 or later");
  return {};
}

Status add_difficulty(std::string_view name, Difficulties& difficulties) {
  for (const NamedDifficulty& candidate : kDifficulties) {
    if (name == candidate.name) {
      candidate.add(difficulties);
      return {};
    }
  }
  Status status(StatusCode::kInvalidArgument, "there is no difficulty \"");
  status.append(name.substr(0, 40)).append("\"; choose from:");
  for (const NamedDifficulty& candidate : kDifficulties) status.append(" ").append(candidate.name);
  return status;
}

std::vector<std::string> difficulty_names() {
  std::vector<std::string> names;
  for (const NamedDifficulty& difficulty : kDifficulties) names.emplace_back(difficulty.name);
  return names;
}

}  // namespace plvo
