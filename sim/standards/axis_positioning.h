/// Positioning of an axis after ISO 230-2: parameters of accuracy and repeatability from repeated
/// approaches of targets in both directions.
///
/// Deviation x_ij = actual minus target position at target i in run j, m; of rotary axes rad.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::standards {

/// Readings of one test, complete: every target in every run.
struct PositioningTest {
  bool angular = false;      // targets and deviations in rad
  Eigen::ArrayXd targets;    // rising
  Eigen::ArrayXXd up, down;  // deviations, a row a target, a column a run; no column: not measured
  /// Instant of each reading as a share of the test, 0 to 1, in the same layout.
  Eigen::ArrayXXd time_up, time_down;

  bool bidirectional() const { return up.cols() > 0 && down.cols() > 0; }
  double travel() const { return targets[targets.size() - 1] - targets[0]; }
};

/// Parameters of ISO 230-2:2014, clause 3, in the order of its report.
enum class Positioning : std::uint8_t {
  B,       // axis reversal error
  B_mean,  // mean reversal error
  R_up,    // unidirectional positioning repeatability
  R_down,
  R,     // bi-directional positioning repeatability
  E_up,  // unidirectional systematic positioning error
  E_down,
  E,     // bi-directional systematic positioning error
  M,     // mean bi-directional positioning error
  A_up,  // unidirectional positioning accuracy
  A_down,
  A,  // bi-directional positioning accuracy
};
inline constexpr std::size_t kPositioningParameters = 12;
inline constexpr std::array<std::string_view, kPositioningParameters> kPositioningNames = {
    "B", "B_mean", "R_up", "R_down", "R", "E_up", "E_down", "E", "M", "A_up", "A_down", "A"};
inline constexpr std::array<std::string_view, kPositioningParameters> kPositioningMeanings = {
    "axis reversal error",
    "mean reversal error",
    "positioning repeatability, upwards",
    "positioning repeatability, downwards",
    "bi-directional positioning repeatability",
    "systematic positioning error, upwards",
    "systematic positioning error, downwards",
    "bi-directional systematic positioning error",
    "mean bi-directional positioning error",
    "positioning accuracy, upwards",
    "positioning accuracy, downwards",
    "bi-directional positioning accuracy"};

/// Values of all parameters; NaN where the readings do not give one.
using PositioningValues = std::array<double, kPositioningParameters>;

inline double& at(PositioningValues& values, Positioning which) {
  return values[static_cast<std::size_t>(which)];
}
inline double at(const PositioningValues& values, Positioning which) {
  return values[static_cast<std::size_t>(which)];
}

/// One direction at one target.
struct Approach {
  double mean = 0.0;
  double s = 0.0;  // estimator of the standard deviation; NaN with one run
  double R() const { return 4.0 * s; }
};

/// One target of the report; parameters of both directions are NaN where one was measured.
struct PositioningTarget {
  double target = 0.0;
  std::optional<Approach> up, down;
  double mean = 0.0;  // bi-directional
  double B = 0.0;     // x_up - x_down
  double R = 0.0;
};

/// Mean and standard deviation of each target from the deviations alone.
std::vector<PositioningTarget> evaluate_targets(const PositioningTest& test);

/// The parameters of all targets. R and A need two runs at least; the bi-directional parameters
/// both directions.
PositioningValues positioning_parameters(const std::vector<PositioningTarget>& targets);

/// Both of these for deviations in place of those of the test: the inner loop of a Monte Carlo
/// simulation, without allocation.
PositioningValues positioning_parameters(const Eigen::ArrayXXd& up, const Eigen::ArrayXXd& down);

/// Deviations of the test from what ISO 230-2:2014 requires, one sentence each: number of runs,
/// number of targets for the travel, a direction that was not measured.
std::vector<std::string> departures(const PositioningTest& test);

/// Periodic positioning error of one direction: the mean deviations without their least-squares
/// line, and the first harmonic of a given period.
struct PeriodicError {
  double P = 0.0;          // range of what the line leaves
  double amplitude = 0.0;  // of the harmonic; half of P if there is nothing else
  double phase = 0.0;      // rad, of a sine that is 0 at target 0
};

/// Why the targets do not show this period: at least two periods and ten targets in each (21 over
/// two periods); nullopt if they do.
std::optional<std::string> why_no_period(const PositioningTest& test, double period);

/// @pre why_no_period(test, period) is nullopt, the direction was measured
PeriodicError periodic_error(const PositioningTest& test, const Eigen::ArrayXXd& deviations,
                             double period);

}  // namespace servomill::sim::standards
