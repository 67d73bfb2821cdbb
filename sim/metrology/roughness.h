/// Roughness of a straight profile of a surface.
///
/// The primary profile less its least-squares line and its mean line at the cut-off lambda_c, that
/// of the Gaussian filter
///
///     s(x) = exp(-pi (x / (alpha lambda_c))^2) / (alpha lambda_c),  alpha = sqrt(ln 2 / pi)    (1)
///
/// is the roughness profile z(x), evaluated over l_n = 5 l, l = lambda_c, in the middle of the
/// profile; half a cut-off at either end feeds the filter alone. There
///
///     Ra = mean of |z| over l_n                                                                (2)
///     Rz = mean over the five l of (largest z - smallest z)                                    (3)
///
/// There is no short-wave cut-off lambda_s: points of the profile are no stylus of 2 um. Sources:
/// ISO 16610-21:2011 (1); ISO 4287:1997, 4.1.3 and 4.2.1 and ISO 21920-2:2021 (2), (3) (the latter
/// calls the mean over the sections Rz, too); ISO 4288:1996, 4.4 (cut-offs).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace servomill::sim::metrology {

/// Cut-offs that roughness is stated for (m).
inline constexpr double kCutoffs[] = {0.08e-3, 0.25e-3, 0.8e-3, 2.5e-3, 8e-3};

/// The largest of kCutoffs of which a profile has six; none: it is shorter than six of the least.
/// @param length  m, of the profile
std::optional<double> cutoff_for(double length);

struct Roughness {
  double cutoff = 0.0;               // m
  double evaluation_length = 0.0;    // m
  double Ra = 0.0, Rz = 0.0;         // m
  std::vector<double> profile = {};  // m, at the points evaluated
  std::size_t first = 0;             // of these
};

/// Fewest points in a cut-off, so that 3 to 10 waves in it have some tens each.
inline constexpr double kMinPointsOfCutoff = 100.0;

/// @param heights  m, at equal distances, outwards
/// @param spacing  m
/// @param why_not  filled where there is none
std::optional<Roughness> roughness_of(std::span<const double> heights, double spacing,
                                      std::string& why_not);

}  // namespace servomill::sim::metrology
