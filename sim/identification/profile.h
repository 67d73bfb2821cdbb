/// Interval of one parameter by its profile: how far it can be moved, all others fitted again,
/// before the misfit shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/identification/uncertainty.h"

namespace servomill::sim::identification {

/// End of an interval.
enum class ProfileEnd : std::uint8_t {
  crossed,  // the misfit has risen enough there
  bound,    // the bound of the parameter, or of the machine, is inside the interval
  open,     // the misfit does not rise enough however far the parameter is moved
};

struct ProfileSide {
  ProfileEnd end = ProfileEnd::open;
  double value = 0.0;  // of the parameter: at the crossing or the bound; the last that was tried
};

/// A value that the parameter was held at, and the misfit there, relative to that at which an
/// interval of 95 % ends.
struct ProfilePoint {
  double value = 0.0, excess = 0.0;
};

struct Profile {
  std::size_t parameter = 0;
  ProfileSide lower, upper;
  std::vector<ProfilePoint> points;  // by value
  bool finds_better = false;         // a smaller misfit than that of the fit
};

/// Profile interval of 95 %: the ends are where
///   S(value) - S(fit) = t^2 C_pp / ((J'J)^-1)_pp,
/// S the sum of squares with all other parameters fitted. The right-hand side is the rise of S at
/// the ends of the covariance interval of a linear model: residuals are coloured, so that C is not
/// in proportion to (J'J)^-1 and a quantile of chi squared would not do.
/// Source: Chandler and Bate, Inference for clustered data using the independence loglikelihood,
/// Biometrika 94 (2007) 167-183: the vertical adjustment of a profile.
/// @pre the parameter is identifiable
Profile profile(const Prediction& prediction, const Fit& fit, const Uncertainty& uncertainty,
                const Mask& mask, std::size_t parameter);

}  // namespace servomill::sim::identification
