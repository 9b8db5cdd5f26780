// SPDX-License-Identifier: Apache-2.0
// How the odometry is set, for Python: a preset, and what is asked for beside it.
#include <optional>
#include <string>

#include "plvo/odometry/config.hpp"
#include "plvo/python/bindings.hpp"

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

Config make_config(const std::string& preset, const std::optional<std::string>& features,
                   const std::optional<std::string>& reference, const std::optional<std::uint64_t>& seed) {
  constexpr Choice<bool> kPresets[] = {{"default", false}, {"paper", true}};
  constexpr Choice<Features> kFeatures[] = {
      {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}};
  constexpr Choice<ReferencePolicy> kReferences[] = {{"previous", ReferencePolicy::kPreviousFrame},
                                                     {"keyframe", ReferencePolicy::kKeyframe},
                                                     {"both", ReferencePolicy::kKeyframeAndPrevious}};
  Config config = choose("preset", preset, kPresets) ? Config::paper() : Config();
  if (features) config.features = choose("features", *features, kFeatures);
  if (reference) config.references.policy = choose("reference", *reference, kReferences);
  if (seed) config.seed = *seed;
  return config;
}

}  // namespace

void bind_config(py::module_& module) {
  py::class_<Config>(module, "Config")
      .def(py::init([](const std::string& preset, const py::object& features, const py::object& reference,
                       const py::object& seed) {
             return make_config(preset, optional<std::string>(features), optional<std::string>(reference),
                                optional<std::uint64_t>(seed));
           }),
           py::kw_only(), "preset"_a = "default", "features"_a = py::none(), "reference"_a = py::none(),
           "seed"_a = py::none())
      .def_readonly("seed", &Config::seed);
}

}  // namespace plvo::python
