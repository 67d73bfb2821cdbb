#include "controllers/path/chord_tolerances.h"

#include <algorithm>

namespace servomill::controllers {
namespace {

constexpr double kInnerShare = 0.4;     // of linear and of rotary joints, within a move
constexpr double kSecondOrder = 0.05;   // beyond (1), where rotary joints deviate
constexpr double kMinShare = 0.2;       // of either kind of joints where both deviate
constexpr double kStill = 1e-3;         // of rotary joints that do not move
constexpr std::size_t kNeighbours = 3;  // chords on either side that deviate together

// From a chord to the last one whose bend counts for it.
constexpr std::size_t kAhead = kNeighbours + 2;

// @param bend  linear and rotary, near the chord
template <class Bend>
void divide(const ChordBudget& budget, const Bend& bend, bool is_inner, JointChord& chord) {
  double most_rotary = kInnerShare * budget.whole;  // of the tip
  chord.tolerance_linear = kInnerShare * budget.whole;
  if (!(bend.rotary > 0.0)) {
    most_rotary = kStill * budget.tip;
    chord.tolerance_linear = budget.tip - most_rotary;
  } else if (!is_inner) {
    const double tip = budget.tip * (1.0 - kSecondOrder);
    const double needed = bend.rotary / (bend.rotary + bend.linear);
    most_rotary = std::clamp(needed, kMinShare, 1.0 - kMinShare) * tip;
    chord.tolerance_linear = tip - std::min(most_rotary, budget.arm * budget.axis);
  }
  chord.tolerance_rotary = budget.axis;
  if (budget.arm > 0.0) {
    chord.tolerance_rotary = std::min(budget.axis, most_rotary / budget.arm);
  }
}

}  // namespace

void ChordTolerances::add(const JointChord& chord, const ChordBudget& budget) {
  const Bend here = bend_before(chord, budget), before = sums_.back();
  sums_.push_back({before.linear + here.linear, before.rotary + here.rotary});
  pending_.push_back({chord, budget, move_});
  if (pending_.size() == kAhead) divide_first();
}

void ChordTolerances::finish() {
  while (!pending_.empty()) divide_first();
}

ChordTolerances::Bend ChordTolerances::bend_before(const JointChord& chord,
                                                   const ChordBudget& budget) {
  Joints step = chord.end - budget.begin;
  step.tail<kJoints - kLinearJoints>() *= rotary_radius_;
  const Joints direction = step.stableNormalized();
  const bool goes_on = divided_ + pending_.size() > 0 && last_end_ == budget.begin;
  const Joints bend = direction - std::exchange(last_direction_, direction);
  last_end_ = chord.end;
  if (!goes_on) return {};
  const double turned = bend.tail<kJoints - kLinearJoints>().norm();
  return {bend.head<kLinearJoints>().norm(), budget.arm * turned / rotary_radius_};
}

// Linear and rotary joints deviate as the direction changes in them, chords near each other
// together: (1) leaves each kind what it needs.
void ChordTolerances::divide_first() {
  auto [chord, budget, move] = pending_.front();
  // its ends lie on a curve within a move, which has no corners
  const bool is_inner = move == last_move_ && pending_.size() > 1 && pending_[1].move == move;
  const std::size_t last = sums_.size() - 1;  // behind the last chord that is pending
  const Bend& from = sums_[last - pending_.size() - std::min(divided_, kNeighbours)];
  const Bend& to = sums_[last - (std::max(pending_.size(), kAhead) - kAhead)];
  divide(budget, Bend{to.linear - from.linear, to.rotary - from.rotary}, is_inner, chord);
  last_move_ = move;
  ++divided_;
  pending_.pop_front();
  while (sums_.size() > pending_.size() + kNeighbours + 1) sums_.pop_front();
  put_(chord);
}

}  // namespace servomill::controllers
