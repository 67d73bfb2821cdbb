/// A short five-axis program under tool-centre-point control, on a trunnion machine with all
/// errors.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/evaluation/comparison.h"
#include "sim/input/read_scenario.h"
#include "sim/model/quantity_spec.h"
#include "sim/model/scenario.h"
#include "sim/run/run_case.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim {

/// All component errors of the five axes, some 10 um and urad each, smooth; all location errors.
inline std::string errors_of_all_axes() {
  std::string out =
      "[errors.machine]\nEC0Y = \"40 urad\"\nEA0Z = \"-30 urad\"\nEB0Z = \"25 urad\"\n"
      "EY0A = \"20 um\"\nEZ0A = \"-15 um\"\nEB0A = \"-35 urad\"\nEC0A = \"45 urad\"\n"
      "EX0C = \"-25 um\"\nEY0C = \"15 um\"\nEA0C = \"35 urad\"\nEB0C = \"-20 urad\"\n";
  int n = 0;
  for (const char axis : std::string("XYZAC")) {
    const bool turns = axis < 'X';
    for (const char direction : std::string("XYZABC")) {
      const char* unit = direction >= 'X' ? "um" : "urad";
      out += fmt::format(
          "E{}{} = {{ constant_{} = {:.1f}, harmonic = {{ amplitude_{} = {:.1f}, period_{} = {}, "
          "phase_deg = {} }} }}\n",
          direction, axis, unit, direction == axis + 'A' - 'X' ? 0.0 : 5.0 * std::cos(2.0 * n),
          unit, 9.0 + 5.0 * std::sin(1.0 + n), turns ? "deg" : "mm", turns ? 180.0 : 160.0, 37 * n);
      ++n;
    }
  }
  return out;
}

/// Half an S, 40 mm long and 20 wide; the tool leans by 8 to 18 deg and turns on.
inline std::string s_shaped_program(double feed) {
  constexpr int kLocations = 100;
  std::string out = "G21 G90 G94 G64 P0.00005\nT1 M6\nG43.5 H1\n";
  for (int i = 0; i <= kLocations; ++i) {
    const double u = static_cast<double>(i) / kLocations, phi = std::numbers::pi * (u - 0.5);
    const Eigen::Vector3d k = Eigen::Vector3d(0.15, -0.28 * std::sin(phi), 1.0).normalized();
    if (i == 1) out += fmt::format("F{}\n(MSG, flank)\n", feed);
    out += fmt::format("G{} X{:.7f} Y{:.7f} Z{:.7f} I{:.8f} J{:.8f} K{:.8f}\n", i == 0 ? 0 : 1,
                       -20.0 + 40.0 * u, 10.0 * std::sin(phi), 20.0, k.x(), k.y(), k.z());
  }
  return out + "(MSG, end)\nM30\n";
}

/// @param toml  cases
inline model::Scenario trunnion_scenario(const std::string& program, const std::string& toml) {
  return input::read_resolved_scenario(
      "machine = \"machines/generic_trunnion_ac.toml\"\nmachine_errors = \"machine\"\n"
      "[machine_override.nc]\nrotary_tolerance_urad = 0.5\n[feedback_hardware]\nconnected = true\n"
      "[record]\nperiod_ms = 2.0\nresolution_nm = 0.0\n" +
          errors_of_all_axes() + toml +
          "\n[program]\nfile = \"small.ngc\"\nstart = { Z_mm = 200.0 }\ntext = '''\n" + program +
          "'''\n[[program.tool]]\nnumber = 1\nlength_mm = 120.0\n[[program.tool]]\nnumber = "
          "2\nlength_mm = 80.0\n",
      SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
}

inline std::string corrected_case(const std::string& name, const std::string& servo,
                                  const std::string& type, const std::string& more) {
  return fmt::format(
      "[[case]]\nname = \"{}\"\nservo = \"{}\"\n[[case.strategy]]\ntype = \"{}\"\n"
      "model = \"machine\"\naction = \"compensate\"\n{}",
      name, servo, type, more);
}

/// Largest deviation of tip (um) and tool axis (urad) in a section.
struct Deviation {
  double tip = 0.0, axis = 0.0;
};
inline Deviation deviation_in(const run::CaseOutput& out, const std::string& section) {
  const auto largest = [&](const char* name) {
    model::QuantitySpec spec;
    spec.name = name;
    spec.statistic = "max";
    spec.cases = {out.name};
    spec.sections = {section};
    const evaluation::CaseData data = out.data();
    const double value = evaluation::compare({&spec, 1}, {&data, 1}).front().value;
    testing::Test::RecordProperty(out.name + "_" + section + "_" + name,
                                  fmt::format("{:.6g}", value));
    return value;
  };
  return {largest("tcp_deviation"), largest("tool_axis_deviation")};
}

}  // namespace servomill::sim
