/// Skew correction of Marlin, Klipper and RepRapFirmware.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "controllers/tables/control_table.h"

namespace servomill::controllers {

enum class SkewFirmware : std::uint8_t { marlin, klipper, reprapfirmware };

/// Correction of X and Y that a firmware computes of three numbers of its settings.
struct SkewSetting {
  SkewFirmware firmware = SkewFirmware::marlin;
  double xy = 0.0, xz = 0.0, yz = 0.0;  // as set; RepRapFirmware: divided by S
  int line = 0;

  /// Position to which the axes are commanded (m).
  Eigen::Vector3d commanded(const Eigen::Vector3d& p) const;
};

/// The setting of one file.
///
/// Rules, from the sources of the firmwares:
///   - Marlin (Marlin/src/gcode/calibrate/M852.cpp; skew() in Marlin/src/module/planner.h):
///     `M852 I<xy> J<xz> K<yz>`, each from -1 to 1, and
///     x -= y xy + z (xz - xy yz),  y -= z yz
///   - Klipper (klippy/extras/skew_correction.py): a section [skew_correction NAME] with xy_skew,
///     xz_skew and yz_skew, and the same formulas; [skew_correction] switches the module on
///   - RepRapFirmware (case 556 in src/GCodes/GCodes2.cpp, Move::AxisTransform in
///     src/Movement/Move.cpp; docs: duet3d.dozuki.com/Wiki/M556):
///     `M556 S<length> X<xy> Y<yz> Z<xz>`, S >= 10, tangents are the values over S, and
///     x += y xy + z xz,  y += z yz
///
/// Anything else in the file is refused, as are the parameters S of M852 and P of M556.
/// @throws InputError with file and line
SkewSetting read_skew_table(const TableText& file, SkewFirmware firmware);

}  // namespace servomill::controllers
