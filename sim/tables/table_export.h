/// From an error model to the compensation tables of an NC, with what they leave.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "sim/tables/bed_mesh.h"
#include "sim/tables/compensation_tables.h"
#include "sim/tables/grid_tables.h"
#include "sim/tables/skew.h"
#include "sim/tables/table_request.h"
#include "sim/tables/table_residuals.h"

namespace servomill::sim::tables {

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

}  // namespace servomill::sim::tables
