/// Tolerance of a quantity.
#pragma once

#include <cmath>

namespace servomill::sim::model {

/// Limits of a quantity in its unit, both allowed.
struct Tolerance {
  double lower = 0.0, upper = 0.0;

  bool contains(double value) const { return lower <= value && value <= upper; }
  bool is_symmetric() const { return lower == -upper; }
  bool operator==(const Tolerance&) const = default;
};

}  // namespace servomill::sim::model
