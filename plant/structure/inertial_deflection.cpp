#include "plant/structure/inertial_deflection.h"

#include <cassert>

namespace servomill::plant {

InertialDeflection::InertialDeflection(const std::vector<InertialCompliance>& pairs,
                                       double base_period, const std::vector<Tick>& steps)
    : base_period_(base_period) {
  for (const InertialCompliance& pair : pairs) {
    if (pair.is_static()) {
      static_.push_back(pair);
    } else {
      modes_.push_back({pair, {}});
    }
  }
  for (const Tick step : steps) {
    const auto n = static_cast<std::size_t>(step);
    if (n >= first_of_step_.size()) first_of_step_.resize(n + 1, -1);
    if (first_of_step_[n] >= 0) continue;
    first_of_step_[n] = static_cast<int>(steps_.size());
    const double h = static_cast<double>(step) * base_period;
    for (const Resonance& one : modes_) steps_.push_back(mode_step(one.pair.mode, h));
  }
}

void InertialDeflection::start(const Joints& Q) {
  Q_ = Q;
  dQ_.setZero();
  for (Resonance& one : modes_) one.state = {};
}

void InertialDeflection::advance(const Joints& Q, const Joints& dQ, Tick step) {
  assert(static_cast<std::size_t>(step) < first_of_step_.size());
  const int first = first_of_step_[static_cast<std::size_t>(step)];
  assert(first >= 0);
  const double h = static_cast<double>(step) * base_period_;
  const Joints dv = dQ - dQ_, dx = (Q - Q_) - h * dQ_;
  const ModeStep* next = steps_.data() + first;
  for (Resonance& one : modes_) {
    const int j = one.pair.joint;
    one.state = next++->from(one.state, {dv[j], dx[j]});
  }
  Q_ = Q;
  dQ_ = dQ;
}

Eigen::Vector3d InertialDeflection::at(const Joints& ddQ) const {
  Eigen::Vector3d e = Eigen::Vector3d::Zero();
  for (const InertialCompliance& pair : static_) {
    e[pair.direction] -= pair.gain_at(Q_) * ddQ[pair.joint];
  }
  for (const Resonance& one : modes_) {
    e[one.pair.direction] += one.pair.gain_at(Q_) * one.state.eta;
  }
  return e;
}

}  // namespace servomill::plant
