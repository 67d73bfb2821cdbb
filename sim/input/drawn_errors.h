/// Samples of identified errors that are drawn into an error model of their own.
///
/// ```toml
/// machine = "identified.toml"       # has [errors.identified], with a covariance
/// machine_errors = "drawn"          # the machine as it may be
/// [sweep]
/// samples = { from = "identified.toml", into = "drawn", count = 1000 }
/// ```
/// The model `identified` is the same in all samples: strategies correct what is known.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/config/document.h"
#include "sim/input/input_files.h"

namespace servomill::sim::input {

/// Error models that identified keys belong to: "identified" of "errors.identified.EXX...".
std::vector<std::string> models_of_keys(const std::vector<std::string>& keys);

/// The key in another error model; keys that are none of an error as they are.
std::string key_in_model(const std::string& key, const std::string& model);

/// Puts a copy of the identified error model into the machine, under the name that the samples of
/// the sweep are drawn into. Documents without such samples, and those that have the copy, stay as
/// they are. Faults are left to read_sweep().
void add_drawn_errors(config::Document& document, InputFiles& files);

}  // namespace servomill::sim::input
