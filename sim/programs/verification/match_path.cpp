// Feeds and arcs of a written program, along the corrected path.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/verification/replay_comparison.h"

namespace servomill::sim::programs {
namespace {

constexpr double kTimeRounding = 0.05;  // of the time of a block

using controllers::ActionKind;

constexpr double kRounding = 0.87;            // of the grid: half of it in X, Y and Z
constexpr double kFeedTol = 1e-4;             // relative, of digits
constexpr double kFeedDigit = 1e-3;           // mm/min
constexpr double kRevolutionDigit = 0.51e-6;  // m, three decimals of mm
constexpr double kSampleLength = 2e-3;        // m, between two samples
constexpr double kSampleTurn = 1.0 * deg;
constexpr int kMaxSamples = 500;

/// A block of the written program as a curve.
class Piece {
 public:
  Piece(const controllers::MachineAction& action, const AxisWords& from, const AxisWords& end)
      : from_(from), end_(end) {
    if (action.kind == ActionKind::arc) {
      arc_ =
          ArcSweep(from.head<3>(), end.head<3>(), action.centre, action.normal_axis, action.turns);
    }
  }
  AxisWords at(double u) const {
    AxisWords out = from_ + u * (end_ - from_);
    if (arc_) out.head<3>() = arc_->point(u);
    return out;
  }
  double length() const { return arc_ ? arc_->length() : (end_ - from_).head<3>().norm(); }
  double angle() const { return (end_ - from_).tail<3>().norm(); }
  int samples() const {
    const double n = std::max(length() / kSampleLength, angle() / kSampleTurn);
    return std::clamp(static_cast<int>(n), 1, kMaxSamples) + 1;
  }

 private:
  AxisWords from_, end_;
  std::optional<ArcSweep> arc_;
};

}  // namespace

bool ReplayComparison::admits(const OriginalAction& action, const Action* one) const {
  if (one == nullptr || one->is_machine_position) return false;
  if (action.move.kind == MoveKind::rapid) return one->kind == ActionKind::rapid;
  return one->kind == ActionKind::feed || one->kind == ActionKind::arc;
}

// With what rounding adds: of an arc, the centre is rounded, too.
double ReplayComparison::path_tolerance(bool is_arc) const {
  return limits_.tolerance + (kRounding + (is_arc ? 1.0 : 0.0)) * limits_.grid;
}

// A change of the correction of these axes waits for their next move.
AxisFlags6 ReplayComparison::unmoved_axes(const OriginalAction& action) {
  AxisFlags6 out = action.changed();
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = !out[i] && !action.is_named[i];
  return out;
}

void ReplayComparison::match_path(const OriginalAction& action) {
  AxisWords at = known_position();
  CorrectedCurve curve(action, correction_);
  if (action.move.kind == MoveKind::rapid) curve.hold(unmoved_axes(action), at);
  const AxisWords last = curve.at(1.0);
  double tolerance = path_tolerance(false);
  const double tolerance_turn = limits_.tolerance_turn + limits_.grid_turn;
  const auto off = [&](const AxisWords& p) {
    return std::max((p - last).head<3>().norm() / tolerance,
                    (p - last).tail<3>().cwiseAbs().maxCoeff() / tolerance_turn);
  };
  const double size = std::max(curve.length() / tolerance, curve.angle() / tolerance_turn);
  const bool is_small = size <= 4.0;  // may vanish in the rounding
  double t = curve.is_still() ? 1.0 : 0.0;
  bool is_compared = false;
  while (true) {
    const Action* one = peek();
    tolerance = path_tolerance(was_arc_);
    const bool is_there = off(at) <= 1.0 && (is_small || (1.0 - t) * size <= 2.0);
    AxisWords end = at;
    if (admits(action, one)) {
      for (int i = 0; i < kAxisWords; ++i) {
        const auto& known = one->end[static_cast<std::size_t>(i)];
        if (known) end[i] = *known;
      }
    }
    // a short block may follow to where the rounding was better
    const bool improves = admits(action, one) && off(end) <= 1.0 && off(end) < off(at) &&
                          Piece(*one, at, end).length() <= 4.0 * tolerance;
    if (is_there && !improves) break;
    if (one == nullptr) fail("a feed move is missing; the written program has ended");
    if (!admits(action, one)) {
      fail(fmt::format("expected a feed move to {}, found another action", place(last)));
    }
    if (!is_compared) compare_auxiliary(action, action.move.kind != MoveKind::rapid);
    is_compared = true;
    const double t_end = curve.is_still() ? 1.0 : curve.share(at, end, t, *one);
    if ((t - t_end) * size > 2.0) fail("moves backwards on the path");
    if ((t_end - 1.0) * size > 2.0) {
      fail(fmt::format("moves beyond {}, where the original ends", place(last)));
    }
    check_piece(action, curve, *one, at, t, std::clamp(t_end, t, 1.0));
    t = std::clamp(t_end, t, 1.0);
    at = end;
    was_arc_ = one->kind == ActionKind::arc;
    arrive(*one);
  }
}

// Distances along a block, its feed and its path mode.
void ReplayComparison::check_piece(const OriginalAction& action, const CorrectedCurve& curve,
                                   const Action& one, const AxisWords& from, double t_begin,
                                   double t_end) {
  AxisWords end = from;
  for (int i = 0; i < kAxisWords; ++i) {
    const auto& known = one.end[static_cast<std::size_t>(i)];
    if (known) end[i] = *known;
  }
  const Piece piece(one, from, end);
  const double tolerance = path_tolerance(one.kind == ActionKind::arc || was_arc_);
  // a block may lead from where a rapid has ended to the begin of the corrected path
  const double begin_off = (from - curve.at(0.0)).head<3>().norm();
  const bool is_approach =
      curve.is_still() || (t_begin == 0.0 && t_end * curve.length() <= 2.0 * tolerance &&
                           t_end * curve.angle() <= 2.0 * limits_.grid_turn);
  const int n = piece.samples();
  for (int i = is_approach ? n : 1; i <= n; ++i) {
    const double u = static_cast<double>(i) / n;
    const AxisWords position = piece.at(u);
    const double t = t_begin + u * (t_end - t_begin);
    const double d = curve.distance(position, t);
    if (d > tolerance) {
      fail(fmt::format("deviates from the corrected path by {:.2f} um, at {}", d / um,
                       place(position)));
    }
    largest_ = std::max(largest_, d);
    const double turn = curve.turn(position, t);
    if (turn > limits_.tolerance_turn + limits_.grid_turn) {
      fail(fmt::format("deviates from the path of the rotary axes by {:.5f} deg", turn / deg));
    }
  }
  if (is_approach && piece.length() > begin_off + 2.0 * tolerance) {
    fail("takes another path to the start");
  }
  if (action.move.kind == MoveKind::rapid) return;
  check_path_mode(action, one);
  if (!is_approach) check_feed(action, curve, one, from, t_end - t_begin);
}

void ReplayComparison::check_feed(const OriginalAction& action, const CorrectedCurve& curve,
                                  const Action& one, const AxisWords& from, double share) const {
  const Move& move = action.move;
  const double tolerance = path_tolerance(false);
  const double size =
      curve.length() > 0.0 ? curve.length() / tolerance : curve.angle() / limits_.grid_turn;
  if (share * size <= 4.0) return;  // too short to distinguish a feed from rounding
  const bool is_per_revolution = move.feed_mode == FeedMode::units_per_revolution;
  if (is_per_revolution || one.feed_mode == FeedMode::units_per_revolution) {
    if (one.feed_mode != move.feed_mode) fail("a feed per revolution and one per minute");
    if (std::abs(one.feed - move.value) > kFeedTol * move.value + kRevolutionDigit) {
      fail(fmt::format("the feed must be {:g} mm per revolution, but is {:g}", move.value / mm,
                       one.feed / mm));
    }
    return;
  }
  AxisWords end = from;
  for (int i = 0; i < kAxisWords; ++i) {
    if (one.end[static_cast<std::size_t>(i)]) end[i] = *one.end[static_cast<std::size_t>(i)];
  }
  const Piece piece(one, from, end);
  const bool is_by_time = one.feed_mode == FeedMode::inverse_time;
  const bool keeps_time = is_by_time || move.feed_mode == FeedMode::inverse_time;
  if (!keeps_time && !curve.rotates()) {
    // a control that feeds along the arc of a helix has its feed from rounded positions
    const bool is_helix =
        one.kind == ActionKind::arc && from[one.normal_axis] != end[one.normal_axis];
    const double rounded = is_helix ? 2.0 * limits_.grid / piece.length() : 0.0;
    if (std::abs(one.feed - move.feed) >
        (kFeedTol + rounded) * move.feed + kFeedDigit * mm_per_min) {
      fail(fmt::format("the feed must be {:g} mm/min, but is {:g} mm/min", move.feed / mm_per_min,
                       one.feed / mm_per_min));
    }
    return;
  }
  // rotary axes, or a feed by time: the block must take its share of the time
  const double way = curve.length() > 0.0 ? curve.length() : curve.angle();
  const double time = way / move.feed;
  const double own_way = piece.length() > limits_.grid * 1e-3 ? piece.length() : piece.angle();
  const double own = is_by_time ? 1.0 / one.feed : own_way / one.feed;
  // a control that counts time in ms cannot hold that of short blocks better
  const double rounded =
      is_by_time ? std::min(0.5 * limits_.time_digit, kTimeRounding * share * time) : 0.0;
  if (std::abs(own - share * time) > 1e-3 * share * time + 4.0 / size * time + rounded) {
    fail(fmt::format("the block must take {:g} s, but takes {:g} s", share * time, own));
  }
}

void ReplayComparison::check_path_mode(const OriginalAction& action, const Action& one) const {
  if (action.is_of_cycle && !limits_.is_linuxcnc) return;
  const bool stops = one.is_path_mode_known && one.path_mode != PathMode::continuous;
  const bool must_stop = action.has_path_mode && action.move.path_mode != PathMode::continuous;
  if (must_stop && !stops) fail("corners must be exact (G61), but are not");
  if (stops && !must_stop) fail("stops at corners, which the original does not");
  if (!limits_.is_linuxcnc || !action.has_path_mode) return;
  if (one.path_mode != action.move.path_mode ||
      std::abs(one.path_tolerance.value_or(0.0) - action.move.path_tolerance) > 1e-9) {
    fail("another path mode (G61, G61.1, G64 P)");
  }
}

}  // namespace servomill::sim::programs
