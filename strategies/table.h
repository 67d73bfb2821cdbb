/// Compensation tables of the NC, added to the setpoint. They enter where the NC lets them in,
/// which is what paper [G] could not find out for its control. Forms that controls have:
///
///     lines, all axes       over each axis x: d(x) of X, Y and Z, summed          HEIDENHAIN
///     lines, output = own   pitch error: d_x(x)                                   Siemens LEC
///     lines, one output     an axis over another: d_y(x), sag, straightness       Siemens CEC
///     grid of two axes   plane, bilinear                                       Beckhoff, ISG
///     grid of three      d(x, y, z) of X, Y and Z, trilinear                   Fanuc 3-D
///
/// Between the points of a line the value is linear; between the eight corners of a cell, with
/// shares u, v, w of its edges,
///
///     d = sum over corners (i, j, k) of  u_i v_j w_k d_ijk,    u_0 = 1 - u, u_1 = u, ...
///
/// which is exact for functions that are linear in each coordinate, and else wrong by |d''| h^2 / 8
/// for each axis with spacing h. Beyond the ends values are constant.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry table_entry();

}  // namespace servomill::strategies
