/// Errors over the positions of several axes, as a control evaluates them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// Values at every combination of positions: multilinear in between, constant beyond the ends of
/// each axis.
struct ErrorGrid {
  std::string file;
  std::string name = {};                     // "EXX"
  std::vector<Axis> axes = {};               // the arguments, in the order of the columns
  std::vector<std::vector<double>> at = {};  // m, rad; increasing, at least two of each axis
  std::vector<double> error = {};            // m, rad; the position of the last axis fastest
  int line = 0;                              // of the header

  /// @param position  of each of axes (m, rad)
  double value(std::span<const double> position) const;
};

/// One record of a table over several arguments.
struct GridRecord {
  std::vector<double> position;  // of each argument, m, rad
  double error = 0.0;            // m, rad
  int line = 0;
};

/// The grid that records lie on, whatever their order.
/// @param grid  with its name, axes and place
/// @throws InputError with the line of a record that repeats a combination, or of the header if a
///         combination is missing or an argument has one position only
ErrorGrid grid_of(ErrorGrid grid, const std::vector<GridRecord>& records);

}  // namespace servomill::controllers
