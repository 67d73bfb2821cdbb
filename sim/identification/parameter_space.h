/// From values of the parameters to the models that simulate: any number of the machine or of the
/// loop, by its key.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/identification/experiment.h"
#include "sim/identification/simulate_record.h"
#include "sim/model/machine.h"

namespace servomill::sim::identification {

/// Key of the resolved document: "axis.X.moving_mass" is "machine.axis.X.moving_mass",
/// "loop.dead_time_ms" stays.
std::string document_key(const std::string& key);

/// Machine of a document with its table `machine`.
model::MachineSettings read_axes(config::Reader& root);

/// The machine and the loop for one set of values.
struct ModelOfValues {
  model::MachineSettings machine;
  LoopSettings loop;
};

/// Reads the document with the values set.
/// @param values  one for each estimate, in its unit
/// @throws InputError if the machine refuses them
ModelOfValues model_of(const config::Document& document, std::span<const Estimate> estimates,
                       std::span<const double> values);

/// The document with the starting values of the estimates set.
config::Document with_values(const config::Document& document, std::span<const Estimate> estimates);

/// Letter of an axis of the experiment's machine.
char letter_of(const Experiment& experiment, int joint);

/// "95.11 kg" as TOML has it, with all digits.
std::string written(double value, const std::string& unit);

}  // namespace servomill::sim::identification
