/// Encoder error (EEC) and interpolatory (CEC) compensation of SINUMERIK 840D sl and 828D.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controllers/tables/control_table.h"

namespace servomill::controllers {

/// All tables of files that assign $AA_ENC_COMP... and $AN_CEC...
///
/// Rules (SINUMERIK 840D sl/828D Function Manual Extended Functions (03/2013), 6FC5397-1BP40-3BA1,
/// K3, pages 237 to 268):
///   - a file begins with %_N_AX_EEC_INI or %_N_NC_CEC_INI and ends with M17; `;` begins a comment
///   - point k lies at MIN + k STEP; MAX is the last point, k from 0 to (MAX - MIN) / STEP
///   - $AA_ENC_COMP: a value is the error of the axis; a positive one moves it in the negative
///     direction (SINUMERIK 808D Function Manual, 01/2017, page 106)
///   - $AN_CEC: a value is added to the setpoint of OUTPUT_AXIS as a function of the setpoint of
///     INPUT_AXIS; tables of the same axes add up; constant beyond MIN and MAX (page 248)
///   - $AN_CEC_DIRECTION: 0 both directions of travel of INPUT_AXIS, 1 the positive, -1 the
///     negative one (page 249)
///   - IS_MODULO 1: the table repeats; its first and last values are then the same (page 249)
///   - values in mm or deg
///
/// A point, and every variable of a table, must be assigned: the control otherwise keeps what it
/// held before. Machine axes are called X1, Y1, ...
///
/// @param max_points  of one table: MD38000, MD18342
/// @throws InputError with file and line
std::vector<ControlTable> read_siemens_tables(std::span<const TableText> files,
                                              std::size_t max_points);

}  // namespace servomill::controllers
