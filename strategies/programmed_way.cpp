#include "strategies/programmed_way.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/kinematics/straight_tool_path.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::strategies {

ProgrammedWay::ProgrammedWay(const plant::InverseKinematics& inverse, const Eigen::Vector3d& p_ST,
                             const Joints& Q_begin, const Move& move)
    : inverse_(inverse), p_ST_(p_ST), line_(move.line), control_(move.tool_control) {
  if (control_ == ToolControl::work_plane) {
    throw InputError({{}, line_, 0}, "moves in a tilted work plane cannot be rewritten");
  }
  AxisWords begin = layout().words(Q_begin);
  Q_end_ = layout().joints(move.end_machine);
  const ToolPose pose = plant::forward(inverse.chain(), Q_begin, p_ST);
  if (controls_tip()) begin.head<3>() = pose.p_WT;
  curve_ = MoveCurve(begin, move);
  k_begin_ = pose.k_W;
  k_end_ = move.tool_axis;
  if (controls_tip()) Q_end_ = with_tip(move.end_machine.head<3>(), Q_end_);
  turn_ = (Q_end_ - Q_begin).tail<kJoints - kLinearJoints>();
}

Joints ProgrammedWay::at(double t, const Joints& Q_near) const {
  if (t >= 1.0) return Q_end_;
  const AxisWords words = curve_.at(t);
  if (!controls_tip()) return layout().joints(words);
  if (!turns_axis()) return with_tip(words.head<3>(), layout().joints(words));
  const plant::StraightToolPath circle({Eigen::Vector3d::Zero(), k_begin_},
                                       {Eigen::Vector3d::Zero(), k_end_});
  return inverse_.nearest({words.head<3>(), circle.at(t).k_W}, p_ST_, Q_near).Q;
}

// Sign of the joint's rate about t; 0: it does not move by more than rounding does.
int ProgrammedWay::rate_sign(int joint, double t, double h, const Joints& Q_near) const {
  constexpr double kRounding = 1e-14;  // m, rad
  const double way = at(t + 0.5 * h, Q_near)[joint] - at(t - 0.5 * h, Q_near)[joint];
  if (std::abs(way) < kRounding) return 0;
  return way > 0.0 ? 1 : -1;
}

// Bisection. @pre the rate has another sign at a than at b
double ProgrammedWay::reversal_between(int joint, double a, double b, double h,
                                       const Joints& Q_near) const {
  const int sign = rate_sign(joint, a, h, Q_near);
  while (b - a > 1e-4 * h) {
    const double middle = 0.5 * (a + b);
    (rate_sign(joint, middle, h, Q_near) == sign ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

// The sign of the rate is compared in steps that no two reversals share.
std::vector<double> ProgrammedWay::turning_points(int joint, double from, double to,
                                                  const Joints& Q_near) const {
  if (!controls_tip() && curve_.sweep() == 0.0) return {};
  constexpr double kStep = 0.25 * std::numbers::pi, kRate = 1e-3;
  const double angle = (curve_.sweep() + turn_.norm()) * (to - from);
  const int steps = std::max(1, static_cast<int>(std::ceil(angle / kStep)));
  const double dt = (to - from) / steps, h = kRate * dt;
  std::vector<double> out;
  int sign = 0;
  double before = from;
  for (int i = 0; i <= steps; ++i) {
    const double t = std::clamp(from + i * dt, from + 0.5 * h, to - 0.5 * h);
    const int now = rate_sign(joint, t, h, Q_near);
    if (now == 0) continue;
    if (now == -sign) out.push_back(reversal_between(joint, before, t, h, Q_near));
    sign = now;
    before = t;
  }
  return out;
}

Joints ProgrammedWay::with_tip(const Eigen::Vector3d& p_WT, const Joints& Q_rotary) const {
  const auto Q = plant::inverse_fixed_rotary(inverse_.chain(), p_WT, Q_rotary, p_ST_);
  if (!Q) throw InputError({{}, line_, 0}, "the linear axes cannot reach this TCP position");
  return *Q;
}

}  // namespace servomill::strategies
