/// Rewritten program: the path is cut into short linear blocks and every point displaced.
///
/// Moves under tool-centre-point control become blocks of the axes: with the tip p(t) and the tool
/// axis k(t) (or the rotary axes) as programmed, Q(t) the ideal inverse, and d the displacement,
///
///     Q_block(t) = Q(t) + d(Q(t), s(t)),   chords within the tolerances,   time t / feed of the
///     tip (G93)
///
/// so that the NC needs no tool-centre-point control any more. Moves in a tilted work plane are
/// refused.
#pragma once

#include <array>
#include <span>
#include <stdexcept>

#include "plant/geometry/reversal_memory.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/parameters.h"
#include "plant/vocabulary/put_move.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// A rewritten program of more blocks than anybody intends.
class TooManyBlocks : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct BlockLimits {
  double tolerance = 0.0;       // m, of chords
  double max_block = 0.0;       // m
  double tolerance_turn = 0.0;  // rad
  double max_block_turn = 0.0;  // rad
  bool turns = false;           // rotary axes are displaced, too
};

/// The parameters of BlockLimits as every strategy declares them: tolerance_um, max_block_mm,
/// tolerance_urad, max_block_deg.
extern const std::array<ParameterSpec, 4> kBlockSpecs;
BlockLimits block_limits_of(const Parameters& parameters);

/// Displacement of the points of a program, in their order.
class PointDisplacement {
 public:
  struct At {
    AxisWords d = AxisWords::Zero();                 // m, rad; in all
    Eigen::Vector3d step = Eigen::Vector3d::Zero();  // m; the part of it that steps where axes
                                                     // reverse
  };

  virtual ~PointDisplacement() = default;
  /// @param Q  as programmed (5; m, rad)
  /// @param s  m, on the path of the original program
  virtual At at(const Joints& Q, double s) const = 0;
  /// Hysteresis that makes it step; none: it is continuous.
  virtual std::span<const plant::Play> plays() const { return {}; }
  /// Coordinate of a joint that its hysteresis follows.
  virtual double travelled(const Joints& Q, int joint) const { return Q[joint]; }
  /// The axes have gone there.
  virtual void travel(const Joints& Q, const At& there) {
    (void)Q;
    (void)there;
  }
};

/// Hands out the moves in displaced blocks. Rapids are displaced at their ends; X, Y and Z wait in
/// moves of rotary axes alone, unless they are displaced, too.
/// @param identified  its nominal machine, tool tip and start
/// @throws TooManyBlocks before the first one
void put_displaced_blocks(const MoveRange& moves, const IdentifiedMachine& identified,
                          const BlockLimits& limits, PointDisplacement& displacement,
                          const PutMove& put);

}  // namespace servomill::strategies
