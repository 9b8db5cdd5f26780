// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/palette.hpp"

#include <fmt/format.h>

#include <iterator>

namespace plvo::report {

std::string css_colour(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.r, colour.g, colour.b);
}

std::string palette_css() {
  std::string css = ":root {";
  const auto add = [&css](const std::string& name, const std::string& value) {
    fmt::format_to(std::back_inserter(css), " --{}: {};", name, value);
  };
  add("point", css_colour(kPointColour));
  add("line", css_colour(kLineColour));
  add("line-3d", css_colour(kLine3dColour));
  add("rejected", css_colour(kRejectedColour));
  add("seen", css_colour(kSeenColour));
  for (std::size_t i = 0; i < kCurves.size(); ++i) add(fmt::format("curve-{}", i), css_colour(kCurves[i]));
  std::string ramp;
  for (const Colour& colour : kDepthRamp) ramp += ", " + css_colour(colour);
  add("depth-ramp", "linear-gradient(90deg" + ramp + ")");
  return css + " }\n";
}

}  // namespace plvo::report
