/// Adjustment: the errors of a machine and the unknowns of all set-ups from all readings at once,
/// by weighted least squares, with what the readings cannot tell.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/calibration/function_basis.h"
#include "sim/calibration/grid_basis.h"
#include "sim/calibration/normal_equations.h"
#include "sim/calibration/observations.h"

namespace servomill::sim::calibration {

/// A location error that is looked for. What is expected of its size counts for little where
/// readings determine it; where they hardly do, it keeps the estimate from going astray, and the
/// exact machine from being evaluated far from where it is.
struct SoughtLocation {
  plant::ErrorName name;
  double size = 1e-3;  // m or rad; standard deviation about 0 that is expected of it
};

/// A component error that is looked for.
struct SoughtFunction {
  plant::ErrorName name;
  FunctionBasis basis;
  double size = 0.3e-3;       // m or rad; expected of each of its coefficients
  int first = 0;              // unknown, in Adjustment::values
  bool has_own_knots = true;  // false: knots stand at the targets, and nothing says that the error
                              // is straight between them
};

/// A component error over its axis and another one, beside a function of its axis.
struct SoughtGrid {
  plant::ErrorName name;
  GridBasis basis;
  double size = 0.3e-3;  // m or rad; expected of each of its coefficients
  int first = 0;         // unknown, in Adjustment::values
};

/// "EXX over X and Z"
std::string name_of(const SoughtGrid& grid);

/// The unknowns in their order: set-up, location errors, functions, grids. Of unknowns that the
/// readings know only in combination, the later one is left out (0), so that the earlier one holds
/// the combination.
struct Unknowns {
  std::vector<SetUpUnknown> set_up;
  std::vector<SoughtLocation> locations;
  std::vector<SoughtFunction> functions;
  std::vector<SoughtGrid> grids;

  int first_location() const { return static_cast<int>(set_up.size()); }
  int first_function() const { return first_location() + static_cast<int>(locations.size()); }
  int size() const;
  /// Standard deviation that is expected of an unknown, about 0.
  std::optional<double> prior(int unknown) const;
  /// "EC0Y", "EXX", "EXX over X and Z", "X, laser: zero"
  std::string name(int unknown, const readings::Readings& readings) const;
};

/// An unknown that is left out, and those that hold it.
using LeftOut = NormalEquations::Dependent;

struct GroupResult {
  double uncertainty = 0.0;  // m or rad; stated or estimated, of one number
  double rms = 0.0;          // of the residuals
  double redundancy = 0.0;   // numbers less unknowns that they determine
  std::size_t numbers = 0;
  /// Variance of the residuals over that of the uncertainty; 1 is expected.
  double ratio() const;
};

struct Outlier {
  std::size_t observation = 0;
  double standardized = 0.0;  // residual over its standard uncertainty
};

struct Adjustment {
  Unknowns unknowns;
  Eigen::VectorXd values;      // SI; 0 of those left out
  Eigen::MatrixXd covariance;  // of the values; 0 of those left out
  std::vector<LeftOut> left_out;
  std::vector<double> residuals;     // observed less adjusted
  std::vector<double> standardized;  // residuals over their standard uncertainty; 0: uncontrolled
  std::vector<GroupResult> groups;
  plant::ErrorModel errors;  // as adjusted
  /// Standard uncertainty (m, rad) of each function between its targets (short_waves.h).
  std::vector<double> short_waves;
  double squares = 0.0;  // of whitened residuals and of what is known of set-ups
  double redundancy = 0.0;
  /// Root mean square of whitened residuals of numbers that all others predict; 0: not asked for.
  double prediction = 0.0;
  int iterations = 0;
  bool converged = false;
};

struct AdjustmentOptions {
  bool robust = false;    // Huber's weights
  bool predicts = false;  // leaves the readings of each target out in turn
};

/// @param locations, functions, grids  what is looked for; `first` is set here
Adjustment adjust(const readings::Readings& readings, const Observations& observations,
                  const plant::MachineChain& chain, std::vector<SoughtLocation> locations,
                  std::vector<SoughtFunction> functions, std::vector<SoughtGrid> grids,
                  const AdjustmentOptions& options = {});

/// An unknown of which less than this share is its own counts as a combination of others.
inline constexpr double kOwnShare = 1e-4;

}  // namespace servomill::sim::calibration
