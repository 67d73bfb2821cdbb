/// Compensation tables made of an error model, refused where a NC would refuse them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/vocabulary/parameters.h"
#include "strategies/grid_table.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// The machine whose errors tables hold, and the parameters of the strategy. All throw InputError.
struct Tabulation {
  const IdentifiedMachine& machine;
  const Parameters& p;
  Action action;

  /// Points over the travel of a joint, or between from_mm and to_mm, by spacing_mm. Refused if
  /// there are none, or more than any NC holds.
  GridLine line(int joint) const;

  /// Displacements of X, Y and Z that compensate or generate the errors. Refused with more points
  /// (max_points) or steeper (max_step_ratio) than the NC accepts.
  /// @param moved           1 for an axis that the table moves, else 0
  /// @param from_reference  1 for an axis whose change from the reference position it holds only
  GridTable table(std::vector<GridLine> lines, const Eigen::Vector3d& moved,
                  const Eigen::Vector3d& from_reference) const;
};

}  // namespace servomill::strategies
