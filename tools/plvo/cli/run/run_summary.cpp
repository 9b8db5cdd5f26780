// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/run_summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "plvo/host/printable.hpp"

namespace plvo::cli {

SummaryRows RunSummary::rows() const {
  SummaryRows rows = {{"frames", fmt::format("{}{}", frames(),
                                             interrupted    ? " (interrupted)"
                                             : failure.ok() ? ""
                                                            : " (ended by an error)")}};
  const auto add = [&rows](const SummaryRows& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  const std::string scaled =
      image.scaled_down_by > 1 ? fmt::format(", scaled down by {}", image.scaled_down_by) : "";
  rows.emplace_back("images", fmt::format("{}x{}{}", image.width, image.height, scaled));
  add(frame_rows());
  rows.emplace_back("damaged", fmt::format("{}", damaged()));
  if (unpaired_images > 0) rows.emplace_back("colour without depth", fmt::format("{}", unpaired_images));
  add(cost_rows());
  if (map) add(map->rows());
  return rows;
}

std::string RunSummary::to_text() const {
  std::string text = printable(camera_name) + '\n' + cli::to_text(rows()) + stage_table();
  if (!evaluation) return text;
  text += "\nagainst the ground truth (plvo eval says more)\n";
  for (const eval::RpeResult& r : evaluation->rpe) {
    const auto& [delta, estimate, still] = r;
    if (estimate.translation_m.count == 0) continue;
    text += fmt::format("RPE over {:<13} {:.1f} mm, {:.3f} deg (zero motion: {:.1f} mm, {:.3f} deg)\n",
                        delta.text, 1e3 * estimate.translation_m.rmse, estimate.rotation_deg.rmse,
                        1e3 * still.translation_m.rmse, still.rotation_deg.rmse);
  }
  text += fmt::format("ATE                    {:.1f} mm\n", 1e3 * evaluation->ate.position_m.rmse);
  if (map && map->ate_m) text += fmt::format("ATE in the map         {:.1f} mm\n", 1e3 * *map->ate_m);
  return text;
}

nlohmann::ordered_json RunSummary::to_json() const {
  nlohmann::ordered_json json = TrackSummary::to_json();
  json["image"] = {
      {"width", image.width}, {"height", image.height}, {"scaled_down_by", image.scaled_down_by}};
  json["unpaired_images"] = unpaired_images;
  json["failure"] = nullptr;
  if (!failure.ok()) json["failure"] = failure.message();
  if (map) json["map"] = map->to_json();
  if (evaluation) json["evaluation"] = eval::to_json(*evaluation);
  return json;
}

}  // namespace plvo::cli
