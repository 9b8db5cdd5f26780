// SPDX-License-Identifier: Apache-2.0
// How the odometry is set, for Python: a preset, and what is asked for beside it.
#include <algorithm>
#include <optional>
#include <string>

#include "plvo/python/bindings.hpp"
#include "plvo/python/settings.hpp"

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

enum class Preset { kDefault, kPaper, kTiny };

Settings of_preset(Preset preset) {
  if (preset == Preset::kPaper) return {.config = Config::paper(), .limits = {}};
  if (preset == Preset::kTiny) return {.config = Config::tiny(), .limits = Limits::tiny()};
  return {};
}

Settings make_settings(const std::string& preset, const std::optional<std::string>& features,
                       const std::optional<std::string>& reference, const std::optional<std::uint64_t>& seed,
                       const BudgetConfig& budget, bool level_world) {
  constexpr Choice<Preset> kPresets[] = {
      {"default", Preset::kDefault}, {"paper", Preset::kPaper}, {"tiny", Preset::kTiny}};
  constexpr Choice<Features> kFeatures[] = {
      {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}};
  constexpr Choice<ReferencePolicy> kReferences[] = {{"previous", ReferencePolicy::kPreviousFrame},
                                                     {"keyframe", ReferencePolicy::kKeyframe},
                                                     {"both", ReferencePolicy::kKeyframeAndPrevious},
                                                     {"window", ReferencePolicy::kWindow}};
  const Preset chosen = choose("preset", preset, kPresets);
  Settings settings = of_preset(chosen);
  Config& config = settings.config;
  if (features) config.features = choose("features", *features, kFeatures);
  if (reference) config.references.policy = choose("reference", *reference, kReferences);
  if (chosen != Preset::kTiny)
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
  bind_class<Settings>(module, "Config")
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
      .def_property_readonly("seed", [](const Settings& s) { return s.config.seed; })
      .def_property_readonly("frame_budget_ns", [](const Settings& s) { return s.config.budget.frame_ns; });
}

}  // namespace plvo::python
