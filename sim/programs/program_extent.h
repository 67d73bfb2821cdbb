/// Extent of the motion of a program: the range of every axis, in each work system and in machine
/// coordinates, as far as positions are known.
#pragma once

#include <array>
#include <limits>
#include <map>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/known_positions.h"

namespace servomill::sim::programs {

/// Unit in which reports give the positions of an axis.
inline double unit_of(Axis axis) { return is_linear(axis) ? mm : deg; }

/// Positions from `lower` to `upper` (m, rad).
struct AxisRange {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();

  bool is_known() const { return lower <= upper; }
  void include(double position);
};
using AxisRanges = std::array<AxisRange, kAxisWords>;

struct WorkExtent {
  AxisRanges motion;  // ends of all moves
  AxisRanges feed;    // feeds and arcs only, from where they begin
};

class ProgramExtent {
 public:
  /// Adds a motion. Ends count, and the extreme points of arcs; lines between known points lie
  /// between them.
  void add(const Move& move, const MoveKnowledge& known);

  const std::map<int, WorkExtent>& work() const {
    return work_;
  }  ///< by MoveKnowledge::work_system
  const AxisRanges& machine() const { return machine_; }

  /// First line that moves an axis to a position that is not known; 0: none does.
  int unknown_work(std::size_t axis) const { return unknown_work_[axis]; }
  int unknown_machine(std::size_t axis) const { return unknown_machine_[axis]; }
  /// First line that moves an axis at all; 0: none does.
  int moved(std::size_t axis) const { return moved_[axis]; }
  /// First line in a tilted work plane, whose coordinates are not those of a work system.
  int tilted() const { return tilted_; }

 private:
  void count_unknown(const Move& move, const MoveKnowledge& known);

  std::map<int, WorkExtent> work_;
  AxisRanges machine_;
  std::array<int, kAxisWords> unknown_work_{}, unknown_machine_{}, moved_{};
  int tilted_ = 0;
};

}  // namespace servomill::sim::programs
