/// Force on the single teeth of a cutter that vibrates: chips of the present displacement over the
/// surface that the teeth before have left.
///
/// Tooth j + m passed at the angle of tooth j m tooth passages earlier, from a centre m c farther
/// back that was displaced by x_m; now it is displaced by x (across the axis):
///
///     h_j = max(0, min over m = 1 .. M of  m c (f . n) + (R_j - R_{j+m}) sin(kappa)
///                                          + sin(kappa) r . (x - x_m))                         (1)
///
/// The edge bears as long as its tooth is less than kRubbing clear of the surface: that it ends
/// where the chip is 0 would be a stiffness of K_re db / c there, which no theory of stability has.
/// (1) of tooth_force.h is that without vibration. A tooth that leaves the cut cuts nothing, and a
/// later one meets what the teeth before it have left. Source: J. Tlusty, F. Ismail, Basic
/// non-linearity in machining chatter, CIRP Annals 30 (1981).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "plant/cutting/edge_integrals.h"
#include "plant/cutting/tooth_force.h"

namespace servomill::plant {

/// Tooth passages over which a surface may have been left: M.
inline constexpr int kPassagesBefore = 8;

/// Clearance (m) beyond which an edge no longer bears on the surface that springs back. A chosen
/// value, a fraction of an edge's radius, as kBearingFeed of cutting_force.h.
inline constexpr double kRubbing = 1e-6;

/// x - x_m, m = 1 .. M (m, along e1 and e2).
using PassageDifferences = std::array<Eigen::Vector2d, kPassagesBefore>;

/// Slices whose ends are at most 5 deg apart along the helix: within one a tooth is in the cut or
/// has left it.
std::vector<EdgeSlice> short_slices(std::span<const EdgeSlice> slices);

/// Distances of the teeth of a cutter from its axis beyond the nominal radius (m).
std::vector<double> radius_offsets(const Cutter& cutter);

/// As mean_tooth_force() of tooth_force.h, with (1). Which surface a tooth meets is decided once
/// for each slice, in the middle of the rotation. Neither allocates nor throws.
/// @param offsets  of the teeth, radius_offsets()
/// @param slices   short_slices()
/// @param between  mean over the rotation
Eigen::Vector3d mean_vibrating_force(const CuttingCoefficients& K, std::span<const double> offsets,
                                     std::span<const EdgeSlice> slices,
                                     const EdgeRotation& rotation, double c, double wear,
                                     const PassageDifferences& between);

}  // namespace servomill::plant
