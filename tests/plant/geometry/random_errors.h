/// Reproducible random error models for the law tests.
#pragma once

#include "plant/geometry/error_model.h"
#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant {

/// A cubic and a harmonic of up to about three times `size` within 1 m or 2 rad.
inline ErrorFunction random_function(Uniform& random, double size) {
  const double c0 = size * random(), c1 = size * random(), c2 = size * random();
  const double amplitude = size * random(), phase = 3.0 * random();
  return polynomial({c0, c1, c2, 0.3 * size * random()}) + harmonic(amplitude, 0.8, phase);
}

/// All component and location errors, of `size` (m, rad).
inline ErrorModel random_errors(Uniform& random, double size) {
  ErrorModel errors;
  for (auto& axis : errors.components) {
    for (ErrorFunction& f : axis) f = random_function(random, size);
  }
  for (AxisWords& axis : errors.locations) {
    for (double& e : axis) e = size * random();
  }
  return errors;
}

/// Errors of up to `size` at unevenly spaced points from -0.5 on.
inline LinearTable random_table(Uniform& random, double size, int points) {
  LinearTable table;
  double s = -0.5;
  for (int i = 0; i < points; ++i) {
    table.s.push_back(s);
    table.error.push_back(size * random());
    s += 0.1 * (1.01 + random()) / (i % 3 + 1);
  }
  return table;
}

/// Errors of up to `size` over the positions of some axes, from -0.5 m or rad on.
inline ErrorFunction random_grid(Uniform& random, double size, std::vector<Axis> axes,
                                 GridInterpolation interpolation) {
  GridPoints points{std::move(axes), {}, {}, interpolation};
  std::size_t combinations = 1;
  for (std::size_t k = 0; k < points.axes.size(); ++k) {
    points.at.push_back(random_table(random, size, 5 + static_cast<int>(k)).s);
    combinations *= points.at.back().size();
  }
  for (std::size_t n = 0; n < combinations; ++n) points.error.push_back(size * random());
  return grid(std::move(points));
}

}  // namespace servomill::plant
