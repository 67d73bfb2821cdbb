#include "strategies/reversal_correction.h"

namespace servomill::strategies {

using Eigen::Vector3d;

ReversalCorrection::ReversalCorrection(const IdentifiedMachine& identified, Action action,
                                       const Joints& Q)
    : identified_(identified), action_(action), memory_(identified.model.plays(), Q) {}

Vector3d ReversalCorrection::displacement(const Joints& Q, const Joints& d_mean) const {
  const plant::VolumetricModel& model = identified_.model;
  const Vector3d mean = model.error(Q, identified_.p_ST).dp_W;
  const Eigen::Matrix3d J = plant::linear_jacobian(model.chain(), Q);
  std::vector<double> directions(memory_.size());
  const auto displacement_at = [&](const Joints& x) {
    memory_.directions(x, directions);
    const Vector3d e = model.error(Q, identified_.p_ST, directions).dp_W - mean;
    const Vector3d d = plant::least_squares(J, e).x;
    return action_ == Action::impose ? d : Vector3d(-d);
  };
  if (action_ == Action::impose) return displacement_at(Q);

  // Lost motion gives a map that rises: from the displacement before, its iterates reach the next
  // fixed point in the direction of travel. Errors of the other sign need damping.
  constexpr int kMaxPasses = 200;
  constexpr double kSettled = 1e-10;  // m
  Vector3d d = last_, step_before = Vector3d::Zero();
  double damping = 1.0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    Joints x = Q + d_mean;
    x.head<kLinearJoints>() += d;
    const Vector3d step = displacement_at(x) - d;
    if (step.dot(step_before) < 0.0) damping *= 0.5;
    d += damping * step;
    if (step.norm() < kSettled) break;
    step_before = step;
  }
  return d;
}

void ReversalCorrection::travel(const Joints& Q, const Joints& d, const Vector3d& displacement) {
  memory_.travel(action_ == Action::impose ? Q : Joints(Q + d));
  last_ = displacement;
}

}  // namespace servomill::strategies
