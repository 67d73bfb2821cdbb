/// Effect of a text on a control, as far as it can be seen at the machine.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/axes.h"
#include "sim/programs/compensate/compensate.h"

namespace servomill::sim::programs {

/// Motion that goes nowhere and switches that change nothing are left out, and so are lines.
struct Effect {
  /// Rapids with their ends, switches, changes of feed.
  std::vector<std::string> order;
  /// Feeds between them: ends of blocks and points on arcs, m.
  std::vector<std::vector<Eigen::Vector3d>> paths;
  /// Blocks of feed, to the digit.
  std::vector<std::string> blocks;
  bool operator==(const Effect&) const = default;
};

/// One for each setting of the control; none where it refuses the text.
std::vector<Effect> effects_of(const std::string& text, Dialect dialect,
                               const controllers::ControlSetup& setup);

/// The same of a program for LinuxCNC, read by strict rules from two starts.
std::vector<Effect> linuxcnc_effects_of(const std::string& text, controllers::ProgramSetup setup,
                                        const JointLayout& layout);

/// Tells if both go along the same paths within `tolerance` (m), and do the same otherwise.
bool is_within(const std::vector<Effect>& a, const std::vector<Effect>& b, double tolerance);

}  // namespace servomill::sim::programs
