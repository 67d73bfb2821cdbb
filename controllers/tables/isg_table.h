/// Parameter files of the volumetric compensation of the ISG kernel: ISG CSV.
#pragma once

#include "controllers/tables/csv_table.h"

namespace servomill::controllers {

/// Component and position errors of one file.
///
/// Rules (Beckhoff, TF5280 TwinCAT 3 CNC Volumetric Compensation; on infosys.beckhoff.com under
/// content/1033/tf5280_volumetric_comp/: ISG CSV format, 296429067.html; Units of measure,
/// 296426379.html; List of parameters supported, 296423819.html):
///   - a header names the columns: arguments (X, Y, Z, A, B, C) and parameters; records follow
///   - words are separated by blanks, as in the examples of the document; // begins a comment; a
///     line with # ends the block, and a new header follows
///   - position errors (C0Y) are constants, one record without an argument
///   - component errors (EYX) are functions of any arguments, in mm or deg; values in mm or rad.
///     Over other axes than their own the records lie on a grid, in any order, and are interpolated
///     linearly (interpolation GRID, the default: P-VOLC-00014; error 70471 if they do not)
///
/// Not read, and refused by name: axes of modified orientation (V..) and offsets of the programmed
/// values (ID.) other than zero.
/// Parameters of the kinematics (P.., N0.) and logical axis numbers (LN.) are listed in
/// `ErrorColumns::not_read`.
/// @throws InputError with file and line
ErrorColumns read_isg_table(const TableText& file);

}  // namespace servomill::controllers
