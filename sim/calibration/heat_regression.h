/// Errors per kelvin of temperature sensors, by linear regression of the drift of the tip:
///
///     drift(k, Q, t) = a_k(Q) + sum over sensors s, terms i of c_si g_ik(Q) T_s(t)
///
/// k direction, g_ik(Q) effect of a unit error i on the tip at Q by the ideal machine, a_k(Q) where
/// the drift at Q counts from. A term is the constant of an error or its slope over its own axis.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "sim/calibration/heat_readings.h"
#include "sim/input/write_identified.h"

namespace servomill::sim::calibration {

/// One unknown.
struct HeatTerm {
  int sensor = 0;
  plant::ErrorName error;
  bool is_slope = false;  // over the coordinate of its axis
  double value = 0.0;     // 1/K of m, rad or of these per m, rad
  double sigma = 0.0;     // standard deviation, residuals taken as independent
};

struct HeatRegression {
  std::vector<std::string> sensors;
  std::vector<HeatTerm> terms;
  Eigen::MatrixXd covariance;                                        // of the values
  std::size_t numbers = 0;                                           // of drift
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;  // m, rms about its mean
};

/// @param errors  a slope is sought of component errors along X, Y, Z over linear axes along which
///                the readings span at least kSlopeSpan
/// @throws InputError if the readings are too few, or do not tell the unknowns apart
HeatRegression regress(const HeatReadings& readings, const plant::MachineChain& chain,
                       const std::vector<plant::ErrorName>& errors);
inline constexpr double kSlopeSpan = 0.05;  // m

/// As keys of the machine that was measured, for a machine file.
/// @param based_on  that machine, as the file names it
input::IdentifiedFile identified_file(const HeatRegression& found, const HeatReadings& readings,
                                      const std::string& based_on);

/// Table of the terms, and of the drift with and without them.
std::string heat_report(const HeatRegression& found);
/// One JSON object.
std::string heat_json(const HeatRegression& found);

}  // namespace servomill::sim::calibration
