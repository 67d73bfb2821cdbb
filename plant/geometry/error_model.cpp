#include "plant/geometry/error_model.h"

#include <fmt/format.h>

#include <cassert>
#include <vector>

namespace servomill::plant {
namespace {

std::size_t at(Axis axis) { return static_cast<std::size_t>(index_of(axis)); }

std::string axes_of(const JointLayout& layout) {
  std::string text;
  for (const auto& a : layout.axis) {
    if (a) text += fmt::format(" {}", letter(*a));
  }
  return text;
}

// The direction in which a displaced axis lies on itself: X for X and A, ...
bool lies_on_itself(const ErrorName& name) {
  const bool same_line = index_of(name.direction) % 3 == index_of(name.axis) % 3;
  const bool is_shift = is_linear(name.direction);
  return is_linear(name.axis) ? is_shift || same_line : same_line;
}

std::vector<std::string> meaningful_names(const JointLayout& layout) {
  std::vector<std::string> names;
  for (const bool location : {false, true}) {
    for (const Axis axis : kAllAxes) {
      for (const Axis direction : kAllAxes) {
        const ErrorName name{direction, axis, location};
        if (!why_meaningless(name, layout)) names.push_back(to_string(name));
      }
    }
  }
  return names;
}

}  // namespace

std::string to_string(const ErrorName& name) {
  return fmt::format("E{}{}{}", letter(name.direction), name.is_location ? "0" : "",
                     letter(name.axis));
}

std::optional<std::string> why_meaningless(const ErrorName& name, const JointLayout& layout) {
  if (!layout.joint_of(name.axis)) {
    return fmt::format("is an error of axis {}; the machine has{}", letter(name.axis),
                       axes_of(layout));
  }
  if (name.is_location && lies_on_itself(name)) {
    const bool is_zero_position = index_of(name.direction) == index_of(name.axis);
    return fmt::format("has no effect on the motion of {}{}", letter(name.axis),
                       is_zero_position
                           ? fmt::format("; a zero position is a constant {}",
                                         to_string(ErrorName{name.direction, name.axis, false}))
                           : "");
  }
  return std::nullopt;
}

ErrorName parse_error_name(std::string_view text, const JointLayout& layout, const Place& place) {
  const std::optional<ErrorName> name = error_name_of(text);
  if (!name) {
    const std::vector<std::string> names = meaningful_names(layout);
    const std::vector<std::string_view> views(names.begin(), names.end());
    throw InputError(
        place,
        fmt::format("'{}' is not an error of ISO 230-1; expected a name such as EYX or EC0Y{}",
                    text, did_you_mean(text, views)));
  }
  if (const auto why = why_meaningless(*name, layout)) {
    throw InputError(place, fmt::format("{} {}", text, *why));
  }
  return *name;
}

ErrorFunction& ErrorModel::component(const ErrorName& name) {
  assert(!name.is_location);
  return components[at(name.axis)][at(name.direction)];
}

const ErrorFunction& ErrorModel::component(const ErrorName& name) const {
  return const_cast<ErrorModel*>(this)->component(name);
}

double& ErrorModel::location(const ErrorName& name) {
  assert(name.is_location);
  return locations[at(name.axis)][index_of(name.direction)];
}

double ErrorModel::location(const ErrorName& name) const {
  return const_cast<ErrorModel*>(this)->location(name);
}

bool ErrorModel::is_zero() const {
  for (const Axis axis : kAllAxes) {
    if (!locations[at(axis)].isZero(0.0)) return false;
    for (const ErrorFunction& f : components[at(axis)]) {
      if (!f.is_zero()) return false;
    }
  }
  return true;
}

ErrorModel operator+(const ErrorModel& a, const ErrorModel& b) {
  ErrorModel sum = a;
  for (const Axis axis : kAllAxes) {
    sum.locations[at(axis)] += b.locations[at(axis)];
    for (const Axis d : kAllAxes) {
      sum.components[at(axis)][at(d)] =
          a.components[at(axis)][at(d)] + b.components[at(axis)][at(d)];
    }
  }
  return sum;
}

ErrorModel scaled(const ErrorModel& errors, double factor) {
  ErrorModel out = errors;
  for (const Axis axis : kAllAxes) {
    out.locations[at(axis)] *= factor;
    for (ErrorFunction& f : out.components[at(axis)]) f = scaled(f, factor);
  }
  return out;
}

}  // namespace servomill::plant
