/// Covariance of identified errors, as the machine file of a calibration holds it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::config {
struct Value;  // sim/config/value.h
}  // namespace servomill::sim::config

namespace servomill::sim::model {
struct UncertainErrors;  // sim/model/tip_uncertainty.h
}  // namespace servomill::sim::model

namespace servomill::sim::input {

struct IdentifiedValues;  // sim/input/identified_values.h

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
std::shared_ptr<const model::UncertainErrors> uncertain_errors_of_file(const std::string& path,
                                                                       const std::string& model,
                                                                       const JointLayout& layout);

}  // namespace servomill::sim::input
