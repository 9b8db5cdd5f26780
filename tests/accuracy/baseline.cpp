// SPDX-License-Identifier: Apache-2.0
#include "baseline.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace plvo::accuracy {
namespace {

constexpr const char* kHeader =
    "row,starts,mm_per_s,mm_per_s_sd,deg_per_s,deg_per_s_sd,log_nees,log_nees_sd,lost";
constexpr double kSigmas = 3;
constexpr double kUnnoticedShare = 0.02, kUnnoticedLogNees = 0.05;

Estimate estimate(const std::vector<double>& values) {
  const double count = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() > 1 ? std::sqrt(squares / (count - 1)) : 0};
}

double chance(const Estimate& before, int starts, double unnoticed) {
  return std::max(kSigmas * before.deviation * std::sqrt(2.0 / starts), unnoticed);
}
double chance_of_error(const Estimate& before, int starts) {
  return chance(before, starts, kUnnoticedShare * before.mean);
}

// before and now: the size of an error, which must not grow.
void compare(const Row& row, const char* figure, double before, double now, double allowed,
             std::vector<std::string>& worse) {
  if (std::isnan(before)) return;
  if (now <= before + allowed) return;  // not of a NaN
  worse.push_back(fmt::format("{}: {} {:.4g} -> {:.4g}; chance explains {:.4g}", row.name, figure, before,
                              now, before + allowed));
}

}  // namespace

Row summarise(const std::string& name, const std::vector<Figures>& starts) {
  std::vector<double> translation, rotation, log_nees;
  Row row;
  row.name = name;
  row.starts = static_cast<int>(starts.size());
  for (const Figures& start : starts) {
    translation.push_back(start.translation_mm_per_s);
    rotation.push_back(start.rotation_deg_per_s);
    log_nees.push_back(std::log(start.nees / 6));
    row.lost += start.lost;
  }
  row.translation_mm_per_s = estimate(translation);
  row.rotation_deg_per_s = estimate(rotation);
  row.log_nees = estimate(log_nees);
  return row;
}

Status read_baseline(const std::filesystem::path& path, std::vector<Row>& rows) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return {StatusCode::kNotFound, fmt::format("cannot read {}", path.string())};
  if (line != kHeader)
    return {StatusCode::kDamaged, fmt::format("{}:1: expected the columns {}", path.string(), kHeader)};
  rows.clear();
  for (int number = 2; std::getline(file, line); ++number) {
    Row row;
    std::istringstream words(line);
    std::string rest;
    std::getline(words, row.name, ',');
    std::getline(words, rest);
    const int read = std::sscanf(rest.c_str(), "%d,%lf,%lf,%lf,%lf,%lf,%lf,%d", &row.starts,
                                 &row.translation_mm_per_s.mean, &row.translation_mm_per_s.deviation,
                                 &row.rotation_deg_per_s.mean, &row.rotation_deg_per_s.deviation,
                                 &row.log_nees.mean, &row.log_nees.deviation, &row.lost);
    if (read != 8 || row.starts < 1)
      return {StatusCode::kDamaged,
              fmt::format("{}:{}: expected a name and 8 numbers", path.string(), number)};
    rows.push_back(row);
  }
  return {};
}

std::string baseline_text(const std::vector<Row>& rows) {
  std::string text = std::string(kHeader) + '\n';
  for (const Row& row : rows) {
    text += fmt::format("{},{},{:.3f},{:.3f},{:.4f},{:.4f},{:.3f},{:.3f},{}\n", row.name, row.starts,
                        row.translation_mm_per_s.mean, row.translation_mm_per_s.deviation,
                        row.rotation_deg_per_s.mean, row.rotation_deg_per_s.deviation, row.log_nees.mean,
                        row.log_nees.deviation, row.lost);
  }
  return text;
}

std::vector<std::string> worse_by_more_than_chance(const Row& before, const Row& now) {
  std::vector<std::string> worse;
  compare(now, "mm per second", before.translation_mm_per_s.mean, now.translation_mm_per_s.mean,
          chance_of_error(before.translation_mm_per_s, before.starts), worse);
  compare(now, "degrees per second", before.rotation_deg_per_s.mean, now.rotation_deg_per_s.mean,
          chance_of_error(before.rotation_deg_per_s, before.starts), worse);
  compare(now, "|ln(NEES / 6)|", std::abs(before.log_nees.mean), std::abs(now.log_nees.mean),
          chance(before.log_nees, before.starts, kUnnoticedLogNees), worse);
  compare(now, "lost frames", before.lost, now.lost, kSigmas * std::sqrt(static_cast<double>(before.lost)),
          worse);
  return worse;
}

}  // namespace plvo::accuracy
