/// Errors between the places at which they were measured.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/calibration/adjustment.h"

namespace servomill::sim::calibration {

/// Standard uncertainties (m, rad), one a function, that waves shorter than the spacing of the
/// targets cause between them, from the roughness of the tables: targets sample such waves as if
/// they were noise that repeats. With second differences r of a table, their covariance N, and
/// those of white noise of variance 1, G,
///     h^2 = (r'r - tr N) / tr G.
/// A table has few independent differences, and aliasing may turn a short wave into a long one that
/// they do not show: a quarter of h^2 is that of the function, the rest the mean over all functions
/// in the same unit. 0 where the roughness
/// of these is no more than the noise lets expect, where a table has less than kMinKnots, and
/// where knots were asked for: then the error is taken to be straight between them. A wave whose
/// period is the spacing, or a whole part of it, shows nowhere.
std::vector<double> short_waves(const Adjustment& adjustment);

/// Variance at s of a short wave of variance 1 less what a table of it shows there: its
/// interpolation between the knots around s, less its mean line over all knots. Periods from a
/// third of the spacing to the spacing, all frequencies alike.
double interpolation_variance(const FunctionBasis& basis, double s);

inline constexpr int kMinKnots = 6;

/// Independent errors that together have the variances of interpolation_variance(), nearly: sines
/// and cosines of a few periods, less what the table shows of them. For a short wave of variance 1.
struct ShortWaves {
  std::vector<double> periods;  // m or rad of travel
  double amplitude = 0.0;       // standard deviation of each sine and cosine
  /// Values of each of them at the knots less their mean line, in that order (knots x 2 periods):
  /// its share of the table.
  Eigen::MatrixXd tables;
  /// Mean lines that waves of other periods bring into the table (knots x lines).
  Eigen::MatrixXd lines;
};

/// @param number  of periods: evenly spread frequencies from one to three a spacing of the knots
ShortWaves short_waves_of(const FunctionBasis& basis, int number);

}  // namespace servomill::sim::calibration
