/// Geometric error as a function of the coordinate of its axis, and of other axes on request.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/grid_function.h"
#include "plant/vocabulary/axes.h"

namespace servomill::plant {

/// amplitude sin(2 pi s / period + phase)
struct Harmonic {
  double amplitude = 0.0;  // m or rad
  double period = 1.0;     // m or rad of travel, > 0
  double phase = 0.0;      // rad
  double omega() const;    ///< 2 pi / period
  double value(double s) const;
  double derivative(double s) const;
  bool operator==(const Harmonic&) const = default;
};

/// Linear between points, constant beyond the first and the last.
struct LinearTable {
  std::vector<double> s;      // m or rad of travel, strictly increasing, at least one
  std::vector<double> error;  // m or rad, one for each s
  double value(double at) const;
  double derivative(double at) const;  ///< at a point: that of the interval above it
  bool operator==(const LinearTable&) const = default;
};

/// Hysteresis: an error that depends on the direction of travel, by width(s) / 2 on either side of
/// the mean, direction(s) width(s) / 2 in between (plant/geometry/reversal_memory.h).
/// Source: polynomials with a hysteresis term, Slamani, Mayer, Cloutier, Modeling and experimental
/// validation of machine tool motion errors using degree optimized polynomial including motion
/// hysteresis, Experimental Techniques 35 (2011) 37-44.
struct Reversal {
  std::vector<double>
      width;              // m or rad: w0 + w1 s + ..., error travelling up minus travelling down
  double distance = 1.0;  // m or rad of travel that a change of direction takes, > 0
  double value(double s) const;
  bool is_zero() const;
  bool operator==(const Reversal&) const = default;
};

/// Sum of a polynomial, harmonics and tables over the coordinate of its axis and of grids over the
/// coordinates of any axes, the mean of both directions of travel, and of reversals; zero when
/// empty. Values are m for errors along X, Y, Z and rad for errors about A, B, C; the coordinate s
/// is m for linear axes and rad for rotary ones.
struct ErrorFunction {
  std::vector<double> polynomial = {};  // c0 + c1 s + c2 s^2 + ...
  std::vector<Harmonic> harmonics = {};
  std::vector<LinearTable> tables = {};
  std::vector<Reversal> reversals = {};
  std::vector<GridFunction> grids = {};

  /// Mean of both directions of travel, as for its derivative.
  /// @throws std::logic_error with grids
  double value(double s) const;
  double derivative(double s) const;  ///< @throws std::logic_error with grids
  /// The same of an error with grids.
  /// @param s  coordinate of its axis
  /// @param q  coordinates of all axes (6; m, rad)
  double value(double s, const AxisWords& q) const;
  /// Axes that the grids name, in the order of kAllAxes.
  std::vector<Axis> grid_axes() const;
  /// Error travelling up minus error travelling down, long after a change of direction.
  double width(double s) const;

  /// True only if the function vanishes everywhere because all its numbers do.
  bool is_zero() const;
  bool operator==(const ErrorFunction&) const = default;
};

ErrorFunction constant(double c);
ErrorFunction polynomial(std::vector<double> coefficients);
ErrorFunction harmonic(double amplitude, double period, double phase = 0.0);
/// @pre distance > 0
ErrorFunction reversal(std::vector<double> width, double distance);
/// @pre table_fault(s, error) is nullopt
ErrorFunction linear_table(std::vector<double> s, std::vector<double> error);
/// @pre grid_fault(points) is nullopt
ErrorFunction grid(GridPoints points);

/// Rule that a table breaks, to be put behind the name of its key, or nullopt.
std::optional<std::string> table_fault(const std::vector<double>& s,
                                       const std::vector<double>& error);

ErrorFunction operator+(const ErrorFunction& f, const ErrorFunction& g);
ErrorFunction scaled(const ErrorFunction& f, double factor);
/// The error of an axis that travels in one direction: mean + direction width / 2, no reversals.
/// @param direction  1: up, -1: down, 0: the mean
ErrorFunction travelling(const ErrorFunction& f, double direction);

}  // namespace servomill::plant
