#include "plant/kinematics/inverse.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/tool_axis.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi, kFullTurn = 2.0 * std::numbers::pi;

// Between the lines along a and b, at most a right angle.
double angle_of_lines(double angle) { return std::min(angle, kPi - angle); }

// By which e turns the half plane of a into that of b. Parts along e are taken off first: near e
// they would hide what is left.
double angle_about(const Vector3d& e, const Vector3d& a, const Vector3d& b) {
  const Vector3d u = a - e.dot(a) * e, v = b - e.dot(b) * e;
  return std::atan2(e.dot(u.cross(v)), u.dot(v));
}

Vector3d turned_about(const Vector3d& e, double q, const Vector3d& v) {
  const double c = std::cos(q), s = std::sin(q);
  return c * v + s * e.cross(v) + (1.0 - c) * e.dot(v) * e;
}

// Angle between the sides b and c of a spherical triangle with sides a, b, c; of the flat triangle
// that comes nearest where there is none.
double corner_opposite_of(double a, double b, double c) {
  const double s = 0.5 * (a + b + c);
  const double above = std::sin(s - b) * std::sin(s - c), below = std::sin(s) * std::sin(s - a);
  return 2.0 * std::atan2(std::sqrt(std::max(above, 0.0)), std::sqrt(std::max(below, 0.0)));
}

// Longest and total way of the rotary axes.
struct Way {
  double longest = 0.0, total = 0.0;

  bool operator<(const Way& other) const {
    constexpr double kSame = 1e-9;  // rad; rounding must not choose between mirrored solutions
    if (std::abs(longest - other.longest) > kSame) return longest < other.longest;
    return total < other.total - kSame;
  }
};

Way way_from(const Joints& Q_near, const Joints& Q) {
  const Joints way = (Q - Q_near).cwiseAbs();
  const auto rotary = way.tail<kJoints - kLinearJoints>();
  return {rotary.maxCoeff(), rotary.sum()};
}

}  // namespace

InverseKinematics::InverseKinematics(const MachineChain& chain, const InverseSettings& settings)
    : chain_(chain), settings_(settings) {
  for (const ChainAxis& a : chain_.axes) {
    if (is_linear(a.axis)) continue;
    assert(number_of_rotary_ < 2);
    rotary_[static_cast<std::size_t>(number_of_rotary_++)] = {
        direction_of(a), a.sense == Sense::table ? -1.0 : 1.0, a.joint};
  }
  if (number_of_rotary_ == 0) return;
  const Vector3d z = Vector3d::UnitZ();
  const Rotary& last = rotary_[static_cast<std::size_t>(number_of_rotary_ - 1)];
  theta_2_ = angle_between(last.direction, z);
  if (number_of_rotary_ < 2) return;
  phi_ = angle_between(rotary_[0].direction, last.direction);
  zeta_ = angle_about(last.direction, rotary_[0].direction, z);
}

double InverseKinematics::tool_sense(const Rotary& axis, const Joints& Q) const {
  return axis.sign * Q[axis.joint];
}

// --- tool axis ----------------------------------------------------------------------------------

InverseKinematics::Angles InverseKinematics::angles(const Vector3d& k, const Joints& Q_near) const {
  if (number_of_rotary_ == 2) return angles_of_two(k, Q_near);
  if (number_of_rotary_ == 1) return angles_of_one(k, Q_near);
  return {1, {}, angle_between(k, Vector3d::UnitZ()), false};
}

InverseKinematics::Angles InverseKinematics::angles_of_one(const Vector3d& k,
                                                           const Joints& Q_near) const {
  const Vector3d& e = rotary_[0].direction;
  const double theta = angle_between(e, k);
  Angles out{1, {}, std::abs(theta - theta_2_), false};
  out.is_singular = angle_of_lines(theta) <= settings_.singular_angle ||
                    angle_of_lines(theta_2_) <= settings_.singular_angle;
  out.q[0][0] =
      out.is_singular ? tool_sense(rotary_[0], Q_near) : angle_about(e, Vector3d::UnitZ(), k);
  return out;
}

InverseKinematics::Angles InverseKinematics::angles_of_two(const Vector3d& k,
                                                           const Joints& Q_near) const {
  const Vector3d z = Vector3d::UnitZ(), &e_1 = rotary_[0].direction, &e_2 = rotary_[1].direction;
  const double theta_1 = angle_between(e_1, k), tolerance = settings_.singular_angle;
  const double least = std::abs(phi_ - theta_2_);
  const double most = std::min(phi_ + theta_2_, kFullTurn - phi_ - theta_2_);
  Angles out;
  out.miss = std::max({least - theta_1, theta_1 - most, 0.0});

  const bool first_is_free =
      angle_of_lines(theta_1) <= tolerance || angle_of_lines(phi_) <= kParallel;
  const bool second_is_free = angle_of_lines(theta_2_) <= kParallel;
  out.is_singular = first_is_free || second_is_free;
  if (out.is_singular) {
    out.count = 1;
    double &q_1 = out.q[0][0], &q_2 = out.q[0][1];
    q_1 = tool_sense(rotary_[0], Q_near);
    q_2 = tool_sense(rotary_[1], Q_near);
    if (!second_is_free) {
      q_2 = angle_about(e_2, z, turned_about(e_1, -q_1, k));
    } else if (!first_is_free) {
      q_1 = angle_about(e_1, z, k);
    }
    return out;
  }
  out.count = 2;
  const double E_2 = corner_opposite_of(theta_1, theta_2_, phi_);
  for (int i = 0; i < 2; ++i) {
    double &q_1 = out.q[i][0], &q_2 = out.q[i][1];
    q_2 = (i == 0 ? E_2 : -E_2) - zeta_;
    q_1 = angle_about(e_1, turned_about(e_2, q_2, z), k);
  }
  return out;
}

double InverseKinematics::distance_from_singular(const Vector3d& k_W) const {
  if (number_of_rotary_ < 2) return 0.5 * kPi;
  if (angle_of_lines(phi_) <= kParallel || angle_of_lines(theta_2_) <= kParallel) return 0.0;
  return angle_of_lines(angle_between(rotary_[0].direction, k_W));
}

// --- joints -------------------------------------------------------------------------------------

// Full turns towards Q_near, then into the travel.
void InverseKinematics::place_turns(JointSolution& solution, const Joints& Q_near) const {
  for (int i = 0; i < number_of_rotary_; ++i) {
    const int joint = rotary_[static_cast<std::size_t>(i)].joint;
    const double lower = settings_.lower[joint] - settings_.travel_tolerance;
    const double upper = settings_.upper[joint] + settings_.travel_tolerance;
    double& q = solution.Q[joint];
    const double nearest = q + kFullTurn * std::round((Q_near[joint] - q) / kFullTurn);
    double turns = 0.0;
    if (nearest < lower) turns = std::ceil((lower - nearest) / kFullTurn);
    if (nearest > upper) turns = -std::ceil((nearest - upper) / kFullTurn);
    const double within = nearest + kFullTurn * turns;
    q = within >= lower && within <= upper ? within : nearest;
  }
}

void InverseKinematics::place_linear(JointSolution& solution, const ToolPose& P,
                                     const Vector3d& p_ST) const {
  const LinearJoints linear = linear_joints(chain_, P.p_WT, solution.Q, p_ST);
  solution.Q = linear.Q;
  if (!solution.is_reached()) return;
  if (linear.is_unique && linear.miss <= kReachTolerance) return;
  solution.reach = linear.is_unique ? Reach::position : Reach::parallel_axes;
  solution.miss = linear.miss;
}

bool InverseKinematics::is_within_travel(const Joints& Q) const {
  return beyond_travel(Q).maxCoeff() <= settings_.travel_tolerance;
}

// How far each joint lies beyond its travel, negative within.
Joints InverseKinematics::beyond_travel(const Joints& Q) const {
  return (settings_.lower - Q).cwiseMax(Q - settings_.upper);
}

void InverseKinematics::check_travel(JointSolution& solution) const {
  if (!solution.is_reached() || is_within_travel(solution.Q)) return;
  solution.reach = Reach::travel;
  solution.miss = beyond_travel(solution.Q).maxCoeff(&solution.joint);
}

JointSolutions InverseKinematics::solve(const ToolPose& P, const Vector3d& p_ST,
                                        const Joints& Q_near) const {
  // Rounding of a vector that its maker has normalised.
  constexpr double kUnit = 1e-9;
  assert(std::abs(P.k_W.norm() - 1.0) < kUnit);
  static_cast<void>(kUnit);
  const Angles angles = this->angles(P.k_W, Q_near);
  JointSolutions out;
  out.count = angles.count;
  for (int i = 0; i < angles.count; ++i) {
    JointSolution& solution = out.all[static_cast<std::size_t>(i)];
    const bool is_reached = angles.miss <= settings_.orientation_tolerance;
    solution.reach = is_reached ? Reach::reached : Reach::orientation;
    solution.miss = is_reached ? 0.0 : angles.miss;
    solution.is_singular = angles.is_singular;
    for (int n = 0; n < number_of_rotary_; ++n) {
      const Rotary& axis = rotary_[static_cast<std::size_t>(n)];
      solution.Q[axis.joint] = axis.sign * angles.q[i][n];
    }
    place_turns(solution, Q_near);
    place_linear(solution, P, p_ST);
    check_travel(solution);
  }
  if (out.count < 2) return out;
  auto& [first, second] = out.all;
  const bool is_other_way_round = first.is_reached() == second.is_reached()
                                      ? way_from(Q_near, second.Q) < way_from(Q_near, first.Q)
                                      : second.is_reached();
  if (is_other_way_round) std::swap(first, second);
  return out;
}

}  // namespace servomill::plant
