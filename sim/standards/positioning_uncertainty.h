/// Uncertainty of the parameters of ISO 230-2 by ISO/TR 230-9: contributions of device, set-up,
/// temperature and environment, propagated by GUM supplement 1 (Monte Carlo), since the parameters
/// are maxima and ranges.
///
/// Each trial draws the error of every reading,
///   e = L (scale + coefficient dT + alpha dT_error - theta^2 / 2) + e_target(i)
///       + e_resolution + e_variation + drift (t - 1/2) + e_set_up,
/// takes it away from the deviation and evaluates the parameters again; L counts from the first
/// target, where the device is set to zero. The repeatability of the machine is no contribution:
/// the parameters are defined for the runs that were measured.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/standards/axis_positioning.h"

namespace servomill::sim::config {
class Reader;
}  // namespace servomill::sim::config

namespace servomill::sim::standards {

/// Nothing: not known. Standard uncertainties (k = 1) unless said otherwise.
struct PositioningContributions {
  std::optional<double> scale;          // m/m; calibration of the device
  std::optional<double> target;         // m, rad; each step of a gauge or a polygon
  std::optional<double> resolution;     // m, rad; step of the display, rectangular
  std::optional<double> misalignment;   // rad; limit of either angle of the beam, rectangular
  std::optional<double> expansion;      // 1/K; coefficient of the machine
  std::optional<double> u_expansion;    // 1/K
  std::optional<double> temperature;    // K; mean of the axis minus 20 degC
  std::optional<double> u_temperature;  // K
  std::optional<double> variation;      // m, rad; range within which readings vary, rectangular
  std::optional<double> drift;          // m, rad; limit of the drift over the test, rectangular
  std::optional<double> set_up;         // m, rad; common to all readings
};

/// Sources that a budget lists.
enum class Source : std::uint8_t {
  calibration,
  resolution,
  misalignment,
  temperature,
  variation,
  drift,
  set_up,
};
inline constexpr std::size_t kSources = 7;
inline constexpr std::array<std::string_view, kSources> kSourceNames = {
    "calibration", "resolution", "misalignment", "temperature", "variation", "drift", "set_up"};

/// Keys that are missing for U of a parameter; empty if it can be stated. R and B need neither
/// scale nor expansion nor alignment, which are the same in both directions and all runs.
std::vector<std::string_view> missing_for(const PositioningContributions& contributions,
                                          bool angular, Positioning which);

struct PositioningUncertainty {
  PositioningValues U{};  // expanded, k = 2; NaN where it cannot be stated
  /// U from one source alone; of each source.
  std::array<PositioningValues, kSources> alone{};
  /// Mean of the trials minus the value: what a correction would take away. U includes it.
  PositioningValues shift{};
};

struct MonteCarloSettings {
  std::uint64_t seed = 1;
  std::size_t trials = 50'000;        // of all sources together
  std::size_t trials_alone = 10'000;  // of each
};

/// U = 2 sqrt(mean((y_trial - y)^2)) about the value y of the readings.
PositioningUncertainty positioning_uncertainty(const PositioningTest& test,
                                               const PositioningContributions& contributions,
                                               const MonteCarloSettings& settings);

/// The test as a device reads it: each reading with the error of one trial added.
PositioningTest read_by_device(PositioningTest test, const PositioningContributions& device,
                               std::uint64_t seed);

/// Tests that one device reads one after another.
/// @param common  sources whose errors are the same in all tests
std::vector<PositioningTest> read_by_device(std::vector<PositioningTest> tests,
                                            const PositioningContributions& device,
                                            std::uint64_t seed, const std::vector<Source>& common);

/// Contributions as keys of a table.
/// @param takes_angles  false: of linear axes only, keys in urad are not known
PositioningContributions contributions_of(config::Reader& table, bool takes_angles = true);

/// Reads a file of contributions; keys: sim/standards/README.md.
/// @throws InputError with all faults
PositioningContributions read_contributions(const std::string& path);

}  // namespace servomill::sim::standards
