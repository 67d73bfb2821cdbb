#include "plant/geometry/volumetric.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Exponential of [e]x: Rot v = v + a e x v + b e x (e x v), and its left Jacobian, which gives the
// angular velocity e' + b e x e' + c e x (e x e').
class Rotation {
 public:
  explicit Rotation(const Vector3d& e) : e_(e) {
    const double t2 = e.squaredNorm();
    if (t2 < kSeries) {
      a_ = 1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0));
      b_ = 0.5 - t2 / 24.0 * (1.0 - t2 / 30.0 * (1.0 - t2 / 56.0));
      c_ = 1.0 / 6.0 - t2 / 120.0 * (1.0 - t2 / 42.0 * (1.0 - t2 / 72.0));
    } else {
      const double t = std::sqrt(t2);
      a_ = std::sin(t) / t;
      b_ = (1.0 - std::cos(t)) / t2;
      c_ = (1.0 - a_) / t2;
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
    const Vector3d ed = e_.cross(de);
    return de + b_ * ed + c_ * e_.cross(ed);
  }

 private:
  static constexpr double kSeries = 1e-3;  // rad^2: the next term is below 1e-17
  Vector3d e_;
  double a_, b_, c_;
};

Vector3d shift_of(const AxisWords& errors) { return errors.head<3>(); }
Vector3d turn_of(const AxisWords& errors) { return errors.tail<3>(); }

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
}

VolumetricModel::Prepared VolumetricModel::prepare(const ChainAxis& axis,
                                                   const ErrorModel& errors) {
  Prepared out;
  for (const Axis direction : kAllAxes) {
    const int d = index_of(direction);
    const ErrorFunction& f = errors.component({direction, axis.axis, false});
    if (f.is_zero()) continue;
    out.has_components = true;
    out.has_angles = out.has_angles || !is_linear(direction);
    out.polynomial.resize(std::max(out.polynomial.size(), f.polynomial.size()), AxisWords::Zero());
    for (std::size_t i = 0; i < f.polynomial.size(); ++i) out.polynomial[i][d] = f.polynomial[i];
    for (const Harmonic& h : f.harmonics) out.harmonics.push_back({d, h});
    for (const LinearTable& t : f.tables) out.tables.push_back({d, t});
  }
  out.location = errors.locations[static_cast<std::size_t>(index_of(axis.axis))];
  out.has_location = !out.location.isZero(0.0);
  out.R_location = Rotation(turn_of(out.location)).matrix();
  return out;
}

AxisWords VolumetricModel::values(const Prepared& errors, double q) {
  AxisWords e = AxisWords::Zero();
  for (std::size_t i = errors.polynomial.size(); i-- > 0;) e = e * q + errors.polynomial[i];
  for (const auto& h : errors.harmonics) e[h.direction] += h.function.value(q);
  for (const auto& t : errors.tables) e[t.direction] += t.function.value(q);
  return e;
}

AxisWords VolumetricModel::derivatives(const Prepared& errors, double q) {
  AxisWords e = AxisWords::Zero();
  for (std::size_t i = errors.polynomial.size(); i-- > 1;) {
    e = e * q + static_cast<double>(i) * errors.polynomial[i];
  }
  for (const auto& h : errors.harmonics) e[h.direction] += h.function.derivative(q);
  for (const auto& t : errors.tables) e[t.direction] += t.function.derivative(q);
  return e;
}

void VolumetricModel::apply_component_errors(const Prepared& errors, double q, ToolPose& P) {
  if (!errors.has_components) return;
  const AxisWords e = values(errors, q);
  if (errors.has_angles) {
    const Rotation R(turn_of(e));
    P.p_WT = R * P.p_WT;
    P.k_W = R * P.k_W;
  }
  P.p_WT += shift_of(e);
}

void VolumetricModel::apply_with_errors(const ChainAxis& a, const Prepared& errors, double q,
                                        const JointMotion& m, ToolPose& P) {
  P.p_WT -= a.centre;
  if (a.side == Side::tool) apply_component_errors(errors, q, P);
  // L^-1
  if (errors.has_location) {
    P.p_WT = errors.R_location.transpose() * P.p_WT - shift_of(errors.location);
    P.k_W = errors.R_location.transpose() * P.k_W;
  }
  // J(q), now about the origin
  if (is_linear(a.axis)) {
    P.p_WT[index_of(a.axis)] += m.shift;
  } else {
    P.p_WT = turned(a.axis, m.cosine, m.sine, P.p_WT);
    P.k_W = turned(a.axis, m.cosine, m.sine, P.k_W);
  }
  // L
  if (errors.has_location) {
    P.p_WT = errors.R_location * (P.p_WT + shift_of(errors.location));
    P.k_W = errors.R_location * P.k_W;
  }
  if (a.side == Side::workpiece) apply_component_errors(errors, q, P);
  P.p_WT += a.centre;
}

VolumetricModel::Motions VolumetricModel::motions_at(const Joints& Q) const {
  Motions motions;
  for (std::size_t i = 0; i < chain_.axes.size(); ++i) {
    motions[i] = motion_at(chain_.axes[i], Q[chain_.axes[i].joint]);
  }
  return motions;
}

ToolPose VolumetricModel::ideal_pose(const Motions& motions, const Vector3d& p_ST) const {
  ToolPose P{p_ST, Vector3d::UnitZ()};
  for (std::size_t i = chain_.axes.size(); i-- > 0;) apply(chain_.axes[i], motions[i], P);
  return P;
}

ToolPose VolumetricModel::true_pose(const Joints& Q, const Motions& motions,
                                    const Vector3d& p_ST) const {
  ToolPose P{p_ST, Vector3d::UnitZ()};
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    if (errors_[i].has_components || errors_[i].has_location) {
      apply_with_errors(a, errors_[i], Q[a.joint], motions[i], P);
    } else {
      apply(a, motions[i], P);
    }
  }
  return P;
}

ToolPose VolumetricModel::forward(const Joints& Q, const Vector3d& p_ST) const {
  return true_pose(Q, motions_at(Q), p_ST);
}

VolumetricError VolumetricModel::error(const Joints& Q, const Vector3d& p_ST) const {
  const Motions motions = motions_at(Q);
  const ToolPose P_true = true_pose(Q, motions, p_ST), P = ideal_pose(motions, p_ST);
  return {P_true.p_WT - P.p_WT, P_true.k_W - P.k_W};
}

VolumetricError VolumetricModel::first_order_error(const Joints& Q, const Vector3d& p_ST) const {
  const Motions motions = motions_at(Q);
  ToolPose P{p_ST, Vector3d::UnitZ()};
  VolumetricError sum;
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const AxisWords component = values(errors_[i], Q[a.joint]);
    const auto add_screw = [&](const AxisWords& screw) {
      sum.dp_W += shift_of(screw) + turn_of(screw).cross(P.p_WT - a.centre);
      sum.dk_W += turn_of(screw).cross(P.k_W);
    };
    // L J L^-1 = J + dL J - J dL: the location error at the tool behind and before the joint
    if (a.side == Side::tool) add_screw(component);
    add_screw(-errors_[i].location);
    apply(a, motions[i], P);
    if (!is_linear(a.axis)) {
      sum.dp_W = turned(a.axis, motions[i].cosine, motions[i].sine, sum.dp_W);
      sum.dk_W = turned(a.axis, motions[i].cosine, motions[i].sine, sum.dk_W);
    }
    add_screw(errors_[i].location);
    if (a.side == Side::workpiece) add_screw(component);
  }
  return sum;
}

Vector3d VolumetricModel::joint_offset(const Joints& Q, const Vector3d& p_ST) const {
  const Motions motions = motions_at(Q);
  Vector3d d = true_pose(Q, motions, p_ST).p_WT - ideal_pose(motions, p_ST).p_WT;
  if (!linear_axes_are_orthogonal_) return least_squares(linear_jacobian(chain_, Q), d).x;
  // Undo the rotations between the workpiece and the linear axes.
  for (std::size_t i = 0; !is_linear(chain_.axes[i].axis); ++i) {
    d = turned(chain_.axes[i].axis, motions[i].cosine, -motions[i].sine, d);
  }
  return d;
}

PoseJacobian VolumetricModel::jacobian(const Joints& Q, const Vector3d& p_ST) const {
  const Motions motions = motions_at(Q);
  PoseAndJacobian tool{{p_ST, Vector3d::UnitZ()}, {}};
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const Prepared& errors = errors_[i];
    const AxisWords e = values(errors, Q[a.joint]), de = derivatives(errors, Q[a.joint]);
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
      tool.shift(motions[i].shift * direction);
      tool.move_with(a.joint, direction);
    } else {
      Matrix3d R;
      for (int n = 0; n < 3; ++n) {
        R.col(n) = turned(a.axis, motions[i].cosine, motions[i].sine, Vector3d::Unit(n));
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
