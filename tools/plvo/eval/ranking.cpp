// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/ranking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

namespace plvo::eval {
namespace {

constexpr double kComparableShare = 0.9;

const RpeResult& ranking_result(const Evaluation& e) { return e.rpe.back(); }

bool better(const NamedEvaluation& a, const NamedEvaluation& b) {
  const Statistics& first = ranking_result(a.evaluation).estimate.translation_m;
  const Statistics& second = ranking_result(b.evaluation).estimate.translation_m;
  if ((first.count == 0) != (second.count == 0)) return second.count == 0;
  if (first.count == 0) return a.evaluation.ate.position_m.rmse < b.evaluation.ate.position_m.rmse;
  return first.rmse < second.rmse;
}

std::string number_or_dash(const Statistics& s, double factor, int digits) {
  return s.count == 0 ? "-" : fmt::format("{:.{}f}", factor * s.rmse, digits);
}

}  // namespace

void rank(std::vector<NamedEvaluation>& estimates) {
  std::stable_sort(estimates.begin(), estimates.end(), better);
}

double covered_s(const Evaluation& evaluation) {
  double seconds = evaluation.duration_s;
  for (const Interval& lost : evaluation.lost)
    seconds -= static_cast<double>(lost.end_ns - lost.begin_ns) * 1e-9;
  return std::max(seconds, 0.0);
}

std::vector<std::string> doubts_about_ranking(const std::vector<NamedEvaluation>& ranked) {
  double most = 0;
  for (const NamedEvaluation& e : ranked) most = std::max(most, covered_s(e.evaluation));
  std::vector<std::string> doubts;
  for (const NamedEvaluation& e : ranked) {
    const double covered = covered_s(e.evaluation);
    if (covered < kComparableShare * most)
      doubts.push_back(fmt::format(
          "{} covers {:.1f} s, another estimate {:.1f} s: its errors are those of an easier part, where "
          "it lost the rest",
          e.name, covered, most));
  }
  return doubts;
}

std::string ranking_text(const std::vector<NamedEvaluation>& ranked) {
  std::size_t width = 8;
  for (const NamedEvaluation& e : ranked) width = std::max(width, e.name.size());
  std::string text, above, head = fmt::format("{:>4}  {:<{}} {:>9}", "rank", "estimate", width, "covered s");
  const auto out = std::back_inserter(text);
  above.assign(head.size(), ' ');
  for (const RpeResult& r : ranked.front().evaluation.rpe) {
    above += fmt::format(" {:>18}", "RPE over " + r.delta.text);
    head += fmt::format(" {:>9} {:>8}", "mm", "deg");
  }
  above += fmt::format(" {:>9} {:>8}", "ATE", "drift");
  head += fmt::format(" {:>9} {:>8}", "mm", "%");
  fmt::format_to(out, "ranked by the RMSE of the RPE over {}, translation\n\n{}\n{}\n",
                 ranking_result(ranked.front().evaluation).delta.text, above, head);
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    const Evaluation& e = ranked[i].evaluation;
    fmt::format_to(out, "{:>4}  {:<{}} {:>9.2f}", i + 1, ranked[i].name, width, covered_s(e));
    for (const RpeResult& r : e.rpe)
      fmt::format_to(out, " {:>9} {:>8}", number_or_dash(r.estimate.translation_m, 1e3, 3),
                     number_or_dash(r.estimate.rotation_deg, 1, 4));
    fmt::format_to(out, " {:>9.3f} {:>8}\n", 1e3 * e.ate.position_m.rmse,
                   e.path_m > 0 ? fmt::format("{:.2f}", 100 * e.drift.translation_m / e.path_m) : "-");
  }
  const Evaluation& best = ranked.front().evaluation;
  fmt::format_to(out, "{:>4}  {:<{}} {:>9}", "", "identity", width, "");
  for (const RpeResult& r : best.rpe)
    fmt::format_to(out, " {:>9} {:>8}", number_or_dash(r.identity.translation_m, 1e3, 3),
                   number_or_dash(r.identity.rotation_deg, 1, 4));
  fmt::format_to(out, " {:>9.3f}\n", 1e3 * best.ate_identity.rmse);
  return text;
}

nlohmann::ordered_json ranking_json(const std::vector<NamedEvaluation>& ranked) {
  nlohmann::ordered_json json = {
      {"ranked_by", "rpe over " + ranking_result(ranked.front().evaluation).delta.text},
      {"estimates", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    nlohmann::ordered_json entry = {
        {"rank", i + 1}, {"estimate", ranked[i].name}, {"covered_s", covered_s(ranked[i].evaluation)}};
    entry.update(to_json(ranked[i].evaluation));
    entry["warnings"] = ranked[i].warnings;
    json["estimates"].push_back(entry);
  }
  return json;
}

}  // namespace plvo::eval
