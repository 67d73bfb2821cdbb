/// Error models out of parameter files of controls.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controllers/tables/csv_table.h"
#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "sim/tables/table_format.h"

namespace servomill::sim::tables {

/// Errors as the control of a format reads them.
struct ImportedColumns {
  controllers::ErrorColumns columns;
  TableFormat format = TableFormat::csv;
};

/// @param files  one of isg and etalon, any number of csv
/// @throws InputError for formats that hold displacements of axes, from which errors do not follow
ImportedColumns read_columns(TableFormat format, std::span<const controllers::TableText> files);

struct ErrorImport {
  plant::ErrorModel errors;
  std::vector<std::string> notes;  // what is not taken over, and what is assumed
};

/// Error model of a machine. Errors of axes that carry the workpiece are converted from isg and
/// etalon (tool_side_errors.h) at the points of the file and at as many between them as a deviation
/// below 1 nm or 1 nrad needs.
/// @throws InputError with file and line for errors that the machine cannot have, that depend on
/// the
///         direction of travel, or that no machine has (beyond 0.1 m or 0.1 rad)
ErrorImport import_errors(const ImportedColumns& imported, const plant::MachineChain& chain);

/// The model as a file: a table [errors.NAME], with comments before it.
std::string errors_toml(const plant::ErrorModel& errors, const std::string& name,
                        const std::vector<std::string>& comments);

/// Compares an error model, read back from its file, with the parameter file at 1000 positions over
/// the points of each component error, through the poses of the machine with errors.
/// @return number of positions
/// @throws InputError if they differ by more than 2 nm or 2 nrad
std::size_t verify_import(const ImportedColumns& imported, const plant::MachineChain& chain,
                          const plant::ErrorModel& read_back);

}  // namespace servomill::sim::tables
