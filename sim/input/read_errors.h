/// Reads error models of a scenario.
#pragma once

#include <map>
#include <string>

#include "plant/geometry/error_model.h"
#include "sim/config/reader.h"
#include "sim/input/read_grid.h"

namespace servomill::sim::input {

/// One named model: ISO 230-1 names, each a function of the axis' coordinate and, in grids, of
/// those of other axes, or the name of another error of this model whose function it shares.
plant::ErrorModel read_errors(config::Reader& model, const MachineAxes& machine);

/// All models of a table [errors], by name. A model with the key `relative_to` is the sum of the
/// model of that name and what it says itself: an identified model and its identification errors,
/// say.
std::map<std::string, plant::ErrorModel> read_error_models(config::Reader& models,
                                                           const MachineAxes& machine);

/// The models of a file that holds nothing but tables [errors.NAME], or of a machine file's own
/// [errors].
/// @throws InputError
std::map<std::string, plant::ErrorModel> read_error_file(const std::string& path,
                                                         const MachineAxes& machine);

/// A length (um) as a function of a linear coordinate (mm), written like a component error.
plant::ErrorFunction read_length_function(config::Reader& table);

}  // namespace servomill::sim::input
