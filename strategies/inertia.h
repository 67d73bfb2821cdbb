/// Strategy that lets the tool tip, not the scale, follow the path under acceleration.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

/// Keys: a gain k_ij for each pair of direction i and accelerating linear axis j, and a mode for
/// each axis j. The tip of a structure that gives way lags behind by e = -K G(s) a; the setpoint is
/// offset by what the identified structure would do on the interpolated path,
///
///     o_i = sum_j k_ij G_j(s) a_j,   G_j = 1 or w^2 / (s^2 + 2 zeta w s + w^2)
///
/// where a is that of the path with its offset, so that the tip of a known structure is on the path
/// of axes that follow. Static gains know the acceleration through a filter of 100 Hz. The offset
/// enters before the nominal-position filter and is fed forward like the path.
/// Source: Heidenhain, Technical Manual iTNC 530 HSCI (2013), pp. 688-689 (cross talk compensation,
/// CTC: static, k linear in one position, which this has not).
Entry inertia_entry();

}  // namespace servomill::strategies
