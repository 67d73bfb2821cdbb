#include "plant/geometry/volumetric.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Exponential of [e]x: Rot v = v + a e x v + b e x (e x v). The angular velocity when e changes by
// de is de + b e x de + c e x (e x de).
class Rotation {
 public:
  explicit Rotation(const Vector3d& e) : e_(e), t2_(e.squaredNorm()) {
    if (t2_ < kSeries) {
      a_ = 1.0 + t2_ * (-1.0 / 6.0 + t2_ * (1.0 / 120.0 - t2_ * (1.0 / 5040.0)));
      b_ = 0.5 + t2_ * (-1.0 / 24.0 + t2_ * (1.0 / 720.0 - t2_ * (1.0 / 40320.0)));
    } else {
      const double t = std::sqrt(t2_);
      a_ = std::sin(t) / t;
      b_ = (1.0 - std::cos(t)) / t2_;
    }
  }

  Vector3d operator*(const Vector3d& v) const {
    const Vector3d ev = e_.cross(v);
    return v + a_ * ev + b_ * e_.cross(ev);
  }

  Matrix3d matrix() const {
    Matrix3d R;
    for (int i = 0; i < 3; ++i) R.col(i) = *this * Vector3d::Unit(i);
    return R;
  }

  Vector3d velocity(const Vector3d& de) const {
    const double c =
        t2_ < kSeries ? 1.0 / 6.0 - t2_ * (1.0 / 120.0 - t2_ * (1.0 / 5040.0)) : (1.0 - a_) / t2_;
    const Vector3d ed = e_.cross(de);
    return de + b_ * ed + c * e_.cross(ed);
  }

 private:
  static constexpr double kSeries = 1e-3;  // rad^2: the next term is below 1e-17
  Vector3d e_;
  double t2_, a_, b_;
};

int lane_of(Axis direction) { return index_of(direction) + (is_linear(direction) ? 0 : 1); }

Vector3d unit_vector(Axis axis) { return Vector3d::Unit(index_of(axis) % 3); }

// Three linear axes with no rotary one between them move along orthogonal directions.
bool has_orthogonal_linear_axes(const MachineChain& chain) {
  int linear = 0;
  for (const ChainAxis& a : chain.axes) {
    if (is_linear(a.axis)) {
      ++linear;
    } else if (linear > 0 && linear < kLinearJoints) {
      return false;
    }
  }
  return linear == kLinearJoints;
}

std::size_t leading_rotary_axes(const MachineChain& chain) {
  const auto first = std::find_if(chain.axes.begin(), chain.axes.end(),
                                  [](const ChainAxis& a) { return is_linear(a.axis); });
  return static_cast<std::size_t>(first - chain.axes.begin());
}

// A tool pose and its derivatives with respect to all joints, moved together by rigid motions.
struct PoseAndJacobian {
  ToolPose P;
  PoseJacobian J;

  void turn(const Matrix3d& R) {
    P.p_WT = R * P.p_WT;
    P.k_W = R * P.k_W;
    J.J_pQ = (R * J.J_pQ).eval();
    J.J_kQ = (R * J.J_kQ).eval();
  }
  void shift(const Vector3d& d) { P.p_WT += d; }
  void move_with(int joint, const Vector3d& velocity) { J.J_pQ.col(joint) += velocity; }
  void turn_with(int joint, const Vector3d& w) {
    J.J_pQ.col(joint) += w.cross(P.p_WT);
    J.J_kQ.col(joint) += w.cross(P.k_W);
  }
};

}  // namespace

VolumetricModel::VolumetricModel(const MachineChain& chain, const ErrorModel& errors)
    : chain_(chain), linear_axes_are_orthogonal_(has_orthogonal_linear_axes(chain)) {
  for (const ChainAxis& a : chain_.axes) errors_.push_back(prepare(a, errors));
  const std::size_t rotary = leading_rotary_axes(chain_);
  for (faultless_ = 0; faultless_ < rotary && errors_[faultless_].is_zero();) ++faultless_;
}

VolumetricModel::Prepared VolumetricModel::prepare(const ChainAxis& axis,
                                                   const ErrorModel& errors) {
  Prepared out;
  for (const Axis direction : kAllAxes) {
    const int lane = lane_of(direction);
    const ErrorFunction& f = errors.component({direction, axis.axis, false});
    if (f.is_zero()) continue;
    out.has_components = true;
    out.has_angles = out.has_angles || !is_linear(direction);
    out.polynomial.resize(std::max(out.polynomial.size(), f.polynomial.size()), Screw::Zero());
    for (std::size_t i = 0; i < f.polynomial.size(); ++i) out.polynomial[i][lane] = f.polynomial[i];
    for (const Harmonic& h : f.harmonics) {
      const bool same_wave = !out.harmonics.empty() && out.harmonics.back().omega == h.omega() &&
                             out.harmonics.back().phase == h.phase;
      out.harmonics.push_back({lane, h.amplitude, h.omega(), h.phase, same_wave});
    }
    for (const LinearTable& t : f.tables) out.tables.push_back({lane, t});
  }
  for (const Axis direction : kAllAxes) {
    out.location[lane_of(direction)] = errors.location({direction, axis.axis, true});
  }
  out.has_location = !out.location.isZero(0.0);
  out.R_location = Rotation(turn_of(out.location)).matrix();
  if (is_linear(axis.axis)) out.direction = out.R_location * unit_vector(axis.axis);
  return out;
}

VolumetricModel::Screw VolumetricModel::values(const Prepared& errors, double q) {
  Screw e = Screw::Zero();
  for (std::size_t i = errors.polynomial.size(); i-- > 0;) e = e * q + errors.polynomial[i];
  double sine = 0.0;
  for (const auto& h : errors.harmonics) {
    if (!h.same_wave) sine = std::sin(h.omega * q + h.phase);
    e[h.lane] += h.amplitude * sine;
  }
  for (const auto& t : errors.tables) e[t.lane] += t.table.value(q);
  return e;
}

VolumetricModel::Screw VolumetricModel::derivatives(const Prepared& errors, double q) {
  Screw e = Screw::Zero();
  for (std::size_t i = errors.polynomial.size(); i-- > 1;) {
    e = e * q + static_cast<double>(i) * errors.polynomial[i];
  }
  for (const auto& h : errors.harmonics) {
    e[h.lane] += h.amplitude * h.omega * std::cos(h.omega * q + h.phase);
  }
  for (const auto& t : errors.tables) e[t.lane] += t.table.derivative(q);
  return e;
}

template <bool kWithAxis>
void VolumetricModel::apply_component_errors(const Prepared& errors, double q, ToolPose& P) {
  if (!errors.has_components) return;
  const Screw e = values(errors, q);
  if (errors.has_angles) {
    const Rotation R(turn_of(e));
    P.p_WT = R * P.p_WT;
    if constexpr (kWithAxis) P.k_W = R * P.k_W;
  }
  P.p_WT += shift_of(e);
}

template <bool kWithAxis>
void VolumetricModel::apply_with_errors(const ChainAxis& a, const Prepared& errors, double q,
                                        const JointMotion& m, ToolPose& P) {
  P.p_WT -= a.centre;
  if (a.side == Side::tool) apply_component_errors<kWithAxis>(errors, q, P);
  // L J(q) L^-1, now about the origin
  if (is_linear(a.axis)) {
    P.p_WT += m.shift * errors.direction;
  } else if (!errors.has_location) {
    P.p_WT = turned(a.axis, m.cosine, m.sine, P.p_WT);
    P.k_W = turned(a.axis, m.cosine, m.sine, P.k_W);
  } else {
    const Matrix3d& R = errors.R_location;
    const Vector3d t = shift_of(errors.location);
    const Vector3d p = R.transpose() * P.p_WT - t, k = R.transpose() * P.k_W;
    P.p_WT = R * (turned(a.axis, m.cosine, m.sine, p) + t);
    P.k_W = R * turned(a.axis, m.cosine, m.sine, k);
  }
  if (a.side == Side::workpiece) apply_component_errors<kWithAxis>(errors, q, P);
  P.p_WT += a.centre;
}

// Takes the true tool, and the ideal one if asked for, from the spindle to the frame before
// `first_axis`. Without the tool axis k_W is left meaningless.
template <bool kWithAxis>
void VolumetricModel::move_through(std::size_t first_axis, const Joints& Q, ToolPose& P_true,
                                   ToolPose* P) const {
  for (std::size_t i = chain_.axes.size(); i-- > first_axis;) {
    const ChainAxis& a = chain_.axes[i];
    const double q = Q[a.joint];
    const JointMotion m = motion_at(a, q);
    if (errors_[i].is_zero()) {
      apply(a, m, P_true);
    } else {
      apply_with_errors<kWithAxis>(a, errors_[i], q, m, P_true);
    }
    if (P != nullptr) apply(a, m, *P);
  }
}

ToolPose VolumetricModel::forward(const Joints& Q, const Vector3d& p_ST) const {
  ToolPose P{p_ST, Vector3d::UnitZ()};
  move_through<true>(0, Q, P, nullptr);
  return P;
}

VolumetricError VolumetricModel::error(const Joints& Q, const Vector3d& p_ST) const {
  ToolPose P{p_ST, Vector3d::UnitZ()}, P_true = P;
  move_through<true>(0, Q, P_true, &P);
  return {P_true.p_WT - P.p_WT, P_true.k_W - P.k_W};
}

VolumetricError VolumetricModel::first_order_error(const Joints& Q, const Vector3d& p_ST) const {
  ToolPose P{p_ST, Vector3d::UnitZ()};
  VolumetricError sum;
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const Screw component = values(errors_[i], Q[a.joint]);
    const JointMotion m = motion_at(a, Q[a.joint]);
    const auto add_screw = [&](const Screw& screw) {
      sum.dp_W += shift_of(screw) + turn_of(screw).cross(P.p_WT - a.centre);
      sum.dk_W += turn_of(screw).cross(P.k_W);
    };
    // L J L^-1 = J + dL J - J dL: the location error at the tool behind and before the joint
    if (a.side == Side::tool) add_screw(component);
    add_screw(-errors_[i].location);
    apply(a, m, P);
    if (!is_linear(a.axis)) {
      sum.dp_W = turned(a.axis, m.cosine, m.sine, sum.dp_W);
      sum.dk_W = turned(a.axis, m.cosine, m.sine, sum.dk_W);
    }
    add_screw(errors_[i].location);
    if (a.side == Side::workpiece) add_screw(component);
  }
  return sum;
}

Vector3d VolumetricModel::joint_offset(const Joints& Q, const Vector3d& p_ST) const {
  if (!linear_axes_are_orthogonal_) {
    return least_squares(linear_jacobian(chain_, Q), error(Q, p_ST).dp_W).x;
  }
  // Rotary axes without errors before the linear ones turn the shift there and back.
  ToolPose P{p_ST, Vector3d::UnitZ()}, P_true = P;
  move_through<false>(faultless_, Q, P_true, &P);
  Vector3d d = P_true.p_WT - P.p_WT;
  for (std::size_t i = faultless_; !is_linear(chain_.axes[i].axis); ++i) {
    const JointMotion m = motion_at(chain_.axes[i], Q[chain_.axes[i].joint]);
    d = turned(chain_.axes[i].axis, m.cosine, -m.sine, d);
  }
  return d;
}

PoseJacobian VolumetricModel::jacobian(const Joints& Q, const Vector3d& p_ST) const {
  PoseAndJacobian tool{{p_ST, Vector3d::UnitZ()}, {}};
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const Prepared& errors = errors_[i];
    const JointMotion m = motion_at(a, Q[a.joint]);
    const Screw e = values(errors, Q[a.joint]), de = derivatives(errors, Q[a.joint]);
    const auto apply_components = [&] {
      const Rotation R(turn_of(e));
      tool.turn(R.matrix());
      tool.turn_with(a.joint, R.velocity(turn_of(de)));
      tool.shift(shift_of(e));
      tool.move_with(a.joint, shift_of(de));
    };
    tool.shift(-a.centre);
    if (a.side == Side::tool) apply_components();
    // L^-1
    tool.turn(errors.R_location.transpose());
    tool.shift(-shift_of(errors.location));
    // J(q)
    const Vector3d direction = unit_vector(a.axis);
    if (is_linear(a.axis)) {
      tool.shift(m.shift * direction);
      tool.move_with(a.joint, direction);
    } else {
      Matrix3d R;
      for (int n = 0; n < 3; ++n) {
        R.col(n) = turned(a.axis, m.cosine, m.sine, Vector3d::Unit(n));
      }
      tool.turn(R);
      tool.turn_with(a.joint, a.sense == Sense::table ? Vector3d(-direction) : direction);
    }
    // L
    tool.shift(shift_of(errors.location));
    tool.turn(errors.R_location);
    if (a.side == Side::workpiece) apply_components();
    tool.shift(a.centre);
  }
  return tool.J;
}

std::optional<Joints> VolumetricModel::inverse(const Vector3d& p_WT, const Joints& Q_near,
                                               const Vector3d& p_ST) const {
  Joints Q = Q_near;
  for (int step = 0; step <= kMaxNewtonSteps; ++step) {
    const Vector3d miss = p_WT - forward(Q, p_ST).p_WT;
    if (miss.norm() <= kInverseTolerance) return Q;
    const LeastSquares move = least_squares(jacobian(Q, p_ST).J_pQ.leftCols<3>(), miss);
    if (move.rank < number_of_linear_axes(chain_) || !move.x.allFinite()) return std::nullopt;
    Q.head<kLinearJoints>() += move.x;
  }
  return std::nullopt;
}

ToolPose forward(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                 const Vector3d& p_ST) {
  return VolumetricModel(chain, errors).forward(Q, p_ST);
}

VolumetricError volumetric_error(const MachineChain& chain, const ErrorModel& errors,
                                 const Joints& Q, const Vector3d& p_ST) {
  return VolumetricModel(chain, errors).error(Q, p_ST);
}

VolumetricError first_order_volumetric_error(const MachineChain& chain, const ErrorModel& errors,
                                             const Joints& Q, const Vector3d& p_ST) {
  return VolumetricModel(chain, errors).first_order_error(Q, p_ST);
}

std::optional<Joints> nonideal_inverse(const MachineChain& chain, const ErrorModel& errors,
                                       const Vector3d& p_WT, const Joints& Q_near,
                                       const Vector3d& p_ST) {
  return VolumetricModel(chain, errors).inverse(p_WT, Q_near, p_ST);
}

Vector3d joint_offset(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                      const Vector3d& p_ST) {
  return VolumetricModel(chain, errors).joint_offset(Q, p_ST);
}

}  // namespace servomill::plant
