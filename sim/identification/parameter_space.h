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

/// Reads the document with the values set. With LoopKind::nc the machine's NC is that of the table
/// `controller`: a mass that it does not know changes none of its gains.
/// @param values  one for each estimate, in its unit
/// @param record  number of the record that the model is for; those of others are left out
/// @throws InputError if the machine refuses them
ModelOfValues model_of(const config::Document& document, std::span<const Estimate> estimates,
                       std::span<const double> values, std::size_t record = Estimate::kAllRecords);

/// The document with the starting values of the estimates set that are for this record.
config::Document with_values(const config::Document& document, std::span<const Estimate> estimates,
                             std::size_t record = Estimate::kAllRecords);

/// Puts the table `controller` into a document, and marks the estimates that the NC has, too: those
/// that change nothing of drives and encoders.
void add_controller(config::Document& document, std::vector<Estimate>& estimates);

/// Letter of an axis of the experiment's machine.
char letter_of(const Experiment& experiment, int joint);

/// "95.11 kg" as TOML has it, with all digits.
std::string written(double value, const std::string& unit);

}  // namespace servomill::sim::identification
