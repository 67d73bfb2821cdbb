/// Names of component and location errors (ISO 230-1).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "plant/vocabulary/axes.h"

namespace servomill::plant {

/// Name of one error: `EYX` is a component error, along Y, of axis X, a function of x; `EC0Y` is a
/// location error, about C, of axis Y, a constant. C about Z, B about Y, A about X.
struct ErrorName {
  Axis direction = Axis::X;
  Axis axis = Axis::X;
  bool is_location = false;
  bool operator==(const ErrorName&) const = default;
};

inline constexpr int kErrorDirections = kAxisWords;

/// "EYX", "EC0Y"
std::string to_string(const ErrorName& name);

/// The name that `text` is, or nullopt. Upper case only.
constexpr std::optional<ErrorName> error_name_of(std::string_view text) {
  const auto axis_at = [text](std::size_t i) -> std::optional<Axis> {
    for (const Axis a : kAllAxes) {
      if (text[i] == letter(a)) return a;
    }
    return std::nullopt;
  };
  const bool component = text.size() == 3, location = text.size() == 4 && text[2] == '0';
  if (!(component || location) || text[0] != 'E') return std::nullopt;
  const auto direction = axis_at(1), axis = axis_at(text.size() - 1);
  if (!direction || !axis) return std::nullopt;
  return ErrorName{*direction, *axis, location};
}

}  // namespace servomill::plant
