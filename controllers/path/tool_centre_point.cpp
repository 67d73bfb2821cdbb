#include "controllers/path/tool_centre_point.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/kinematics/branches.h"
#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

using Eigen::Vector3d;

constexpr double kStandingAxis = 1e-12;  // rad, turns of the tool axis below this are none
constexpr double kOpposite = 1e-6;       // rad, from half a turn: no plane is given
constexpr double kMinTurn = 1e-12;       // rad of the tool axis; what changes within is a jump
constexpr double kUneven = 0.1;          // of the chord, by which joints may leave it evenly
constexpr std::array<double, 3> kLooks = {0.25, 0.5, 0.75};  // where a chord is compared

plant::InverseSettings rotary_travel(const Joints& lower, const Joints& upper) {
  plant::InverseSettings settings;
  settings.lower.tail<kJoints - kLinearJoints>() = lower.tail<kJoints - kLinearJoints>();
  settings.upper.tail<kJoints - kLinearJoints>() = upper.tail<kJoints - kLinearJoints>();
  return settings;
}

std::string vector_text(const Vector3d& k) {
  const auto number = [](double x) { return std::abs(x) < 0.5e-6 ? 0.0 : x; };  // never -0.000000
  return fmt::format("({:.6f}, {:.6f}, {:.6f})", number(k.x()), number(k.y()), number(k.z()));
}

}  // namespace

ToolCentrePoint::ToolCentrePoint(const plant::MachineChain& chain, const Joints& lower,
                                 const Joints& upper, double axis_tolerance)
    : inverse_(chain, rotary_travel(lower, upper)),
      axis_tolerance_(axis_tolerance),
      upper_travel_(upper) {
  assert(axis_tolerance > 0.0);
  for (const plant::ChainAxis& a : chain.axes) number_of_rotary_ += is_linear(a.axis) ? 0 : 1;
}

AxisWords ToolCentrePoint::tip_words(const AxisWords& machine, const Vector3d& p_ST) const {
  AxisWords tip = machine;
  tip.head<3>() = plant::forward(chain(), chain().layout.joints(machine), p_ST).p_WT;
  return tip;
}

std::optional<AxisWords> ToolCentrePoint::machine_words(const AxisWords& tip,
                                                        const Vector3d& p_ST) const {
  const auto Q = joints(tip.head<3>(), chain().layout.joints(tip), p_ST);
  if (!Q) return std::nullopt;
  AxisWords machine = tip;
  machine.head<3>() = chain().layout.words(*Q).head<3>();
  return machine;
}

std::optional<Joints> ToolCentrePoint::joints(const Vector3d& p_WT, const Joints& Q_rotary,
                                              const Vector3d& p_ST) const {
  return plant::inverse_fixed_rotary(chain(), p_WT, Q_rotary, p_ST);
}

Vector3d ToolCentrePoint::tool_axis(const Joints& Q) const {
  return plant::forward(chain(), Q, Vector3d::Zero()).k_W;
}

// A tool axis where the joints have the tip.
ToolPose ToolCentrePoint::anywhere(const Vector3d& k, const Joints& Q) const {
  return {plant::forward(chain(), Q, Vector3d::Zero()).p_WT, k};
}

ToolCentrePoint::Pointing ToolCentrePoint::point(const Vector3d& k, const Joints& Q_near) const {
  const plant::JointSolution found =
      inverse_.nearest(anywhere(k, Q_near), Vector3d::Zero(), Q_near);
  Pointing out{Q_near, {}};
  out.Q.tail<kJoints - kLinearJoints>() = found.Q.tail<kJoints - kLinearJoints>();
  if (found.reach == plant::Reach::orientation) {
    out.fault = fmt::format("the tool axis {} cannot be reached; the error is {:.4f} deg",
                            vector_text(k), found.miss / deg);
  } else if (found.reach == plant::Reach::travel) {
    const int j = found.joint;
    const auto& [lower, upper] =
        std::pair(inverse_.settings().lower[j], inverse_.settings().upper[j]);
    const bool above = found.Q[j] > upper;
    out.fault = fmt::format("the tool axis {} requires {} = {:.4f} deg; must be {} {:.4f}",
                            vector_text(k), chain().layout.letter_of(j), found.Q[j] / deg,
                            above ? "<=" : ">=", (above ? upper : lower) / deg);
  }
  return out;
}

Vector3d ToolCentrePoint::axis_between(const Vector3d& k_begin, const Vector3d& k_end, double t) {
  const double theta = angle_between(k_begin, k_end);
  if (theta < kStandingAxis) return k_end;
  const Vector3d n = (k_end - k_begin * k_begin.dot(k_end)).normalized();
  return (k_begin * std::cos(t * theta) + n * std::sin(t * theta)).normalized();
}

// Returns true if the tool axis keeps to its circle when the joints move linearly to a knot.
bool ToolCentrePoint::keeps_circle(const RotaryKnot& from, RotaryKnot& to, const Vector3d& k_begin,
                                   const Vector3d& k_end) const {
  const double way = (to.Q - from.Q).cwiseAbs().maxCoeff();
  to.is_even = true;
  for (const double f : kLooks) {
    const Joints Q = from.Q + f * (to.Q - from.Q);
    const Vector3d wanted =
        axis_between(k_begin, k_end, from.fraction + f * (to.fraction - from.fraction));
    if ((tool_axis(Q) - wanted).norm() > axis_tolerance_) return false;
    const Pointing exact = point(wanted, Q);
    const double off = (exact.Q - Q).cwiseAbs().maxCoeff();
    to.is_even = to.is_even && exact.fault.empty() && off <= kUneven * way;
  }
  return true;
}

// Why the joints cannot go on continuously to the tool axis k.
std::string ToolCentrePoint::jump_fault(const Joints& from, const Joints& to,
                                        const Vector3d& k) const {
  int joint = 0;
  (to - from).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff(&joint);
  joint += kLinearJoints;
  const char letter = chain().layout.letter_of(joint);
  const auto ends = plant::joint_at_its_end(inverse_, anywhere(k, from), Vector3d::Zero(), from);
  if (!ends) {
    return fmt::format("{} would have to jump from {:.4f} to {:.4f} deg", letter, from[joint] / deg,
                       to[joint] / deg);
  }
  const std::string other = *ends == joint ? "" : fmt::format("{} ", letter);
  return fmt::format(
      "{} reaches its travel limit at {:.4f} deg; otherwise {}would have to jump from {:.4f} to "
      "{:.4f} deg",
      chain().layout.letter_of(*ends), from[*ends] / deg, other, from[joint] / deg,
      to[joint] / deg);
}

// The first knot behind a singular direction on the branch of Q, which belongs to t.
std::optional<RotaryKnot> ToolCentrePoint::depart(const RotaryKnot& start, double t,
                                                  const Joints& Q, const Vector3d& k_begin,
                                                  const Vector3d& k_end) const {
  RotaryKnot knot{t, Q};
  while (!keeps_circle(start, knot, k_begin, k_end)) {
    knot.fraction *= 0.5;
    if (knot.fraction * angle_between(k_begin, k_end) < kMinTurn) return std::nullopt;
    knot.Q = point(axis_between(k_begin, k_end, knot.fraction), knot.Q).Q;
  }
  return knot;
}

// To the end by the solutions nearest to those before.
AxisTurn ToolCentrePoint::trace(const RotaryKnot& start, const Vector3d& k_begin,
                                const Vector3d& k_end) const {
  AxisTurn out;
  out.angle = angle_between(k_begin, k_end);
  RotaryKnot at = start;
  double step = 1.0;
  while (at.fraction < 1.0) {
    const bool last = at.fraction + step >= 1.0;
    RotaryKnot next{last ? 1.0 : at.fraction + step};
    const Vector3d k = axis_between(k_begin, k_end, next.fraction);
    const Pointing found = point(k, at.Q);
    if (!found.fault.empty()) {
      out.fault = last ? found.fault : fmt::format("during the move, {}", found.fault);
      return out;
    }
    next.Q = found.Q;
    if (keeps_circle(at, next, k_begin, k_end)) {
      at = next;
      out.knots.push_back(at);
      step *= 2.0;
    } else if (step * out.angle < kMinTurn) {
      out.fault = jump_fault(at.Q, next.Q, k);
      return out;
    } else {
      step = 0.5 * (next.fraction - at.fraction);
    }
  }
  return out;
}

AxisTurn ToolCentrePoint::great_circle(const Joints& Q, const Vector3d& k_end) const {
  const Vector3d k_begin = tool_axis(Q);
  AxisTurn out;
  out.angle = angle_between(k_begin, k_end);
  if (out.angle > std::numbers::pi - kOpposite) {
    out.fault = "the tool axis rotates by 180 deg, so the great circle is undefined";
    return out;
  }
  const RotaryKnot start{0.0, Q};
  if (out.angle < kStandingAxis) {
    out.knots.push_back({1.0, Q});
    return out;
  }
  out = trace(start, k_begin, k_end);
  if (out.fault.empty() || inverse_.distance_from_singular(k_begin) > axis_tolerance_) return out;
  const double t = std::min(1.0, axis_tolerance_ / out.angle);
  const ToolPose just_off = anywhere(axis_between(k_begin, k_end, t), Q);
  for (const Joints& branch : plant::departures(inverse_, just_off, Vector3d::Zero(), Q)) {
    const auto knot = depart(start, t, branch, k_begin, k_end);
    if (!knot) continue;
    AxisTurn turn = trace(*knot, k_begin, k_end);
    if (!turn.fault.empty()) continue;
    turn.knots.insert(turn.knots.begin(), *knot);
    return turn;
  }
  return out;
}

}  // namespace servomill::controllers
