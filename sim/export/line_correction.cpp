#include "sim/export/line_correction.h"

#include <algorithm>
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

LineCorrection::LineCorrection(const TableSource& source, const std::vector<TableLine>& lines)
    : source_(source),
      belief_{.layout = source.chain.layout,
              .model = {source.chain, without_rotary_positioning(source.errors)},
              .p_ST = source.p_ST,
              .reference = source.reference},
      base_(at(source.reference)) {
  const auto wanted = [&](int joint) {
    return std::any_of(lines.begin(), lines.end(), [joint](const TableLine& line) {
      return line.joint == joint && line.wanted;
    });
  };
  for (int& line : base_line_) {
    for (int other = 0; other < kLinearJoints && !wanted(line); ++other) {
      if (wanted(other)) line = other;
    }
  }
}

Eigen::Vector3d LineCorrection::at(const Joints& Q) const {
  return strategies::set_point_displacement(belief_, strategies::Sign::correct,
                                            strategies::Iterations::converged, Q);
}

Joints LineCorrection::over(int joint, double q) const {
  Joints d = Joints::Zero();
  const Axis axis = *source_.chain.layout.axis[static_cast<std::size_t>(joint)];
  if (is_linear(axis)) {
    Joints Q = source_.reference;
    Q[joint] = q;
    d.head<kLinearJoints>() = at(Q) - base_;
    for (int k = 0; k < kLinearJoints; ++k) {
      if (base_line_[static_cast<std::size_t>(k)] == joint) d[k] += base_[k];
    }
    return d;
  }
  // the coordinate may count the other way than the error does
  const double sign = source_.chain.at(axis).sense == plant::Sense::table ? -1.0 : 1.0;
  const plant::ErrorFunction& error = source_.errors.component({axis, axis, false});
  constexpr int kIterations = 20;  // contraction by the slope of the error, far below 1
  for (int n = 0; n < kIterations; ++n) d[joint] = -sign * error.value(q + d[joint]);
  return d;
}

}  // namespace servomill::sim
