/// Tolerance of the tool tip as tolerances of the joints.
///
/// A joint deviation moves the tip by at most
///
///     |dp| <= |dQ_linear| + a |dQ_rotary|,   a^2 = sum of squares of the arms of the tip     (1)
///
/// so a tolerance T of the tip less what the chords miss is divided among linear and rotary joints,
/// as the direction of the chords changes in them, since corners deviate in that proportion: where
/// the rotary joints are at rest nearly all of it is left to the linear ones. The angle by which
/// the tool axis moves is at most sqrt(2) |dQ_rotary|.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

struct JointChord {
  Joints end = Joints::Zero();    // m, rad
  double fraction = 0.0;          // of the move, where the chord ends
  double tolerance_linear = 0.0;  // m, for rounding
  double tolerance_rotary = 0.0;  // rad
  bool is_even = true;            // on a curve without corners (RotaryKnot)
};

/// Tolerances of a chord, before they are divided among its joints.
struct ChordBudget {
  Joints begin;        // m, rad, where it begins
  double whole = 0.0;  // m, tolerance of the tip
  double tip = 0.0;    // m, the same less what the chord misses
  double arm = 0.0;    // m, of (1)
  double axis = 0.0;   // rad, of a rotary joint, for the tool axis
};

/// Divides the tolerances of one chord after the other, of which it holds a few.
class ChordTolerances {
 public:
  /// @param rotary_radius  m, by which angles become lengths
  /// @param put  takes the chords in their order
  ChordTolerances(double rotary_radius, std::function<void(const JointChord&)> put)
      : rotary_radius_(rotary_radius), put_(std::move(put)) {}

  void add(const JointChord& chord, const ChordBudget& budget);
  /// The next chord is one of another move.
  void end_move() { ++move_; }
  /// Nothing follows.
  void finish();

 private:
  // Changes of direction where a chord begins, as they move the tip.
  struct Bend {
    double linear = 0.0, rotary = 0.0;
  };
  struct Pending {
    JointChord chord;
    ChordBudget budget;
    std::size_t move;
  };
  Bend bend_before(const JointChord& chord, const ChordBudget& budget);
  void divide_first();

  double rotary_radius_;
  std::function<void(const JointChord&)> put_;
  std::size_t move_ = 1, last_move_ = 0;  // of the next chord; of the one that was divided last
  std::size_t divided_ = 0;
  std::deque<Pending> pending_;
  std::deque<Bend> sums_ = {Bend{}};  // of the bends before the chords; the last of all of them
  Joints last_end_ = Joints::Zero(), last_direction_ = Joints::Zero();  // of the last chord
};

}  // namespace servomill::controllers
