/// A coordinate measuring machine: what it makes of the true deviations of a part.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace servomill::sim::metrology {

/// A CMM and how it probes. Without a word about it, it is a perfect one with a point for a stylus.
struct Cmm {
  double uncertainty = 0.0;   // m, of a point, coverage factor k = 2
  double probe_radius = 0.0;  // m, of the stylus ball
  int repetitions = 1;
  std::uint64_t seed = 1;
  double clearance =
      1e-3;             // m outside the nominal point the stylus begins its way along the normal
  double depth = 1e-3;  // m inside, where it gives up
  bool tooth_marks = false;  // walls and floors have the marks of single teeth
};

/// One repetition at all points of a feature: the deviation and a normal error along the normal
/// of standard deviation uncertainty / 2.
///
///     m_ri = d_i + U / 2 z(seed, case and feature, r, i)
///
/// z is a function of these alone (plant/sensing/noise.h), so that neither threads nor other
/// features, cases or repetitions change it, and is independent for any two of them.
/// @param deviation   d (m); NaN stays NaN
/// @param case_name, feature  tell streams apart
/// @param repetition  r, from 0
std::vector<double> probe_once(const Cmm& cmm, std::string_view case_name, std::string_view feature,
                               std::span<const double> deviation, int repetition);

/// All repetitions.
std::vector<std::vector<double>> probe_all(const Cmm& cmm, std::string_view case_name,
                                           std::string_view feature,
                                           std::span<const double> deviation);

/// Mean over the repetitions, point by point.
/// @pre at least one repetition, all of the same length
std::vector<double> mean_of(std::span<const std::vector<double>> measured);

/// Standard deviation of one repetition, estimated from all of them (n - 1 in the denominator),
/// point by point; 0 for a single one.
/// @pre as mean_of
std::vector<double> standard_deviation_of(std::span<const std::vector<double>> measured);

}  // namespace servomill::sim::metrology
