/// A measured frequency response as a file: its lines with their uncertainty, and the fitted model.
#pragma once

#include <optional>
#include <string>

#include "sim/responses/rational_fit.h"
#include "sim/responses/two_mass_fit.h"

namespace servomill::sim::responses {

/// Name and unit of a channel; the unit is empty where the recording does not say it.
struct SignalName {
  std::string name, unit;
};

/// A response with its origin.
struct ResponseRecord {
  std::string recording;
  SignalName input, output;
  MeasuredResponse response;
  std::optional<TwoMassFit> fit;
  std::optional<RationalFit> rational;
};

/// Unit of output over input: "rad/A"; "1" for equal units, "unknown" where one of them is.
std::string response_unit(const SignalName& output, const SignalName& input);

/// Writes HDF5: group `response` with the lines, group `two_mass` with the values of the fit and
/// its response on a grid that is finer than the lines; or the same of a rational function in group
/// `rational`.
/// @throws InputError if `path` exists and `force` is not set
void store_response(const ResponseRecord& record, const std::string& path, bool force);

}  // namespace servomill::sim::responses
