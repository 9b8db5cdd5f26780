// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "plvo/host/files/line_file.hpp"
#include "plvo/report/base64.hpp"
#include "plvo/report/drawing.hpp"
#include "plvo/report/page.hpp"
#include "plvo/report/palette.hpp"

namespace plvo::report {
namespace {

using Json = nlohmann::ordered_json;

// Five significant digits exceed the resolution of a chart and take a third of the bytes.
double brief(double value) {
  if (!std::isfinite(value) || value == 0) return 0;
  const double scale = std::pow(10.0, 4 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

class Writer {
 public:
  explicit Writer(const ReportInput& input) : input_(input) {
    if (!input.series.empty()) {
      origin_ns_ = input.series.front().stamp_ns;
    } else if (!input.trajectory.poses.empty()) {
      origin_ns_ = input.trajectory.poses.front().stamp_ns;
    }
  }

  Json data() const {
    Json json = {{"title", input_.title}, {"subtitle", input_.subtitle}};
    json["trajectory"] = trajectory();
    if (!input_.scene.points.empty() || !input_.scene.lines.empty()) json["scene"] = scene();
    if (!input_.series.empty()) json["series"] = series();
    if (!input_.frames.empty()) {
      json["frames"] = frames();
      json["depth_range"] = {kDepthNear_m, kDepthFar_m};
    }
    json["summary"] = Json::array();
    for (const auto& [name, value] : input_.summary) json["summary"].push_back({name, value});
    if (json["summary"].empty()) json.erase("summary");
    if (input_.evaluation) add_evaluation(json, *input_.evaluation);
    return json;
  }

 private:
  double seconds(std::int64_t stamp_ns) const { return static_cast<double>(stamp_ns - origin_ns_) * 1e-9; }

  static void append_position(Json& list, const Vector3& p) {
    for (int k = 0; k < 3; ++k) list.push_back(brief(p[k]));
  }

  Json trajectory() const {
    Json json = {{"t", Json::array()}, {"p", Json::array()}};
    for (const eval::StampedPose& pose : input_.trajectory.poses) {
      json["t"].push_back(seconds(pose.stamp_ns));
      append_position(json["p"], pose.T_world_camera.t);
    }
    return json;
  }

  // To the millimetre, which a screen does not show.
  static void append_rounded(Json& list, const Vector3& p) {
    for (int k = 0; k < 3; ++k) list.push_back(std::round(p[k] * 1e3) / 1e3);
  }

  Json scene() const {
    Json json = {{"points", Json::array()}, {"lines", Json::array()}};
    for (const Vector3& p : input_.scene.points) append_rounded(json["points"], p);
    for (const auto& [a, b] : input_.scene.lines) {
      append_rounded(json["lines"], a);
      append_rounded(json["lines"], b);
    }
    return json;
  }

  Json series() const {
    Json json;
    const std::array<const char*, 3> counts = {"detected", "matched", "inliers"};
    for (const RunSample& s : input_.series) {
      json["t"].push_back(seconds(s.stamp_ns));
      json["state"].push_back(s.state);
      json["brightness"].push_back(brief(static_cast<double>(s.brightness)));
      for (std::size_t k = 0; k < counts.size(); ++k) {
        json["points"][counts[k]].push_back(s.points[k]);
        json["lines"][counts[k]].push_back(s.lines[k]);
      }
      for (std::size_t k = 0; k <= kStageCount; ++k) {
        const char* name = k < kStageCount ? to_string(static_cast<Stage>(k)) : "total";
        json["stages"][name].push_back(brief(static_cast<double>(s.cpu_ms[k])));
      }
    }
    return json;
  }

  Json frames() const {
    Json list = Json::array();
    for (const RecordedFrame& f : input_.frames) {
      list.push_back({{"i", f.number},
                      {"t", seconds(f.stamp_ns)},
                      {"state", f.state},
                      {"reason", f.reason},
                      {"points", {f.points.detected, f.points.matched, f.points.inliers}},
                      {"lines", {f.lines.detected, f.lines.matched, f.lines.inliers}},
                      {"w", f.width},
                      {"h", f.height},
                      {"k", f.keypoints},
                      {"m", f.tracks},
                      {"s", f.segments},
                      {"image", base64(f.image_jpeg)},
                      {"depth", base64(f.depth_jpeg)}});
    }
    return list;
  }

  void add_evaluation(Json& json, const eval::Evaluation& e) const {
    json["metrics"] = to_json(e);
    const Se3 T_first = e.poses.estimate[0] * e.poses.truth[0].inverse();
    const Se3 T_best = e.ate.T_truth_estimate.inverse();
    Json first = Json::array(), best = Json::array();
    for (const Se3& T : e.poses.truth) {
      append_position(first, (T_first * T).t);
      append_position(best, (T_best * T).t);
    }
    json["truth"] = {{"first", first}, {"best", best}};
    json["lost"] = Json::array();
    for (const eval::Interval& i : e.lost) json["lost"].push_back({seconds(i.begin_ns), seconds(i.end_ns)});
    json["errors"] = errors(e);
    Json rows = Json::array();
    for (const eval::DistanceError& d : e.by_distance) {
      rows.push_back({fmt::format("{:g} m", d.length_m), fmt::format("{:.2f}", d.translation_percent.mean),
                      fmt::format("{:.2f}", d.translation_percent.p95),
                      fmt::format("{:.3f}", d.rotation_deg_per_m.mean),
                      fmt::format("{}", d.translation_percent.count)});
    }
    json["by_distance"] = {{"head", {"path", "mean, %", "p95, %", "mean, °/m", "sub-trajectories"}},
                           {"rows", rows}};
  }

  Json errors(const eval::Evaluation& e) const {
    Json json = {{"t", Json::array()}, {"e", Json::array()}, {"s", nullptr}};
    for (int k = 0; k < 6; ++k) json["e"].push_back(Json::array());
    bool any_sigma = false;
    for (const eval::PoseError& error : e.errors) any_sigma |= error.sigma.has_value();
    if (any_sigma) json["s"] = json["e"];
    for (const eval::PoseError& error : e.errors) {
      json["t"].push_back(seconds(error.stamp_ns));
      for (int k = 0; k < 6; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        json["e"][axis].push_back(brief(error.error[k]));
        if (any_sigma) json["s"][axis].push_back(error.sigma ? Json(brief((*error.sigma)[k])) : Json());
      }
    }
    return json;
  }

  const ReportInput& input_;
  std::int64_t origin_ns_ = 0;
};

void fill(std::string& page, const std::string& mark, const std::string& text) {
  const std::size_t at = page.find(mark);
  page.replace(at, mark.size(), text);
}

// Returns JSON for an HTML script element. Its text must not end the element (`</script`), begin a comment
// (`<!--`) or contain a character reference (`&`): these characters are escaped, and so is every character
// that is not ASCII, including U+2028 and U+2029, which end a line of JavaScript.
std::string script_json(const Json& data) {
  std::string safe;
  for (const char c : data.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<' || c == '>' || c == '&') {
      fmt::format_to(std::back_inserter(safe), "\\u{:04x}", static_cast<unsigned>(c));
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

std::string make_report(const ReportInput& input) {
  std::string page = k_page_html;
  fill(page, "@SCRIPT@", std::string(k_charts_js) + k_turntable_js + k_paths_js + k_frames_js + k_main_js);
  fill(page, "@STYLE@", palette_css() + k_style_css);
  const Json data = Writer(input).data();
  fill(page, "@DATA@", script_json(data));
  return page;
}

Status write_report(const std::filesystem::path& path, const ReportInput& input) {
  LineFile file;
  return file.open(path, make_report(input));
}

}  // namespace plvo::report
