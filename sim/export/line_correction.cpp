#include "sim/export/line_correction.h"

#include <cmath>

#include "strategies/compensation.h"

namespace servomill::sim {
namespace {

bool is_rotary_positioning(const plant::ErrorName& name) {
  return !name.is_location && !is_linear(name.axis) && name.direction == name.axis;
}

plant::ErrorModel without_rotary_positioning(plant::ErrorModel errors) {
  for (const Axis a : kAllAxes) {
    const plant::ErrorName name{a, a, false};
    if (is_rotary_positioning(name)) errors.component(name) = {};
  }
  return errors;
}

}  // namespace

LineCorrection::LineCorrection(const TableSource& source)
    : source_(source),
      belief_{.layout = source.chain.layout,
              .model = {source.chain, without_rotary_positioning(source.errors)},
              .p_ST = source.p_ST,
              .reference = source.reference} {
  base_.head<kLinearJoints>() = linear_at(source.reference);
  for (int j = kLinearJoints; j < kJoints; ++j) {
    if (source.chain.layout.has(j)) base_[j] = rotary_at(j, source.reference[j]);
  }
}

Eigen::Vector3d LineCorrection::linear_at(const Joints& Q) const {
  return strategies::set_point_displacement(belief_, strategies::Sign::correct,
                                            strategies::Iterations::converged, Q);
}

double LineCorrection::rotary_at(int joint, double q) const {
  const Axis axis = *source_.chain.layout.axis[static_cast<std::size_t>(joint)];
  // the coordinate may count the other way than the error does
  const double sign = source_.chain.at(axis).sense == plant::Sense::table ? -1.0 : 1.0;
  const plant::ErrorFunction& error = source_.errors.component({axis, axis, false});
  double d = 0.0;
  constexpr int kIterations = 20;  // contraction by the slope of the error, far below 1
  for (int n = 0; n < kIterations; ++n) d = -sign * error.value(q + d);
  return d;
}

Joints LineCorrection::over(int joint, double q) const {
  Joints d = Joints::Zero();
  if (joint < kLinearJoints) {
    Joints Q = source_.reference;
    Q[joint] = q;
    d.head<kLinearJoints>() = linear_at(Q) - base_.head<kLinearJoints>();
  } else {
    d[joint] = rotary_at(joint, q) - base_[joint];
  }
  return d;
}

}  // namespace servomill::sim
