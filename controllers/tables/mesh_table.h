/// Bed meshes of Marlin, Klipper and RepRapFirmware: what they add to Z over X and Y.
#pragma once

#include <optional>
#include <vector>

#include "controllers/tables/skew_table.h"

namespace servomill::controllers {

/// Heights at equidistant points, rows along X from the smallest Y on; bilinear between them.
struct MeshTable {
  int nx = 0, ny = 0;
  std::optional<std::array<double, 4>> range;  // m: X from, to, Y from, to; Marlin: not in the file
  std::vector<double> z;                       // m

  /// Added to Z at a place, of a mesh over this range (m).
  double at(double x, double y, const std::array<double, 4>& over) const;
};

/// The mesh of one file.
///
/// Rules, from the sources of the firmwares:
///   - Marlin (Marlin/src/gcode/bedlevel/abl/M421.cpp): `M421 I<column> J<row> Z<mm>`, one for each
///     point; the range is compiled into the firmware
///   - Klipper (klippy/extras/bed_mesh.py): a section [bed_mesh NAME] with version 1, points (rows
///     below each other), min_x, max_x, min_y, max_y, x_count, y_count, mesh_x_pps, mesh_y_pps,
///     algo and tension; without points in between (pps 0) it is bilinear
///   - RepRapFirmware (src/Movement/BedProbing/Grid.cpp): heightmap.csv, version 2: a comment, the
///     names, their values, then rows; a bare 0 was not probed and is refused here
///
/// @throws InputError with file and line
MeshTable read_mesh_table(const TableText& file, SkewFirmware firmware);

}  // namespace servomill::controllers
