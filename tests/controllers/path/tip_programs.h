/// Programs under tool-centre-point control on small five-axis machines, planned and measured.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "controllers/path/tcp_motion.h"
#include "controllers/path/trajectory.h"
#include "controllers/path/travel.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::test {

/// A machine with a tool H1 of 100 mm, and what its NC is set to.
struct TipMachine {
  plant::MachineChain chain;
  Joints lower = Joints::Constant(-1e9), upper = Joints::Constant(1e9);
  JointLimits limits;
  PathOptions options;

  std::shared_ptr<const ToolCentrePoint> control() const;
  ProgramSetup setup() const;
  std::vector<Move> read(const std::string& program) const;
  ToolPose pose(const Joints& Q) const;  // of tool H1
};

/// `[w C' A' X b Y Z t]`: table-table, A about a line 60 mm below the table, C 1 mm beside it.
TipMachine table_machine();
/// `[w X' b Y Z C B t]`: head-head, the tilt axis 80 mm above the spindle nose.
TipMachine head_machine();

/// A machine and the word of the axis that tilts.
struct NamedMachine {
  const char* name;
  TipMachine machine;
  std::string tilt;
};

/// Both machines.
std::vector<NamedMachine> machines();

/// A program that was planned.
struct Planned {
  TipMachine machine;
  std::vector<Move> moves;
  TipMotions tip;
  Trajectory trajectory;

  Planned(const TipMachine& with, const std::string& program);

  /// Calls f(sample, pose) every `step` seconds.
  void sample(double step,
              const std::function<void(const Trajectory::Sample&, const ToolPose&)>& f) const;
  /// Calls it on one line of the program only.
  void sample_line(int line, double step,
                   const std::function<void(const Trajectory::Sample&, const ToolPose&)>& f) const;
};

/// Velocity (m/s) of the tip of tool H1 in the workpiece.
Eigen::Vector3d tip_velocity(const Planned& p, const Trajectory::Sample& now);

/// Expects that no joint exceeds its speed, acceleration and jerk at any `step` (s).
void expect_within_joint_limits(const Planned& p, double step = 0.5e-3);

/// Distance of p from the straight line through a and b.
double distance_to_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b);

}  // namespace servomill::controllers::test
