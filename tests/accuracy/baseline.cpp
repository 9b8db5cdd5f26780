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
    "row,starts,mm_per_s,mm_per_s_sd,mm_per_s_most,mm_per_s_most_sd,deg_per_s,deg_per_s_sd,deg_per_s_most,"
    "deg_per_s_most_sd,log_nees,log_nees_sd,log_nees_most,log_nees_most_sd,lost";
constexpr double kSigmas = 3, kSigmasOfMost = 4;
constexpr double kUnnoticedShare = 0.02, kUnnoticedLogNees = 0.05;

void mean_and_deviation(const std::vector<double>& values, double& mean, double& deviation) {
  const double count = static_cast<double>(values.size());
  double squares = 0;
  mean = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += (value - mean) * (value - mean);
  deviation = values.size() > 1 ? std::sqrt(squares / (count - 1)) : 0;
}

Estimate estimate(std::vector<double> values) {
  Estimate all;
  mean_and_deviation(values, all.mean, all.deviation);
  all.mean_of_most = all.mean;
  all.deviation_of_most = all.deviation;
  if (values.size() < 3 || std::isnan(all.mean)) return all;
  std::sort(values.begin(), values.end());
  const double median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  const bool is_last = values.back() - median > median - values.front();
  values.erase(is_last ? values.end() - 1 : values.begin());
  mean_and_deviation(values, all.mean_of_most, all.deviation_of_most);
  return all;
}

double chance(double sigmas, double deviation, int starts, double unnoticed) {
  return std::max(sigmas * deviation * std::sqrt(2.0 / starts), unnoticed);
}

// before and now: the size of an error, which must not grow.
void compare(const std::string& row, const std::string& figure, double before, double now, double allowed,
             std::vector<std::string>& worse) {
  if (std::isnan(before)) return;
  if (now <= before + allowed) return;  // not of a NaN
  worse.push_back(fmt::format("{}: {} {:.4g} -> {:.4g}; chance explains {:.4g}", row, figure, before, now,
                              before + allowed));
}

// One sentence at most. unnoticed: a change that no user notices.
void compare(const Row& before, const std::string& figure, const Estimate& was, const Estimate& is,
             double unnoticed, std::vector<std::string>& worse) {
  const std::size_t sentences = worse.size();
  compare(before.name, figure, std::abs(was.mean), std::abs(is.mean),
          chance(kSigmas, was.deviation, before.starts, unnoticed), worse);
  if (worse.size() == sentences && before.starts > 2)
    compare(before.name, figure + " of most starts", std::abs(was.mean_of_most), std::abs(is.mean_of_most),
            chance(kSigmasOfMost, was.deviation_of_most, before.starts - 1, unnoticed), worse);
}

std::string columns(const Estimate& e, int digits) {
  return fmt::format("{:.{}f},{:.{}f},{:.{}f},{:.{}f}", e.mean, digits, e.deviation, digits, e.mean_of_most,
                     digits, e.deviation_of_most, digits);
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
    Estimate &mm = row.translation_mm_per_s, &deg = row.rotation_deg_per_s, &nees = row.log_nees;
    const int read =
        std::sscanf(rest.c_str(), "%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%d", &row.starts,
                    &mm.mean, &mm.deviation, &mm.mean_of_most, &mm.deviation_of_most, &deg.mean,
                    &deg.deviation, &deg.mean_of_most, &deg.deviation_of_most, &nees.mean, &nees.deviation,
                    &nees.mean_of_most, &nees.deviation_of_most, &row.lost);
    if (read != 14 || row.starts < 1)
      return {StatusCode::kDamaged,
              fmt::format("{}:{}: expected a name and 14 numbers", path.string(), number)};
    rows.push_back(row);
  }
  return {};
}

std::string baseline_text(const std::vector<Row>& rows) {
  std::string text = std::string(kHeader) + '\n';
  for (const Row& row : rows)
    text += fmt::format("{},{},{},{},{},{}\n", row.name, row.starts, columns(row.translation_mm_per_s, 3),
                        columns(row.rotation_deg_per_s, 4), columns(row.log_nees, 3), row.lost);
  return text;
}

std::vector<std::string> worse_by_more_than_chance(const Row& before, const Row& now) {
  std::vector<std::string> worse;
  compare(before, "mm per second", before.translation_mm_per_s, now.translation_mm_per_s,
          kUnnoticedShare * before.translation_mm_per_s.mean, worse);
  compare(before, "degrees per second", before.rotation_deg_per_s, now.rotation_deg_per_s,
          kUnnoticedShare * before.rotation_deg_per_s.mean, worse);
  compare(before, "|ln(NEES / 6)|", before.log_nees, now.log_nees, kUnnoticedLogNees, worse);
  compare(before.name, "lost frames", before.lost, now.lost,
          kSigmas * std::sqrt(static_cast<double>(before.lost)), worse);
  return worse;
}

}  // namespace plvo::accuracy
