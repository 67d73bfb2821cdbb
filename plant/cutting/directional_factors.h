/// Directional factors of milling: the change of the cutting force by a displacement of the cutter
/// against the surface that the tooth before has left.
///
/// A tooth in the cut removes a chip that is thicker by  sin(kappa) r . (x(t) - x(t - T)),  x the
/// displacement across the axis, T the time from tooth to tooth. By (1) of cutting_force.h
///
///     F = -A(t) (x(t) - x(t - T)),
///     A = sum over teeth and edges of  db sin(kappa) [K_tc t + (K_rc sin(kappa) + K_ac
///         cos(kappa)) r] r^T                                                                   (1)
///
/// along e1, e2. A has the period T. A slot of depth a with four straight teeth has a constant one,
/// A = a [K_rc, K_tc; -K_tc, K_rc].
///
/// Source: Y. Altintas, Manufacturing Automation, 2nd ed., 2012, section 4.5 (its directional
/// coefficients count along x = e1 and y = -e2, and without the depth).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "plant/cutting/material.h"
#include "plant/cutting/tooth_force.h"

namespace servomill::plant {

/// Means of A (N/m) over equal parts of a tooth passage, from the passage of tooth 0 at phi = 0 on.
std::vector<Eigen::Matrix2d> directional_factors(const CuttingCoefficients& K, int teeth,
                                                 std::span<const EdgeSlice> slices, int parts);

/// Slices of a straight piece of the flank of a cutter, from its tip to a height `depth` (m), that
/// is in the cut from phi = from to phi = to (rad, 0 <= from < to <= pi).
std::vector<EdgeSlice> flank_slices(double depth, double from, double to, double helix,
                                    double radius);

}  // namespace servomill::plant
