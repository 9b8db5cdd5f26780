// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/lighting/lighting_table.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace plvo::bench {
namespace {

using Results = std::map<std::pair<std::string, std::string>, Result>;  // key: sequence, system
using Value = double (*)(const Result&);

double drift_mm(const Result& r) { return r.estimate.ted_mm; }
double path_m(const Result& r) { return r.path_m; }
double rpe_mm(const Result& r) { return r.estimate.rpe_second_mm; }
double rpe_identity_mm(const Result& r) { return r.identity.rpe_second_mm; }

struct SiteLight {
  std::string site, light;
  bool operator==(const SiteLight&) const = default;
};

template <typename T>
void add_once(std::vector<T>& list, const T& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

double median_over_seeds(const std::vector<LitSequence>& sequences, const SiteLight& place,
                         const std::string& system, const Results& results, Value value) {
  std::vector<double> values;
  for (const LitSequence& sequence : sequences) {
    const auto found = results.find({sequence.name, system});
    if (SiteLight{sequence.site, sequence.light} == place && found != results.end())
      values.push_back(value(found->second));
  }
  return median(values);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(values.size());
}

struct Column {
  std::string header, system;
  Value value = nullptr;
};

// Returns a row for each site and light, then for each light the mean over the sites (NaN if a value is
// missing), then the ratio of these means.
Table make_table(const std::vector<LitSequence>& sequences, const std::vector<Column>& columns,
                 const Results& results) {
  Table table;
  table.header = {"site", "light"};
  table.text_columns = 2;
  for (const Column& column : columns) table.header.push_back(column.header);
  std::vector<SiteLight> places;
  std::vector<std::string> lights;
  for (const LitSequence& sequence : sequences) {
    add_once(places, SiteLight{sequence.site, sequence.light});
    add_once(lights, sequence.light);
  }
  std::map<std::string, std::vector<std::vector<double>>> values;  // light → column → sites
  for (const SiteLight& place : places) {
    std::vector<std::string> row = {place.site, place.light};
    values[place.light].resize(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double value = median_over_seeds(sequences, place, columns[i].system, results, columns[i].value);
      values[place.light][i].push_back(value);
      row.push_back(cell(value, 1));
    }
    table.rows.push_back(row);
  }
  for (const std::string& light : lights) {
    std::vector<std::string> row = {"mean", light};
    for (const auto& column : values[light]) row.push_back(cell(mean(column), 1));
    table.rows.push_back(row);
  }
  if (lights.size() == 2) {
    std::vector<std::string> row = {"mean", lights[1] + " / " + lights[0]};
    for (std::size_t i = 0; i < columns.size(); ++i)
      row.push_back(cell(mean(values[lights[1]][i]) / mean(values[lights[0]][i]), 2));
    table.rows.push_back(row);
  }
  return table;
}

// Returns every result of each sequence and system, unrounded.
Table exact_table(const std::vector<LitSequence>& sequences, const std::vector<std::string>& systems,
                  const Results& results) {
  constexpr int kDecimals = 6;
  Table table;
  table.header = {"site",          "light",        "seed",          "system",  "frames",
                  "lost",          "path_m",       "ted_mm",        "ted_deg", "rpe_s_mm",
                  "rpe_s_deg",     "rpe_frame_mm", "rpe_frame_deg", "ate_mm",  "identity_rpe_s_mm",
                  "cpu_median_ms", "cpu_p95_ms"};
  for (const LitSequence& sequence : sequences) {
    for (const std::string& system : systems) {
      const auto found = results.find({sequence.name, system});
      if (found == results.end()) continue;
      const Result& r = found->second;
      const Accuracy& a = r.estimate;
      std::vector<std::string> row = {sequence.site, sequence.light,           std::to_string(sequence.seed),
                                      system,        std::to_string(r.frames), std::to_string(r.lost)};
      for (const double value :
           {r.path_m, a.ted_mm, a.ted_deg, a.rpe_second_mm, a.rpe_second_deg, a.rpe_frame_mm, a.rpe_frame_deg,
            a.ate_mm, r.identity.rpe_second_mm, r.cpu_median_ms, r.cpu_p95_ms})
        row.push_back(cell(value, kDecimals));
      table.rows.push_back(row);
    }
  }
  return table;
}

}  // namespace

Report lighting_report(const std::vector<LitSequence>& sequences, const std::vector<std::string>& systems,
                       const std::vector<Result>& all) {
  Results results;
  for (const Result& result : merge_repeats(all)) results[{result.sequence, result.system}] = result;
  std::vector<Column> drift = {{"path m", systems.front(), path_m}};
  std::vector<Column> rpe = {{kIdentity, systems.front(), rpe_identity_mm}};
  for (const std::string& system : systems) {
    drift.push_back({system, system, drift_mm});
    rpe.push_back({system, system, rpe_mm});
  }
  Report report;
  report.name = "lighting";
  report.title = "Closed sequences under two lights";
  report.table = make_table(sequences, drift, results);
  report.more = {make_table(sequences, rpe, results)};
  report.exact = exact_table(sequences, systems, results);
  report.notes = {
      "First table: end-point drift (TED) in mm; second: RPE per second, RMSE in mm. Medians over the seeds; "
      "simulated sequences that end where they began. A lost frame keeps the last good pose and counts."};
  return report;
}

}  // namespace plvo::bench
