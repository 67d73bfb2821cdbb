/// Covariance of identified errors, as the machine file of a calibration holds it.
#pragma once

#include <optional>
#include <string>

#include "plant/vocabulary/axes.h"
#include "sim/config/value.h"
#include "sim/input/identified_values.h"
#include "sim/model/tip_uncertainty.h"

namespace servomill::sim::input {

/// Errors of one model with what is not known of them: keys "errors.MODEL...." of the identified
/// values. Nothing where no key of the model is identified.
/// @param errors  table of the model in the file
/// @throws InputError for a key that is no number of the model
std::optional<model::UncertainErrors> uncertain_errors(const config::Value& errors,
                                                       const std::string& model,
                                                       const IdentifiedValues& identified,
                                                       const JointLayout& layout);

/// The same of a machine file. Nothing where it has no table [identified], as other files.
/// @throws InputError
std::optional<model::UncertainErrors> uncertain_errors_of_file(const std::string& path,
                                                               const std::string& model,
                                                               const JointLayout& layout);

}  // namespace servomill::sim::input
