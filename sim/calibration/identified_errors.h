/// Identified errors as a machine file: the machine that was measured with an error model over it,
/// with uncertainty and covariance.
#pragma once

#include <string>
#include <vector>

#include "sim/calibration/calibration.h"
#include "sim/input/identified_values.h"

namespace servomill::sim::calibration {

/// Most numbers whose covariance is written; beyond, only their uncertainties are.
inline constexpr int kMaxCovarianceNumbers = 1000;

struct IdentifiedErrors {
  input::IdentifiedValues values;  // keys "errors.MODEL.EXX.table.value_um[3]", in um, urad
  std::vector<std::string> lines;  // of the table [errors.MODEL]
};

/// Numbers of the error model and their covariance: those of a function are a linear map of its
/// unknowns, harmonics a sine and a cosine each.
IdentifiedErrors identified_errors(const Calibration& calibration, const std::string& model);

/// Writes the file. Before it gets its name, its text is read as the machine that it will be: its
/// error model must be the adjusted one within rounding, its covariance the same to the bit.
/// @param machine  file that was measured
/// @throws InputError if it may not be written there, or the machine has a model of that name
void write_identified_errors(const std::string& path, const Calibration& calibration,
                             const std::string& machine, const std::string& model, bool force);

}  // namespace servomill::sim::calibration
