/// Surface that single teeth leave on a floor cut by the bottom of a cutter.
///
/// The bottom edge of tooth j lies in the half plane of its direction r(psi_j) from the axis
/// (tooth_marks.h), at the height
///
///     z(rho) = 0                                      rho <= R - r
///            = r - sqrt(r^2 - (rho - (R - r))^2)      up to rho = R                          (1)
///
/// above the tip, rho less the run-out of the tooth. It passes a point of the floor each time that
/// its direction is that of the point, and the lowest of all passages remains. A feed of c per
/// tooth leaves, as far as the edge description goes (no dish angle, no axial run-out):
///
///     corner radius r of an axis that leans in the feed by more than c / (2 r):
///                      arcs of length c and height c^2 / (8 r)                                (2)
///     ball, beside the track of its tip by y > c: the same, times 1 / (1 +- v / y)^2, v = N c /
///                      (2 pi), + in up milling; on the track the edges meet, and leave none
///     flat (r = 0), axis that leans by theta in the feed: saw teeth of height c tan(theta)    (3)
///     flat, axis across the floor: none
///
/// Teeth that run out leave N c in place of c where one of them makes the surface alone. Source of
/// (2): M. E. Martellotti, An analysis of the milling process, part II, Trans. ASME 67 (1945).
#pragma once

#include <cstddef>
#include <optional>

#include "plant/cutting/tooth_marks.h"

namespace servomill::plant {

/// True for a target that bottoms cut: its normal is within 30 deg of the axis of the cutter.
bool is_floor(const ProbeTarget& target, const CutterPosition& cutter);

/// Distance along the normal from a target to the surface that the bottom edges leave there (m), as
/// Meeting::distance. None where no edge of a turning spindle passes the target.
/// @param target    within micrometres of the surface, so that edges pass it and the surface at the
///                  same angle
/// @param position  of the path, at which the bottom passes the target: positions before and after
///                  decide as long as the target is below the cutter
/// @pre is_floor(target, path.positions[position])
std::optional<double> floor_mark(const Cutter& cutter, const TurningPath& path,
                                 const ProbeTarget& target, std::size_t position);

}  // namespace servomill::plant
