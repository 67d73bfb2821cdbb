#include "strategies/pose_compensation.h"

#include <Eigen/Geometry>
#include <cmath>

#include "plant/vocabulary/tool_axis.h"

namespace servomill::strategies {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kConverged = 1e-13;  // m, rad
constexpr int kMaxIterations = 50;

// One step towards a change of the pose, the derivatives taken once.
class FirstOrder {
 public:
  FirstOrder(const plant::MachineChain& chain, const Joints& Q, const Vector3d& p_ST,
             double sigma_0)
      : J_(plant::jacobian(chain, Q, p_ST)) {
    const Vector3d a = J_.J_kQ.col(3), b = J_.J_kQ.col(4);
    const double mean = 0.5 * (a.squaredNorm() + b.squaredNorm());
    const double half = 0.5 * (a.squaredNorm() - b.squaredNorm());
    const double off = a.dot(b), radius = std::hypot(half, off);
    const double angle = 0.5 * std::atan2(off, half);
    directions_[0] << std::cos(angle), std::sin(angle);
    directions_[1] << -std::sin(angle), std::cos(angle);
    // the smaller as a quotient, which does not cancel
    const double large = mean + radius;
    const double small = large > 0.0 ? a.cross(b).squaredNorm() / large : 0.0;
    for (int i = 0; i < 2; ++i) {
      const double squared = i == 0 ? large : small;  // of the singular value
      const double near = 1.0 - squared / (sigma_0 * sigma_0);
      const double lambda = near > 0.0 ? 0.5 * sigma_0 * near : 0.0;
      damping_[i] = lambda * lambda;
      stiffness_[i] = squared + damping_[i];
    }
  }

  // @param dr  what rotary joints have been turned by already
  Joints step(const Vector3d& s_p, const Vector3d& s_k, const Vector2d& dr) const {
    const Vector2d pull = J_.J_kQ.rightCols<2>().transpose() * s_k;
    Vector2d turn = Vector2d::Zero();
    for (int i = 0; i < 2; ++i) {
      const Vector2d& v = directions_[i];
      turn += v * ((v.dot(pull) - damping_[i] * v.dot(dr)) / stiffness_[i]);
    }
    const Matrix3d J_pl = J_.J_pQ.leftCols<3>();
    Joints out;
    out << plant::least_squares(J_pl, s_p - J_.J_pQ.rightCols<2>() * turn).x, turn;
    return out;
  }

 private:
  plant::PoseJacobian J_;
  Vector2d directions_[2];  // of the rotary joints: that which matters more, less
  double damping_[2], stiffness_[2];
};

}  // namespace

PoseCompensation::PoseCompensation(const IdentifiedMachine& identified, Iterations iterations,
                                   double sigma_0)
    : identified_(identified), iterations_(iterations), sigma_0_(sigma_0) {}

Joints PoseCompensation::of_setpoint(Action action, const Joints& Q) const {
  return displacement(action == Action::impose ? Wanted::errors : Wanted::removal, Q);
}

Joints PoseCompensation::of_feedback(Action action, const Joints& Q) const {
  return displacement(action == Action::compensate ? Wanted::errors : Wanted::removal, Q);
}

Joints PoseCompensation::displacement(Wanted wanted, const Joints& Q) const {
  const plant::VolumetricModel& model = identified_.model;
  const plant::MachineChain& chain = model.chain();
  const FirstOrder first(chain, Q, identified_.p_ST, sigma_0_);
  const plant::VolumetricError error = model.error(Q, identified_.p_ST);
  const double sign = wanted == Wanted::errors ? 1.0 : -1.0;
  Joints d = first.step(sign * error.dp_W, sign * error.dk_W, Vector2d::Zero());
  if (iterations_ == Iterations::one) return d;

  const ToolPose at_Q = plant::forward(chain, Q, identified_.p_ST);
  ToolPose goal = at_Q;
  if (wanted == Wanted::errors) {
    goal.p_WT += error.dp_W;
    goal.k_W += error.dk_W;
  }
  for (int n = 0; n < kMaxIterations; ++n) {
    const Joints shifted = Q + d;
    const ToolPose now = wanted == Wanted::errors ? plant::forward(chain, shifted, identified_.p_ST)
                                                  : model.forward(shifted, identified_.p_ST);
    const Joints step = first.step(goal.p_WT - now.p_WT, goal.k_W - now.k_W, d.tail<2>());
    d += step;
    if (step.cwiseAbs().maxCoeff() < kConverged) break;
  }
  return d;
}

Residual PoseCompensation::residual(const Joints& Q, const Joints& d) const {
  const ToolPose wanted = plant::forward(identified_.model.chain(), Q, identified_.p_ST);
  const ToolPose got = identified_.model.forward(Q + d, identified_.p_ST);
  return {(got.p_WT - wanted.p_WT).norm(), angle_between(got.k_W, wanted.k_W)};
}

Joints displacement_for(const plant::MachineChain& chain, const Joints& Q, const Vector3d& p_ST,
                        double sigma_0, const Vector3d& s_p, const Vector3d& s_k) {
  return FirstOrder(chain, Q, p_ST, sigma_0).step(s_p, s_k, Vector2d::Zero());
}

Residual uncorrectable(const IdentifiedMachine& identified, DisplacedAxes axes, double sigma_0,
                       const Joints& Q) {
  const PoseCompensation all(identified, Iterations::converged, sigma_0);
  Joints d = Joints::Zero();
  if (axes == DisplacedAxes::all) {
    d = all.of_setpoint(Action::compensate, Q);
  } else {
    d.head<3>() = setpoint_displacement(identified, Action::compensate, Iterations::converged, Q);
  }
  return all.residual(Q, d);
}

std::optional<Residual> uncorrectable(const IdentifiedMachine& identified, Action action,
                                      DisplacedAxes axes, double sigma_0, const Joints& Q) {
  if (action != Action::compensate) return std::nullopt;
  return uncorrectable(identified, axes, sigma_0, Q);
}

}  // namespace servomill::strategies
