// SPDX-License-Identifier: Apache-2.0
// plvo map: what a saved map holds.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/host/files/map_files.hpp"
#include "plvo/host/printable.hpp"

namespace plvo::cli {
namespace {

constexpr const char* kMapHelp =
    "Examples:\n"
    "  plvo run sequence --map 256 --map-out home.map\n"
    "  plvo map home.map                     keyframes, points, lines, loops, extent, camera\n"
    "  plvo map home.map --json -            the same for programs\n";

struct MapCommandOptions {
  std::string map, json;
};

// The smallest box around points.
struct Box {
  Vector3 low = Vector3::Constant(1e300), high = -low;
  void add(const Vector3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Vector3 size() const { return (high - low).cwiseMax(0); }
};

// The keyframes whose place is known: their number, and the extent of their cameras and points.
struct MapContents {
  std::size_t placed = 0;
  Box cameras, points;
};

MapContents contents_of(const StoredMap& stored) {
  MapContents contents;
  const PoseGraph& graph = stored.map().graph();
  for (std::size_t k = 0; k < graph.size(); ++k) {
    const std::uint16_t slot = graph.slot_at(k);
    if (!graph.is_placed(slot)) continue;
    ++contents.placed;
    const Se3& T = graph.node(slot).T_map_keyframe;
    contents.cameras.add(T.t);
    const MapFeatures features = stored.map().features(slot);
    for (const MapPoint& point : features.points)
      contents.points.add(T * unpack(point, stored.info().pinhole, 1).p);
    for (const MapLine& packed : features.lines) {
      const Line3d line = unpack(packed);
      contents.points.add(T * line.a);
      contents.points.add(T * line.b);
    }
  }
  return contents;
}

std::string extent_text(const Box& box) {
  const Vector3 size = box.size();
  return fmt::format("{:.2f} x {:.2f} x {:.2f} m", size.x(), size.y(), size.z());
}

std::string page_of(const std::string& file, const StoredMap& stored, const MapContents& contents) {
  const MapFileInfo& info = stored.info();
  const Pinhole& p = info.pinhole;
  std::string text = fmt::format("{}: a map in format {}, {:.1f} MB\n\n", printable(file),
                                 MapFileInfo::kVersion, static_cast<double>(info.bytes()) * 1e-6);
  const auto row = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<22} {}\n", name, value);
  };
  row("camera", fmt::format("{}x{}, fx {:.6g} fy {:.6g} cx {:.6g} cy {:.6g}", info.width, info.height, p.fx,
                            p.fy, p.cx, p.cy));
  const std::size_t apart = info.keyframes - contents.placed;
  row("keyframes",
      fmt::format("{}{}", info.keyframes,
                  apart > 0 ? fmt::format(", of which the place of {} is not known", apart) : ""));
  row("points", fmt::format("{}", info.points));
  row("lines", fmt::format("{}", info.lines));
  row("loops", fmt::format("{}", info.loops));
  row("extent of the trajectory", extent_text(contents.cameras));
  row("extent of what is seen", extent_text(contents.points));
  row("to load it", fmt::format("--map {} or more; {:.1f} MB of memory", info.limits().keyframes,
                                static_cast<double>(stored.memory_bytes()) * 1e-6));
  return text;
}

nlohmann::ordered_json extent_json(const Box& box) {
  const Vector3 size = box.size();
  return {size.x(), size.y(), size.z()};
}

nlohmann::ordered_json json_of(const std::string& file, const StoredMap& stored,
                               const MapContents& contents) {
  const MapFileInfo& info = stored.info();
  const Pinhole& p = info.pinhole;
  return {{"map", file},
          {"format", MapFileInfo::kVersion},
          {"bytes", info.bytes()},
          {"camera",
           {{"width", info.width},
            {"height", info.height},
            {"fx", p.fx},
            {"fy", p.fy},
            {"cx", p.cx},
            {"cy", p.cy}}},
          {"keyframes", info.keyframes},
          {"placed_keyframes", contents.placed},
          {"points", info.points},
          {"lines", info.lines},
          {"loops", info.loops},
          {"way_extent_m", extent_json(contents.cameras)},
          {"seen_extent_m", extent_json(contents.points)},
          {"least_capacity", info.limits().keyframes},
          {"memory_bytes", stored.memory_bytes()}};
}

int map_command(const MapCommandOptions& options) {
  StoredMap stored;
  if (Status status = stored.open(options.map); !status.ok()) return fail(status);
  const MapContents contents = contents_of(stored);
  const Status written = write_result(options.json, json_of(options.map, stored, contents),
                                      [&] { return page_of(options.map, stored, contents); });
  return written.ok() ? kExitSuccess : fail(written);
}

}  // namespace

void add_map(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<MapCommandOptions>();
  CLI::App& command = add_command(app, "map", "Show what a saved map holds", kMapHelp);
  require(OptionGroup(command).path("map", options->map, "A file that plvo run --map-out wrote", "FILE"));
  add_json_option(command, options->json);
  on_command(command, exit_code, [options] {
    FileRoles files;
    files.writes("--json", options->json);
    files.reads(options->map);
    files.check();
    return map_command(*options);
  });
}

}  // namespace plvo::cli
