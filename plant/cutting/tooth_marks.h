/// Surface that single teeth leave on a wall cut by the flank of a cutter: waviness of the feed.
///
/// An edge at height z of tooth j moves along  p(psi) = tip + z k + R_j r(psi_j),  a trochoid:
///
///     psi_j = psi + s (2 pi j / N - z tan(helix) / R),   r(psi) = sin(psi) x + cos(psi) y
///
/// with x, y of spindle_directions(), s = 1 clockwise, -1 counter-clockwise. What remains of the
/// wall is beyond all of these curves. Behind a centre that moves evenly on a straight line at
/// v = N c / (2 pi) a radian, curves of equal teeth meet every c at the height
///
///     h = R c^2 / (8 (R +- v)^2), about c^2 / (8 R) (1)
///
/// above their deepest points, + in up milling. A tooth that alone makes the surface (run-out)
/// leaves N c and N^2 c^2 / (8 R). Source of (1): M. E. Martellotti, An analysis of the milling
/// process, Trans. ASME 63 (1941).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "plant/cutting/cutter.h"
#include "plant/cutting/machined_surface.h"

namespace servomill::plant {

/// Path of a cutter that turns. Positions and angles are linear in between; the edges are where the
/// true position of the cutter has them at their moment.
struct TurningPath {
  std::span<const CutterPosition> positions;
  std::span<const double> angles;                      // rad, psi, one for each position
  Eigen::Matrix3d R_WG = Eigen::Matrix3d::Identity();  // from the frame of the positions to that
                                                       // in which the angles are counted
  double swing = 0.0;  // m, by which vibration displaces the cutter back and forth: marks of
                       // swing reach sqrt(2 R swing) farther along a wall
};

/// Distance along the normal from a target to the surface that the teeth leave there (m), as
/// Meeting::distance. None where the flank with a turning spindle does not pass the target, or its
/// normal is more than 1 deg from across the axis.
/// @param position  of the path, at which the flank passes the target: its neighbours, as far as
///                  they are within three halves of a turn and the reach of the swing, decide
std::optional<double> tooth_mark(const Cutter& cutter, const TurningPath& path,
                                 const ProbeTarget& target, std::size_t position);

}  // namespace servomill::plant
