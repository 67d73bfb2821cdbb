/// Z of the tip over X and Y as the bed mesh of a firmware.
#pragma once

#include <string>
#include <vector>

#include "sim/tables/bed_mesh.h"
#include "sim/tables/table_export.h"
#include "sim/tables/table_files.h"
#include "sim/tables/verify_tables.h"

namespace servomill::sim::tables {

/// Bed mesh of the requested points, beside the skew correction of the tables.
/// @throws InputError where the calibration does not determine the heights
BedMesh bed_mesh_of(const TableExport& tables);

std::vector<std::string> mesh_report(const TableExport& tables);

/// bed_mesh.gcode (Marlin), bed_mesh.cfg (Klipper), heightmap.csv (RepRapFirmware).
TextFile mesh_file(const TableExport& tables);

/// Reads the file as the firmware does and adds its heights to the commands of the machine with
/// errors: at the points Z must be in a plane to a digit.
/// @throws InputError with the file
void verify_mesh(const TableExport& tables, const std::vector<TextFile>& files,
                 TableVerification& out);

}  // namespace servomill::sim::tables
