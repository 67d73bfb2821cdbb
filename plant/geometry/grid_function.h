/// Error over the positions of several axes: a table with one argument for each axis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::plant {

enum class GridInterpolation : std::uint8_t { linear, cubic };

/// Values at every combination of the positions of some axes.
struct GridPoints {
  std::vector<Axis> axes;               // the arguments: 1 to 5 axes, each once
  std::vector<std::vector<double>> at;  // m or rad of each axis; at least two, strictly increasing
  std::vector<double> error;  // m or rad at each combination, the position of the last axis fastest
  GridInterpolation interpolation = GridInterpolation::linear;
  std::vector<bool> repeats = {};  // of each axis: the errors repeat with the span of its positions
                                   // (an endless rotary axis); empty: of none
  bool operator==(const GridPoints&) const = default;
};

/// Rule that the points break, to follow the name of the grid, or nullopt.
/// @param coordinate_units  in which the fault names positions: those of each axis' unit (m, rad)
std::optional<std::string> grid_fault(const GridPoints& points,
                                      std::span<const double> coordinate_units);

/// Tensor product of B-splines through the points:
///
///     e(q1, q2, ...) = sum over i, j, ... of c_ij... B_i(q1) B_j(q2) ...
///
/// linear: degree 1, multilinear between the points. cubic: degree 3 with the not-a-knot condition
/// at both ends, which reproduces cubics; along an axis with three or two points degree 2 or 1.
/// Beyond the first and last position of an axis the error is that at the end, as of tables, or
/// repeats with their span; there, the slope of a cubic may change at once.
/// Source: de Boor, A Practical Guide to Splines, Springer 2001, IX (1), (15), XIII and XVII.
/// Constant, no allocation after construction.
class GridFunction {
 public:
  static constexpr std::size_t kMaxArguments = kJoints;

  /// @pre grid_fault(points) is nullopt
  explicit GridFunction(GridPoints points);

  const GridPoints& points() const { return points_; }
  const std::vector<Axis>& axes() const { return points_.axes; }
  bool depends_on(Axis axis) const;

  /// @param arguments  position of each of axes() (m, rad)
  /// @return m or rad
  double value(std::span<const double> arguments) const;
  /// Derivative with respect to argument `by`, in m or rad per m or rad; 0 beyond ends that do not
  /// repeat.
  double derivative(std::span<const double> arguments, std::size_t by) const;

  /// @param q  coordinates of all axes (6; m, rad)
  double value(const AxisWords& q) const;

  bool is_zero() const;
  GridFunction scaled(double factor) const;
  bool operator==(const GridFunction& other) const { return points_ == other.points_; }

 private:
  // Along one axis.
  struct Spline {
    std::size_t degree = 1, points = 2, stride = 1;
    std::vector<double> knots;
    bool repeats = false;

    double reduced(double q) const;  // into the first span, if it repeats
  };
  static constexpr std::size_t kMaxDegree = 3;
  using Basis = std::array<double, kMaxDegree + 1>;
  // B-splines that are not zero at a position.
  struct Active {
    std::size_t first = 0, number = 0;
    Basis value{};
  };

  void find_coefficients(std::size_t axis);
  Active active_at(const Spline& spline, double q) const;
  Active slopes_at(const Spline& spline, double q) const;
  double sum(std::span<const Active> active) const;

  GridPoints points_;
  std::vector<Spline> splines_;  // of each argument
  std::vector<double> coefficients_;
};

}  // namespace servomill::plant
