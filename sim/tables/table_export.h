/// From an error model to the compensation tables of an NC, with what they leave.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/model/machine.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/tables/bed_mesh.h"
#include "sim/tables/compensation_tables.h"
#include "sim/tables/grid_tables.h"
#include "sim/tables/skew.h"
#include "sim/tables/table_residuals.h"

namespace servomill::sim::tables {

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
  std::optional<model::UncertainErrors> identified;
};

struct TableExport {
  TableRequest request;
  std::string machine;
  TableSource source;
  std::vector<TableLine> lines;           // one for each axis of the machine
  std::vector<CompensationTable> tables;  // rounded as written
  std::vector<GridTable> grids;           // of errors over several axes
  std::vector<OmittedTable> omitted;      // of second order, or not determined
  Joints base = Joints::Zero();           // m, rad: displacement that the reference would need
  std::vector<TableResidual> left;
  Volume volume;
  std::optional<SkewSettings> skew;  // of the formats that hold nothing else
  std::optional<BedMesh> mesh;       // of firmwares, where it is wanted
  std::vector<std::string> coarse;   // what points lie too far apart for

  const FormatRules& rules() const { return rules_of(request.format); }
  /// True if the tables would put the tip further off, somewhere in the travel.
  bool makes_worse() const { return volume.after > volume.before + rules().length_step; }
  char letter(int joint) const { return source.chain.layout.letter_of(joint); }
};

/// @throws InputError if points are too many, an axis has no travel, the reference lies outside it,
///         or the format can hold nothing of this model
TableExport export_tables(const model::MachineSettings& machine, const plant::ErrorModel& errors,
                          const TableRequest& request);

/// Report of what the tables correct and leave uncorrected: lines of text without line ends.
std::vector<std::string> report(const TableExport& tables);

}  // namespace servomill::sim::tables
