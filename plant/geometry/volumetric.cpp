#include "plant/geometry/volumetric.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "plant/geometry/rotation_vector.h"
#include "plant/geometry/volumetric_evaluation.h"

namespace servomill::plant {
namespace {

// One tool, one error after the other without gaps: the kernel writes numbers.
static_assert(sizeof(ToolPose) == 6 * sizeof(double));
static_assert(sizeof(VolumetricError) == 6 * sizeof(double));

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Places of a screw: three shifts, a gap of one, three rotations, so that each triple begins a
// register of four.
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
    : chain_(chain),
      linear_axes_are_orthogonal_(has_orthogonal_linear_axes(chain)),
      evaluation_(std::make_shared<const VolumetricEvaluation>(chain, errors)) {
  for (const ChainAxis& a : chain_.axes) errors_.push_back(prepare(a, errors));
}

VolumetricModel::Prepared VolumetricModel::prepare(const ChainAxis& axis,
                                                   const ErrorModel& errors) const {
  Prepared out;
  out.joint = axis.joint;
  out.joints = {axis.joint};
  for (const Axis direction : kAllAxes) {
    const int lane = lane_of(direction);
    const ErrorFunction& f = errors.component({direction, axis.axis, false});
    if (f.is_zero()) continue;
    // All six directions of an axis share one Horner scheme, of the highest degree among them.
    out.polynomial.resize(std::max(out.polynomial.size(), f.polynomial.size()), Screw::Zero());
    for (std::size_t i = 0; i < f.polynomial.size(); ++i) out.polynomial[i][lane] = f.polynomial[i];
    for (const Harmonic& h : f.harmonics) {
      const bool same_wave = !out.harmonics.empty() && out.harmonics.back().omega == h.omega() &&
                             out.harmonics.back().phase == h.phase;
      out.harmonics.push_back({lane, h.amplitude, h.omega(), h.phase, same_wave});
    }
    for (const LinearTable& t : f.tables) out.tables.push_back({lane, t});
    for (const Reversal& r : f.reversals) {
      if (r.is_zero()) continue;
      const auto play = std::find(plays().begin(), plays().end(), Play{axis.joint, r.distance});
      out.reversals.push_back({lane, static_cast<std::size_t>(play - plays().begin()), r});
    }
    for (const GridFunction& g : f.grids) {
      auto& grid = out.grids.emplace_back(Prepared::PreparedGrid{lane, {}, g});
      for (const Axis a : g.axes()) {
        const int joint = chain_.layout.joint_of(a).value();
        grid.joints.push_back(joint);
        const auto end = out.joints.end();
        if (std::find(out.joints.begin(), end, joint) == end) out.joints.push_back(joint);
      }
    }
  }
  for (const Axis direction : kAllAxes) {
    out.location[lane_of(direction)] = errors.location({direction, axis.axis, true});
  }
  out.R_location = TurnOf(turn_of(out.location)).matrix();
  return out;
}

namespace {

using GridArguments = std::array<double, GridFunction::kMaxArguments>;

std::span<const double> arguments_at(const std::vector<int>& joints, const Joints& Q,
                                     GridArguments& out) {
  for (std::size_t k = 0; k < joints.size(); ++k) out[k] = Q[joints[k]];
  return std::span(out).first(joints.size());
}

}  // namespace

VolumetricModel::Screw VolumetricModel::values(const Prepared& errors, const Joints& Q) {
  const double q = Q[errors.joint];
  Screw e = Screw::Zero();
  for (std::size_t i = errors.polynomial.size(); i-- > 0;) e = e * q + errors.polynomial[i];
  double sine = 0.0;
  for (const auto& h : errors.harmonics) {
    if (!h.same_wave) sine = std::sin(h.omega * q + h.phase);
    e[h.lane] += h.amplitude * sine;
  }
  for (const auto& t : errors.tables) e[t.lane] += t.table.value(q);
  GridArguments at;
  for (const auto& g : errors.grids) e[g.lane] += g.function.value(arguments_at(g.joints, Q, at));
  return e;
}

VolumetricModel::Screw VolumetricModel::derivatives(const Prepared& errors, const Joints& Q,
                                                    int joint) {
  Screw e = Screw::Zero();
  if (joint == errors.joint) e = derivatives_of_axis(errors, Q[joint]);
  GridArguments at;
  for (const auto& g : errors.grids) {
    const auto by = std::find(g.joints.begin(), g.joints.end(), joint);
    if (by == g.joints.end()) continue;
    e[g.lane] += g.function.derivative(arguments_at(g.joints, Q, at),
                                       static_cast<std::size_t>(by - g.joints.begin()));
  }
  return e;
}

VolumetricModel::Screw VolumetricModel::derivatives_of_axis(const Prepared& errors, double q) {
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

VolumetricModel::Screw VolumetricModel::reversals(const Prepared& errors, double q,
                                                  std::span<const double> directions) {
  Screw e = Screw::Zero();
  for (const auto& r : errors.reversals) {
    // half of the width to either side of the error without reversal
    e[r.lane] += 0.5 * directions[r.play] * r.reversal.value(q);
  }
  return e;
}

ToolPose VolumetricModel::forward(const Joints& Q, const Vector3d& p_ST) const {
  ToolPose P;
  evaluation_->tool(Q, p_ST, P.p_WT.data());
  return P;
}

VolumetricError VolumetricModel::error(const Joints& Q, const Vector3d& p_ST) const {
  VolumetricError e;
  evaluation_->error(Q, p_ST, e.dp_W.data());
  return e;
}

void VolumetricModel::poses(std::span<const Joints> Q, const Vector3d& p_ST,
                            std::span<ToolPose> out) const {
  assert(out.size() == Q.size());
  if (!Q.empty()) evaluation_->tools(Q, p_ST, out.front().p_WT.data());
}

void VolumetricModel::errors(std::span<const Joints> Q, const Vector3d& p_ST,
                             std::span<VolumetricError> out) const {
  assert(out.size() == Q.size());
  if (!Q.empty()) evaluation_->errors(Q, p_ST, out.front().dp_W.data());
}

const std::vector<Play>& VolumetricModel::plays() const { return evaluation_->plays(); }

ToolPose VolumetricModel::forward(const Joints& Q, const Vector3d& p_ST,
                                  std::span<const double> directions) const {
  ToolPose P;
  evaluation_->tool(Q, p_ST, directions, P.p_WT.data());
  return P;
}

VolumetricError VolumetricModel::error(const Joints& Q, const Vector3d& p_ST,
                                       std::span<const double> directions) const {
  VolumetricError e;
  evaluation_->error(Q, p_ST, directions, e.dp_W.data());
  return e;
}

void VolumetricModel::poses(std::span<const Joints> Q, const Vector3d& p_ST,
                            std::span<const double> directions, std::span<ToolPose> out) const {
  const std::size_t each = plays().size();
  assert(out.size() == Q.size() && directions.size() == each * Q.size());
  for (std::size_t n = 0; n < Q.size(); ++n) {
    out[n] = forward(Q[n], p_ST, directions.subspan(n * each, each));
  }
}

VolumetricError VolumetricModel::first_order_error(const Joints& Q, const Vector3d& p_ST) const {
  return first_order(Q, p_ST, [&Q](const Prepared& e) { return values(e, Q); });
}

VolumetricError VolumetricModel::first_order_error(const Joints& Q, const Vector3d& p_ST,
                                                   std::span<const double> directions) const {
  return first_order(Q, p_ST, [&Q, directions](const Prepared& e) -> Screw {
    return values(e, Q) + reversals(e, Q[e.joint], directions);
  });
}

template <class Values>
VolumetricError VolumetricModel::first_order(const Joints& Q, const Vector3d& p_ST,
                                             Values values_at) const {
  // From the tool back along the chain: each error acts with its lever arm to the TCP, which the
  // joints between them determine.
  ToolPose P{p_ST, Vector3d::UnitZ()};
  VolumetricError sum;
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const Screw component = values_at(errors_[i]);
    const JointMotion m = motion_at(a, Q[a.joint]);
    const auto add_screw = [&](const Screw& screw) {
      const Vector3d shift = a.R_MA * shift_of(screw), turn = a.R_MA * turn_of(screw);
      sum.dp_W += shift + turn.cross(P.p_WT - a.centre);
      sum.dk_W += turn.cross(P.k_W);
    };
    // L J L^-1 = J + dL J - J dL: the location error at the tool behind and before the joint
    if (a.side == Side::tool) add_screw(component);
    add_screw(-errors_[i].location);
    apply(a, m, P);
    if (!is_linear(a.axis)) {
      sum.dp_W = turned(a, m, sum.dp_W);
      sum.dk_W = turned(a, m, sum.dk_W);
    }
    add_screw(errors_[i].location);
    if (a.side == Side::workpiece) add_screw(component);
  }
  return sum;
}

Vector3d VolumetricModel::joint_offset(const Joints& Q, const Vector3d& p_ST) const {
  Vector3d d;
  if (evaluation_->is_plain()) {
    evaluation_->plain_offset(Q, p_ST, d.data());
  } else {
    find_offset(Q, p_ST, d);
  }
  return d;
}

void VolumetricModel::find_offset(const Joints& Q, const Vector3d& p_ST, Vector3d& d) const {
  // A projection onto orthogonal axes is the solution; otherwise (inclined axes, or a missing one)
  // that of least squares.
  if (linear_axes_are_orthogonal_) {
    evaluation_->offset(Q, p_ST, d.data());
  } else {
    d = least_squares(linear_jacobian(chain_, Q), error(Q, p_ST).dp_W).x;
  }
}

void VolumetricModel::joint_offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                    std::span<Vector3d> out) const {
  assert(out.size() == Q.size());
  constexpr std::size_t kFew = 2;  // sooner done one by one
  if (linear_axes_are_orthogonal_ && Q.size() > kFew) {
    evaluation_->offsets(Q, p_ST, out.front().data());
  } else {
    for (std::size_t n = 0; n < Q.size(); ++n) out[n] = joint_offset(Q[n], p_ST);
  }
}

void VolumetricModel::joint_offsets(const LaneArray (&Q)[kJoints], const Vector3d& p_ST,
                                    LaneArray (&out)[kLinearJoints]) const {
  if (linear_axes_are_orthogonal_) {
    evaluation_->offsets(Q, p_ST, out);
    return;
  }
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    Joints at;
    for (int j = 0; j < kJoints; ++j) at[j] = Q[j][lane];
    const Vector3d d = joint_offset(at, p_ST);
    for (int i = 0; i < kLinearJoints; ++i) out[i][lane] = d[i];
  }
}

PoseJacobian VolumetricModel::jacobian(const Joints& Q, const Vector3d& p_ST) const {
  PoseAndJacobian tool{{p_ST, Vector3d::UnitZ()}, {}};
  for (std::size_t i = chain_.axes.size(); i-- > 0;) {
    const ChainAxis& a = chain_.axes[i];
    const Prepared& errors = errors_[i];
    const JointMotion m = motion_at(a, Q[a.joint]);
    const Screw e = values(errors, Q);
    // Product rule of the error motion: as R and the shift depend on q themselves, they carry a
    // velocity of their own.
    const auto apply_components = [&] {
      const TurnOf R(turn_of(e));
      tool.turn(R.matrix());
      for (const int joint : errors.joints) {
        const Screw de = derivatives(errors, Q, joint);
        tool.turn_with(joint, R.velocity(turn_of(de)));
        tool.move_with(joint, shift_of(de));
      }
      tool.shift(shift_of(e));
    };
    tool.shift(-a.centre);
    if (a.is_inclined) tool.turn(a.R_MA.transpose());
    // Component errors act on the moved side of the joint: towards the tool here, towards the
    // workpiece below.
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
      // Positive C of a table turns the workpiece, hence the tool by -C as the workpiece sees it
      // (ISO 841).
      tool.turn_with(a.joint, a.sense == Sense::table ? Vector3d(-direction) : direction);
    }
    // L
    tool.shift(shift_of(errors.location));
    tool.turn(errors.R_location);
    if (a.side == Side::workpiece) apply_components();
    if (a.is_inclined) tool.turn(a.R_MA);
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
    // Newton with the exact Jacobian. A lost rank: the linear axes of the chain do not span the
    // directions of the miss.
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
