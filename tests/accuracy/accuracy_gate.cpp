// SPDX-License-Identifier: Apache-2.0
// The accuracy gate: measures rows and compares them with the committed baseline.
// usage: accuracy_gate compare|update recorded|rendered BASELINE [DATA]
//   DATA: the folder of recorded sequences
// Exit code: 0, no row is worse by more than chance; 1, one is, or something cannot be read; 2, wrong usage;
// 77, a recorded sequence is not there.
#include <fmt/core.h>

#include <fstream>

#include "measure.hpp"

namespace plvo::accuracy {
namespace {

struct Kind {
  const char* name;
  Features features;
};
constexpr Kind kBoth = {"both", Features::kBoth};
constexpr Kind kPoints = {"points", Features::kPoints};
constexpr Kind kLines = {"lines", Features::kLines};

Status measure_rows(const Sequence& sequence, std::initializer_list<Kind> kinds, std::vector<Row>& rows) {
  for (const Kind& kind : kinds) {
    Config config;
    config.features = kind.features;
    config.surfaces = kind.features == Features::kBoth;
    std::vector<Figures> starts;
    if (Status status = measure(sequence, config, starts); !status.ok()) return status;
    rows.push_back(summarise(sequence.name + '/' + kind.name, starts));
    const Row& row = rows.back();
    fmt::print(
        "{:40} {:8.2f} mm/s (SD {:.2f}) {:7.3f} deg/s (SD {:.3f})  ln(NEES/6) {:5.2f} (SD {:.2f})  lost {}\n",
        row.name, row.translation_mm_per_s.mean, row.translation_mm_per_s.deviation,
        row.rotation_deg_per_s.mean, row.rotation_deg_per_s.deviation, row.log_nees.mean,
        row.log_nees.deviation, row.lost);
    std::fflush(stdout);
  }
  return {};
}

Status measure_recorded(const std::filesystem::path& data, std::vector<Row>& rows) {
  for (Recorded recorded : recorded_sequences()) {
    Sequence sequence;
    if (Status status = load(data, recorded, sequence); !status.ok()) return status;
    if (Status status = measure_rows(sequence, {kBoth, kPoints, kLines}, rows); !status.ok()) return status;
    if (*recorded.camera_model == '\0') continue;
    // As a user tracks it who does not name the camera: without a model of its shutter and stamps, residuals
    // are larger. A rule that relies on small ones fails here first.
    recorded.camera_model = "";
    if (Status status = load(data, recorded, sequence); !status.ok()) return status;
    sequence.name += "_unnamed_camera";
    if (Status status = measure_rows(sequence, {kBoth}, rows); !status.ok()) return status;
  }
  return {};
}

Status measure_rendered(std::vector<Row>& rows) {
  for (const Rendered& rendered : rendered_sequences()) {
    Sequence sequence;
    if (Status status = render(rendered, sequence); !status.ok()) return status;
    if (Status status = measure_rows(sequence, {kBoth}, rows); !status.ok()) return status;
  }
  return {};
}

int compare(const std::vector<Row>& before, const std::vector<Row>& now, const char* baseline) {
  if (before.size() != now.size()) {
    fmt::print(stderr, "{} has {} rows, {} were measured: build the target update_accuracy\n", baseline,
               before.size(), now.size());
    return 1;
  }
  int worse = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (before[i].name != now[i].name) {
      fmt::print(stderr, "{}: expected the row {}, found {}\n", baseline, now[i].name, before[i].name);
      return 1;
    }
    for (const std::string& what : worse_by_more_than_chance(before[i], now[i])) {
      fmt::print(stderr, "worse by more than chance: {}\n", what);
      ++worse;
    }
  }
  if (worse > 0)
    fmt::print(stderr,
               "Find the cause. If it is the price of something better, say so in the commit and build the "
               "target update_accuracy.\n");
  return worse > 0 ? 1 : 0;
}

int run(const std::string& mode, const std::string& kind, const char* baseline, const std::string& data) {
  std::error_code error;
  if (kind == "recorded" && !std::filesystem::is_directory(data, error)) {
    fmt::print(stderr, "SKIPPED: there are no recorded sequences in '{}'; set PLVO_SHARED\n", data);
    return 77;
  }
  std::vector<Row> now;
  const Status status = kind == "recorded" ? measure_recorded(data, now) : measure_rendered(now);
  if (!status.ok()) {
    fmt::print(stderr, "{}\n", status.message());
    return 1;
  }
  if (mode == "update") {
    std::ofstream file(baseline);
    file << baseline_text(now);
    return file.flush().good() ? 0 : 1;
  }
  std::vector<Row> before;
  if (const Status read = read_baseline(baseline, before); !read.ok()) {
    fmt::print(stderr, "{}\n", read.message());
    return 1;
  }
  return compare(before, now, baseline);
}

}  // namespace
}  // namespace plvo::accuracy

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "", kind = argc > 2 ? argv[2] : "";
  const bool modes = mode == "compare" || mode == "update";
  const bool kinds = (kind == "recorded" && argc == 5) || (kind == "rendered" && argc == 4);
  if (!modes || !kinds) {
    fmt::print(stderr,
               "usage: accuracy_gate compare|update recorded BASELINE DATA\n"
               "       accuracy_gate compare|update rendered BASELINE\n");
    return 2;
  }
  return plvo::accuracy::run(mode, kind, argv[3], argc > 4 ? argv[4] : "");
}
