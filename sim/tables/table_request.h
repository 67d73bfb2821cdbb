/// Request for compensation tables.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_name.h"
#include "plant/vocabulary/axes.h"
#include "sim/model/forward.h"
#include "sim/tables/table_format.h"

namespace servomill::plant {
struct ErrorModel;  // plant/geometry/error_model.h
}  // namespace servomill::plant

namespace servomill::sim::model {
struct UncertainErrors;  // sim/model/tip_uncertainty.h
}  // namespace servomill::sim::model

namespace servomill::sim::tables {

struct TableExport;  // sim/tables/table_export.h

struct TableRequest {
  struct AxisRequest {
    bool wanted = true;               // a table over this axis
    std::optional<double> reference;  // m, rad; absent: middle of travel (linear), 0 (rotary)
    std::optional<double> from, to;   // m, rad; absent: travel of the machine
  };
  TableFormat format = TableFormat::linuxcnc;
  std::string model;                       // name of the error model, for the reader
  double tool_length = 0.0;                // m, from the spindle nose to the tip
  std::optional<double> spacing;           // m; absent: the smallest round one that fits
  std::optional<double> rotary_spacing;    // rad
  std::optional<std::size_t> most_points;  // absent: what the format takes
  int comp_file_type = 0;                  // of LinuxCNC: 0 positions, 1 trims
  std::optional<std::array<int, 2>> mesh;  // points along X and Y of a bed mesh, of firmwares
  std::array<AxisRequest, kJoints> axes;
  /// Errors that the readings of a calibrated machine leave undetermined
  /// (sim/model/undetermined_errors.h).
  std::vector<plant::ErrorName> unknown;
  /// Numbers that a calibration has identified, with their covariance; none: values as given.
  std::shared_ptr<const model::UncertainErrors> identified;
};

/// export_tables() for callers that need no complete TableExport.
/// @throws InputError
std::shared_ptr<const TableExport> shared_export(const model::MachineSettings& machine,
                                                 const plant::ErrorModel& errors,
                                                 const TableRequest& request);

/// Report of what the tables correct and leave uncorrected: lines of text without line ends.
std::vector<std::string> report(const TableExport& tables);

}  // namespace servomill::sim::tables
