// SPDX-License-Identifier: Apache-2.0
// How the odometry is set, for Python: a preset, and what is asked for beside it.
#include <algorithm>
#include <optional>
#include <string>

#include "plvo/python/bindings.hpp"
#include "plvo/python/settings.hpp"
#include "plvo/python/values.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

template <typename Value>
struct Choice {
  const char* name;
  Value value;
};

template <typename Value, std::size_t N>
Value choose(const char* what, const std::string& text, const Choice<Value> (&choices)[N]) {
  std::string names;
  for (const Choice<Value>& choice : choices) {
    if (text == choice.name) return choice.value;
    names += (names.empty() ? "" : ", ") + std::string(choice.name);
  }
  throw py::value_error(std::string(what) + ": expected one of " + names + ", got '" + text + "'");
}

template <typename Value, std::size_t N>
const char* name_of(Value value, const Choice<Value> (&choices)[N]) {
  return std::find_if(choices, choices + N, [&](const auto& choice) { return choice.value == value; })->name;
}

constexpr Choice<Preset> kPresets[] = {
    {"default", Preset::kDefault}, {"paper", Preset::kPaper}, {"tiny", Preset::kTiny}};
constexpr Choice<Features> kFeatures[] = {
    {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}};
constexpr Choice<ReferencePolicy> kReferences[] = {{"previous", ReferencePolicy::kPreviousFrame},
                                                   {"keyframe", ReferencePolicy::kKeyframe},
                                                   {"both", ReferencePolicy::kKeyframeAndPrevious},
                                                   {"window", ReferencePolicy::kWindow}};

Settings of_preset(Preset preset) {
  if (preset == Preset::kPaper) return {.preset = preset, .config = Config::paper(), .limits = {}};
  if (preset == Preset::kTiny) return {.preset = preset, .config = Config::tiny(), .limits = Limits::tiny()};
  return {};
}

Settings make_settings(const std::string& preset, const std::optional<std::string>& features,
                       const std::optional<std::string>& reference, const std::optional<std::uint64_t>& seed,
                       const BudgetConfig& budget, bool level_world) {
  Settings settings = of_preset(choose("preset", preset, kPresets));
  Config& config = settings.config;
  if (features) config.features = choose("features", *features, kFeatures);
  if (reference) config.references.policy = choose("reference", *reference, kReferences);
  if (settings.preset != Preset::kTiny)
    settings.limits.references =
        std::max(settings.limits.references, references_of(config.references.policy));
  if (seed) config.seed = *seed;
  config.budget = budget;
  config.level_world = level_world;
  throw_unless_ok(config.validate());
  return settings;
}

}  // namespace

void bind_config(py::module_& module) {
  const BudgetConfig budget;
  bind_value<Settings>(module, "Config")
      .def(py::init([](const std::string& preset, const py::object& features, const py::object& reference,
                       const py::object& seed, std::int64_t frame_budget_ns, int budget_patience_frames,
                       double budget_spare_share, bool level_world) {
             return make_settings(preset, optional_text(features, "features"),
                                  optional_text(reference, "reference"),
                                  optional_integer<std::uint64_t>(seed, "seed"),
                                  {frame_budget_ns, budget_patience_frames, budget_spare_share}, level_world);
           }),
           py::kw_only(), "preset"_a = "default", "features"_a = py::none(), "reference"_a = py::none(),
           "seed"_a = py::none(), "frame_budget_ns"_a = budget.frame_ns,
           "budget_patience_frames"_a = budget.patience_frames, "budget_spare_share"_a = budget.spare_share,
           "level_world"_a = false)
      .def_property_readonly("preset", [](const Settings& s) { return name_of(s.preset, kPresets); })
      .def_property_readonly("features",
                             [](const Settings& s) { return name_of(s.config.features, kFeatures); })
      .def_property_readonly(
          "reference", [](const Settings& s) { return name_of(s.config.references.policy, kReferences); })
      .def_property_readonly("seed", [](const Settings& s) { return s.config.seed; })
      .def_property_readonly("frame_budget_ns", [](const Settings& s) { return s.config.budget.frame_ns; })
      .def_property_readonly("budget_patience_frames",
                             [](const Settings& s) { return s.config.budget.patience_frames; })
      .def_property_readonly("budget_spare_share",
                             [](const Settings& s) { return s.config.budget.spare_share; })
      .def_property_readonly("level_world", [](const Settings& s) { return s.config.level_world; })
      .def("__repr__", shown_by({"preset", "features", "reference", "seed", "frame_budget_ns",
                                 "budget_patience_frames", "budget_spare_share", "level_world"}));
}

}  // namespace plvo::python
