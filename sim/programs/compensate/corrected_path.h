/// One programmed move, corrected: as few blocks as the tolerance allows.
///
/// The corrected path is c(t) = w(t) + R^-1 d(w(t)), w the programmed position in work coordinates,
/// t its share of the move, R the rotation of the work system, d the correction. It is looked at
/// in places no farther apart than `FitOptions::look`, and closer where the correction bends.
/// From where a block begins the next one reaches as far as no such place is off by more than the
/// tolerance:
///   - where X, Y and Z alone move, off the line or circle, wherever along it
///   - where rotary axes move, or the correction was learnt along the path, off where the NC is at
///     the same share of the block
/// Blocks end on the corrected path. Arcs become arcs, several if they must: an ellipse, as skew
/// makes of a circle, is a few arcs or a thousand lines.
#pragma once

#include <optional>
#include <vector>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/axes.h"
#include "sim/programs/compensate/correction.h"

namespace servomill::sim::programs {

/// Work coordinates in the machine: machine = R work + offset.
struct WorkFrame {
  double cos = 1.0, sin = 0.0;           // of the rotation about Z
  AxisWords offset = AxisWords::Zero();  // m, rad
  AxisWords turned(const AxisWords& v) const;
  AxisWords turned_back(const AxisWords& v) const;
  AxisWords machine(const AxisWords& work) const { return turned(work) + offset; }
  AxisWords work(const AxisWords& machine) const { return turned_back(machine - offset); }
};

/// A straight move, an arc or a helix in work coordinates.
struct ProgrammedMove {
  AxisWords begin = AxisWords::Zero(), end = AxisWords::Zero();  // 6; m, rad
  std::optional<ArcSweep> arc;
  WorkFrame frame;
  double s_begin = 0.0, s_end = 0.0;  // m, on the path of the original program

  double s(double t) const { return s_begin + t * (s_end - s_begin); }
  AxisWords at(double t) const;
  double length() const;  // of X Y Z, m; 0 where rounding alone moves them
  bool turns_axes() const;
};

struct FitOptions {
  double tolerance = 1e-6;                // m
  double tolerance_turn = 1e-5;           // rad, of rotary axes
  double look = 1e-3;                     // m
  double look_turn = 0.0174532925199433;  // rad
  double max_block = 0.0;                 // m, where the correction varies; 0: no limit
  bool allow_arcs = true;
};

/// A block of the corrected path.
struct FittedBlock {
  double t_begin = 0.0, t_end = 1.0;  // shares of the programmed move
  AxisWords end = AxisWords::Zero();  // work coordinates
  std::optional<Arc> arc;             // centre in work coordinates
};

/// @param begin  where the corrected program stands (6; work coordinates): near c(0)
std::vector<FittedBlock> fit(const ProgrammedMove& move, const Correction& correction,
                             const AxisWords& begin, const FitOptions& options);

/// c(t)
AxisWords corrected(const ProgrammedMove& move, const Correction& correction, double t);

}  // namespace servomill::sim::programs
