/// Margins of an open loop, bandwidth and peak of a closed one.
#pragma once

#include <complex>
#include <functional>
#include <limits>
#include <vector>

namespace servomill::sim::frequency {

/// A response over frequency.
struct Curve {
  std::vector<double> f;  // Hz, rising
  std::vector<std::complex<double>> y;
};

/// Response at one frequency (Hz), to find a crossing between two points of a curve.
using ResponseAt = std::function<std::complex<double>(double f)>;

/// Frequencies from `from` to `to` (Hz), both included, evenly spaced in the logarithm.
std::vector<double> logarithmic(double from, double to, std::size_t points);

/// The same with further ones between them, those of `more` that lie inside.
std::vector<double> logarithmic(double from, double to, std::size_t points,
                                const std::vector<double>& more);

/// With points between the given ones wherever the response changes by more than kLargestTurn from
/// one to the next (of its logarithm: magnitude by that share, phase by that many rad), so that no
/// resonance stays unseen whose phase or magnitude the given points notice; and where the magnitude
/// is largest or least.
inline constexpr double kLargestTurn = 0.2;
Curve curve_of(const ResponseAt& y, const std::vector<double>& f);

/// How far an open loop L (negative feedback) is from oscillating.
struct Margins {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double gain = kNone;          // factor by which the gain may rise; none: no crossing of -180 deg
  double gain_frequency = 0.0;  // Hz, where the phase is -180 deg
  double reduction = kNone;     // factor by which the gain may fall, of a loop that needs it
  double phase = kNone;         // rad, least over all crossings of |L| = 1
  double crossover = 0.0;       // Hz, of the least phase margin
  double last_crossover = 0.0;  // Hz, where |L| falls below 1 for good
  double sensitivity = 0.0;     // largest |1 / (1 + L)|
  double sensitivity_frequency = 0.0;  // Hz
};

/// @param at  the same loop at any frequency; crossings are found to 1e-9 with it, by interpolation
///            of the curve without it; the largest sensitivity is among the points without it
Margins margins_of(const Curve& open_loop, const ResponseAt& at = {});

/// Figures of a closed loop with the gain 1 at low frequencies.
struct ClosedLoop {
  double bandwidth = Margins::kNone;  // Hz, where |y| first falls below 1/sqrt(2)
  double peak = 1.0;                  // largest |y|
  double peak_frequency = 0.0;        // Hz
};
ClosedLoop closed_loop_of(const Curve& closed_loop, const ResponseAt& at = {});

}  // namespace servomill::sim::frequency
