/// Axis error compensation of HEIDENHAIN controls: assignment (*.CMA) and value tables (*.COM).
#pragma once

#include <span>
#include <vector>

#include "controllers/tables/control_table.h"

namespace servomill::controllers {

/// Tables of the line that `*` activates.
///
/// Rules (Technical Manual MANUALplus 620 (2012), pages 716 to 718; Technical Manual TNC
/// 407/415/425 (1998), pages 151 to 156 and 622):
///   - *.CMA: a column for each base axis with the name of its *.COM table; the line with `*` in
///   the
///     column ACTIVE acts
///   - *.COM: AXISPOS in mm or deg from the machine datum; one column for each axis that depends on
///     the base axis
///   - a value is the error: positive where the axis travels too far; the control takes it off the
///     command
///   - BACKLASH: the values of the base axis itself measured in the negative direction of traverse
///   - up to 256 points; for a rotary axis the control knows positions from 0 to 360 deg only
///
/// The documents give the columns, not the text of the files: columns of the listing are separated
/// by blanks, and its names end in .txt. Not found in a manual: values beyond the first and last
/// point; they are taken as constant.
///
/// @throws InputError with file and line
std::vector<ControlTable> read_heidenhain_tables(std::span<const TableText> files);

}  // namespace servomill::controllers
