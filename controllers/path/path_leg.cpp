#include "controllers/path/path_leg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace servomill::controllers {
namespace {

constexpr double kReversal = -0.5;  // cosine of the sharpest corner that is not a stop
constexpr double kLongLeg = 3.0;    // windows, below it corners share their curvature

// Limit along a direction, in which a joint that does not move, or
// that the machine does not have, limits nothing.
double along(const Joints& limits, const Joints& direction) {
  // A share of a direction (unit vector) that is rounding.
  constexpr double kStill = 1e-12;
  const Joints d = direction.cwiseAbs();
  return (d.array() > kStill)
      .select(limits.array() / d.array().max(kStill), std::numeric_limits<double>::infinity())
      .minCoeff();
}

}  // namespace

Leg leg_of(const Move& move) {
  Leg leg;
  leg.rapid = move.kind == MoveKind::rapid;
  leg.stop_after = move.path_mode == PathMode::exact_stop;
  leg.is_synchronised = move.synchronised != Synchronised::no;
  leg.exact_corners = move.path_mode == PathMode::exact_path;
  return leg;
}

JointLimits limits_of(const Leg& leg, JointLimits limits) {
  limits.a *= leg.acceleration_share;
  return limits;
}

void set_tolerances(Leg& leg, std::span<const JointChord> chords, double rotary_radius) {
  if (chords.empty()) return;
  const JointChord &first = chords.front(), &last = chords.back();
  leg.tolerance = std::min(first.tolerance_linear, last.tolerance_linear);
  leg.rotary_tolerance = std::min(first.tolerance_rotary, last.tolerance_rotary) * rotary_radius;
}

Joints scale_of(const PathOptions& options) {
  Joints scale = Joints::Ones();
  scale.tail<kJoints - kLinearJoints>().setConstant(options.rotary_radius);
  return scale;
}

double LegRules::tolerance_of(const Move& move) const {
  if (move.path_mode != PathMode::continuous) return options_.exact_tolerance;
  const double programmed = options_.tolerance_share * move.path_tolerance;
  return programmed > 0.0 ? programmed : options_.tolerance;
}

FeedLimit LegRules::feed_limit(const Move& move, const Leg& leg) const {
  FeedLimit feed;
  if (options_.block_time > 0.0) feed.path = leg.length / options_.block_time;
  if (leg.rapid) return feed;
  const double value = move.feed * (leg.is_synchronised ? 1.0 : options_.feed_override);
  (leg.rotary_only ? feed.rotary : feed.linear) =
      leg.rotary_only ? value * options_.rotary_radius : value;
  return feed;
}

double LegRules::speed_along(const Leg& leg, const Move& move) const {
  const Joints d = leg.tangent_begin.cwiseAbs();
  const FeedLimit feed = feed_limit(move, leg);
  double v = along(limits_.v, d);
  const double linear = d.head<kLinearJoints>().norm();
  const double rotary = d.tail<kJoints - kLinearJoints>().norm();
  if (linear > 0.0) v = std::min(v, feed.linear / linear);
  if (rotary > 0.0) v = std::min(v, feed.rotary / rotary);
  return std::min(v, feed.path);
}

double LegRules::acceleration_share(const Leg& leg, const Move& move) const {
  if (!leg.is_synchronised) return 1.0;
  const double a = along(limits_.a, leg.tangent_begin);
  const double lead = std::abs(move.value) / (2.0 * std::numbers::pi);  // m a radian
  return std::min(1.0, lead * options_.spindle_acceleration / a);
}

bool LegRules::must_stop(const Leg& from, const Leg& to) const {
  if (from.is_synchronised || to.is_synchronised) return true;
  if (from.rapid != to.rapid || from.rotary_only != to.rotary_only) return true;
  const double cosine = from.tangent_end.dot(to.tangent_begin);
  if (cosine < kReversal) return true;
  const Joints turn = to.tangent_begin - from.tangent_end;
  if (from.exact_corners || to.exact_corners) return turn.norm() > options_.exact_corner;
  return stopping_is_faster(from, to, turn);
}

// Tells if rounding a lone corner between long legs takes longer than stopping in it. Compares the
// time lost against passing at speed v: T for the stop, with T the time of the ramp from v to 0;
// T_c (v - v_c)/v + 2 w (1/v_c - 1/v) for passing a window of half-width w at v_c.
bool LegRules::stopping_is_faster(const Leg& from, const Leg& to, const Joints& turn) const {
  const double linear = turn.head<kLinearJoints>().norm();
  const double rotary = turn.tail<kJoints - kLinearJoints>().norm();
  const double w = std::min(
      6.0 * std::min(from.tolerance, to.tolerance) / std::max(linear, 1e-12),
      6.0 * std::min(from.rotary_tolerance, to.rotary_tolerance) / std::max(rotary, 1e-12));
  const double L = std::min(from.length, to.length);
  if (L < kLongLeg * w) return false;
  const Joints d = from.tangent_end.cwiseAbs().cwiseMax(to.tangent_begin.cwiseAbs());
  const double a = along(limits_.a, d), j = along(limits_.j, d);
  const double peak = std::pow(L * std::sqrt(j) / 2.0, 2.0 / 3.0);  // rest to rest on the leg
  const double v = std::min({from.feed, to.feed, peak});
  const double v_c =
      std::min(std::cbrt(along(limits_.j, turn) * w * w), std::sqrt(along(limits_.a, turn) * w));
  if (v_c >= v) return false;
  const auto ramp = [&](double dv) {
    return dv * j > a * a ? dv / a + a / j : 2.0 * std::sqrt(dv / j);
  };
  return ramp(v) < ramp(v - v_c) * (v - v_c) / v + 2.0 * w * (1.0 / v_c - 1.0 / v);
}

}  // namespace servomill::controllers
