/// Errors over several axes out of parameter files of controls.
#pragma once

#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "sim/model/forward.h"
#include "sim/tables/error_import.h"

namespace servomill::sim::tables {

/// Adds the errors of one axis, some of which the file has over several axes. Those of an axis that
/// carries the workpiece are converted (tool_side_errors.h) at the points of the file and at as
/// many between them as a deviation below 1 nm or 1 nrad needs.
/// @throws InputError for such an axis if a grid is not a function of its position
void import_grids(const ImportedColumns& imported, const plant::ChainAxis& axis,
                  plant::ErrorModel& errors);

/// Grids that cover the travel of their axes. Beyond its points a control keeps the values at the
/// ends, and so do the points that are added; over an endless rotary axis the file must cover one
/// turn.
/// @param notes  what was added
/// @throws InputError with file and line over an endless axis
void cover_travel(ImportedColumns& imported, const model::MachineSettings& machine,
                  std::vector<std::string>& notes);

bool has_grids(const ImportedColumns& imported, Axis axis);

/// Compares an error model with the grids of the file at 1000 positions over the points of each,
/// through the poses of the machine with errors.
/// @return number of positions
/// @throws InputError if they differ by more than 2 nm or 2 nrad
std::size_t verify_grids(const ImportedColumns& imported, const plant::MachineChain& chain,
                         const plant::ErrorModel& read_back);

/// The grid as TOML: { axes = "ZX", at_mm = [[...], [...]], value_um = [[...], ...] }
std::string grid_toml(const plant::GridPoints& points, bool is_length);

}  // namespace servomill::sim::tables
