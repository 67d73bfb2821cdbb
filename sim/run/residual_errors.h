/// Errors that a strategy cannot correct, or no longer corrects, searched for along the program.
#pragma once

#include <optional>
#include <vector>

#include "plant/kinematics/inverse.h"
#include "sim/engine/program_path.h"
#include "strategies/strategy.h"

namespace servomill::sim::run {

struct ResidualErrors {
  int line = 0;
  strategies::Residual left;
  double singular_angle = 0.0;  // rad, of the tool axis from a singular direction there
};

/// Limits up to which nothing is reported.
inline constexpr strategies::Residual kUncorrected = {.tip = 0.1e-6, .axis = 1e-6};  // m, rad

/// The place of the feed motion where most is left of the tool axis or, where of none much is left,
/// of the tip: among the ends of lines, places every 5 mm and every degree that a rotary axis turns
/// on them, or some thousand of these places.
/// @param inverse  of the ideal machine
/// @param p_ST     of the tool with which the model is identified (3; m)
/// @return nothing if the strategy corrects nothing, or all
std::optional<ResidualErrors> residual_errors(const engine::ProgramPath& path,
                                              const strategies::Strategy& strategy,
                                              const plant::InverseKinematics& inverse,
                                              const Eigen::Vector3d& p_ST);

/// Place at which the program leaves a compensation table.
struct LeftTable {
  int line = 0;  // the first one that does
  strategies::BeyondTable table;
  double farthest = 0.0;  // m, of the joint
};

/// The ends of tables that feed motion leaves, looked for at the same places.
/// @param layout  of the machine's joints
std::vector<LeftTable> left_tables(const engine::ProgramPath& path,
                                   const strategies::Strategy& strategy, const JointLayout& layout);

}  // namespace servomill::sim::run
