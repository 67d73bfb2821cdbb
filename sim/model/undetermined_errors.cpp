#include "sim/model/undetermined_errors.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/geometry/error_function.h"
#include "plant/geometry/error_model.h"
#include "sim/model/tip_uncertainty.h"

namespace servomill::sim::model {

using plant::ErrorName;

bool is_of_model(const std::shared_ptr<const UncertainErrors>& identified,
                 const std::string& model) {
  return identified && identified->model == model;
}

std::string list_of(const std::vector<ErrorName>& names) {
  std::vector<std::string> out;
  for (const ErrorName& name : names) out.push_back(to_string(name));
  return fmt::format("{}", fmt::join(out, ", "));
}

std::vector<ErrorName> components_of(const JointLayout& layout, Axis axis) {
  std::vector<ErrorName> out;
  for (const Axis direction : kAllAxes) {
    const ErrorName name{direction, axis, false};
    if (!plant::why_meaningless(name, layout)) out.push_back(name);
  }
  return out;
}

std::vector<ErrorName> undetermined_errors(const plant::ErrorModel& errors,
                                           const UncertainErrors& identified,
                                           const JointLayout& layout) {
  const auto is_identified = [&](const ErrorName& name) {
    return std::any_of(identified.parts.begin(), identified.parts.end(), [&](const auto& number) {
      return std::any_of(number.begin(), number.end(),
                         [&](const UncertainPart& part) { return part.name == name; });
    });
  };
  std::vector<ErrorName> out;
  for (const auto& [usual, other] : kSquarenesses) {
    const bool is_there = layout.joint_of(usual.axis) && layout.joint_of(other.axis);
    const bool is_known = is_identified(usual) || is_identified(other) ||
                          errors.location(usual) != 0.0 || errors.location(other) != 0.0;
    if (is_there && !is_known) out.push_back(usual);
  }
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    for (const ErrorName& name : components_of(layout, axis)) {
      const bool is_zero = errors.component(name) == plant::ErrorFunction();
      if (is_zero && !is_identified(name)) out.push_back(name);
    }
  }
  return out;
}

}  // namespace servomill::sim::model
