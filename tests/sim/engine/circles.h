/// A program of circles for runs with a structure that gives way.
#pragma once

#include <fmt/format.h>

#include <string>

namespace servomill::sim::engine {

/// Full circles about the origin, from (radius, 0); turns of them before the section "last" of two
/// more, and one to leave.
inline std::string circles(double radius_mm, double feed, int turns) {
  std::string out = fmt::format("G17 G21 G90 G94 G64 P0.001\nG0 X{0} Y0\nG2 X{0} Y0 I-{0} F{1}\n",
                                radius_mm, feed);
  for (int n = 1; n < turns; ++n) out += fmt::format("G2 X{0} Y0 I-{0}\n", radius_mm);
  out += "(MSG, last)\n";
  for (int n = 0; n < 2; ++n) out += fmt::format("G2 X{0} Y0 I-{0}\n", radius_mm);
  return out + fmt::format("(MSG, leave)\nG2 X{0} Y0 I-{0}\nM30\n", radius_mm);
}

}  // namespace servomill::sim::engine
