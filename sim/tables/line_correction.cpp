#include "sim/tables/line_correction.h"

#include <algorithm>
#include <cmath>

#include "plant/geometry/travelling_errors.h"
#include "strategies/axis_displacement.h"

namespace servomill::sim::tables {
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

bool has_reversals(const plant::ErrorModel& errors, Axis axis) {
  return std::any_of(kAllAxes.begin(), kAllAxes.end(), [&](Axis direction) {
    return !errors.component({direction, axis, false}).reversals.empty();
  });
}

}  // namespace

double component_on_line(const TableSource& source, const plant::ErrorName& name, double q,
                         double direction) {
  const plant::ErrorFunction& f = source.errors.component(name);
  AxisWords words = source.chain.layout.words(source.reference);
  words[index_of(name.axis)] = q;
  const double mean = f.value(q, words);
  return f.reversals.empty() ? mean : mean + 0.5 * direction * f.width(q);
}

LineCorrection::LineCorrection(const TableSource& source)
    : source_(source), identified_(identified_of(source.errors)) {
  base_.head<kLinearJoints>() = linear_at(identified_, source.reference);
  for (int j = 0; j < kJoints; ++j) {
    if (!source.chain.layout.has(j)) continue;
    if (j >= kLinearJoints) {
      base_[j] = rotary_at(j, source.reference[j], 0);
    } else if (depends_on_direction(j)) {
      const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(j)];
      auto& [down, up] = directed_[static_cast<std::size_t>(j)];
      down = identified_of(plant::travelling(source.errors, axis, -1));
      up = identified_of(plant::travelling(source.errors, axis, 1));
    }
  }
}

strategies::IdentifiedMachine LineCorrection::identified_of(const plant::ErrorModel& errors) const {
  return {.layout = source_.chain.layout,
          .model = {source_.chain, without_rotary_positioning(errors)},
          .p_ST = source_.p_ST,
          .reference = source_.reference};
}

const strategies::IdentifiedMachine& LineCorrection::identified(int joint, int direction) const {
  if (direction == 0 || !depends_on_direction(joint)) return identified_;
  return *directed_[static_cast<std::size_t>(joint)][direction > 0 ? 1 : 0];
}

bool LineCorrection::depends_on_direction(int joint) const {
  const Axis axis = *source_.chain.layout.axis[static_cast<std::size_t>(joint)];
  if (is_linear(axis)) return has_reversals(source_.errors, axis);
  return !source_.errors.component({axis, axis, false}).reversals.empty();
}

Eigen::Vector3d LineCorrection::linear_at(const strategies::IdentifiedMachine& identified,
                                          const Joints& Q) const {
  return strategies::setpoint_displacement(identified, strategies::Action::compensate,
                                           strategies::Iterations::converged, Q);
}

double LineCorrection::rotary_at(int joint, double q, int direction) const {
  const Axis axis = *source_.chain.layout.axis[static_cast<std::size_t>(joint)];
  // the coordinate may count the other way than the error does
  const double sign = source_.chain.at(axis).sense == plant::Sense::table ? -1.0 : 1.0;
  double d = 0.0;
  constexpr int kIterations = 20;  // contraction by the slope of the error, far below 1
  for (int n = 0; n < kIterations; ++n) {
    d = -sign * component_on_line(source_, {axis, axis, false}, q + d, direction);
  }
  return d;
}

Joints LineCorrection::over(int joint, double q, int direction) const {
  Joints d = Joints::Zero();
  if (joint < kLinearJoints) {
    Joints Q = source_.reference;
    Q[joint] = q;
    d.head<kLinearJoints>() =
        linear_at(identified(joint, direction), Q) - base_.head<kLinearJoints>();
  } else {
    d[joint] = rotary_at(joint, q, direction) - base_[joint];
  }
  return d;
}

}  // namespace servomill::sim::tables
