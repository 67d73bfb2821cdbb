/// Cross-coupled control: the contour error of the tip is fed into the position loops.
///
/// e is the vector from the tip as the position loops read it to the nearest point of the path that
/// its command has taken, in the workpiece; across the path, so that following along it plays no
/// part. With a proportional gain C and the reset time Ti,
///
///     v = C (e + 1/Ti integral of e dt)                                                       (1)
///
/// is added to the velocity commands of X, Y and Z, by the columns of the ideal kinematics. The
/// integral turns with the path (parallel transport). Along the normal (1) acts like Kv -> Kv + C:
/// on a circle the mean radial error falls by Kv / (Kv + C), with the integral to zero. Following
/// errors of rotary axes displace the tip, too; they are corrected there, not in the tool axis.
///
/// Sources: Y. Koren, Cross-coupled biaxial computer control for manufacturing systems, J. Dyn.
/// Syst. Meas. Control 102 (1980); K. Erkorkmaz, Y. Altintas, High speed contouring control
/// algorithm for CNC machine tools, IMECE 1998, for free forms.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry contour_entry();

}  // namespace servomill::strategies
