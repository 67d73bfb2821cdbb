/// Moves of a touch probe that measures spheres on the table, for any control.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "sim/readings/readings.h"

namespace servomill::sim::programs {

/// Probe, spheres and the way to them. m, m/s.
struct ProbingSettings {
  double sphere = 25e-3, stylus = 6e-3;  // diameters
  double clearance = 10e-3;              // from the surface, where a probing move begins
  double beyond = 3e-3;                  // behind the nominal surface, where it ends
  double feed = 5e-3;
};

/// One block: a rapid of one or more axes, or a probing move along one.
struct MeasuringStep {
  bool is_probe = false;
  /// Axes that the block names: tip of the probe in machine coordinates, angles (6; m, rad).
  std::array<std::optional<double>, kAxisWords> to;
  std::string sphere;              // of a probing move
  Joints joints = Joints::Zero();  // of a probing move: at the nominal touch
};

/// All touches of the spheres that a plan has, one pair of angles after the other: each sphere from
/// above and from the sides that the table does not turn towards it. Every touch begins at the
/// clearance, ends behind the surface at the latest, and is followed by a rapid back to where it
/// began; sides are changed above the sphere, spheres and angles at the top of the travel.
struct MeasuringMoves {
  std::vector<MeasuringStep> steps;
  int touches = 0;
  std::vector<std::string> notes;  // poses that are left out, with the reason
};

/// @param plan  groups of kind sphere count, others are not measured by a program
/// @param length  m, of the probe to the centre of its ball
/// @throws InputError where the machine cannot be measured so: no rotary axis turns the table, one
/// turns the spindle, Z has no end of travel
MeasuringMoves measuring_moves(const readings::Readings& plan,
                               const model::MachineSettings& machine,
                               const ProbingSettings& settings, double length);

}  // namespace servomill::sim::programs
