/// Force on a milling cutter: what its edges feel of the material they are in, on average over a
/// turn and at an angle of rotation.
///
/// Frame of the cutter: e1 along the feed as far as that is across the axis, k the axis from the
/// tip to the spindle, e2 = k x e1 (left of the feed). The cutter turns clockwise seen from the
/// spindle; phi is the angle of a tooth from e2 in that sense:
///
///               e1, feed
///           phi = 90 deg            r(phi) =  sin(phi) e1 + cos(phi) e2     outward
///                 |                 t(phi) =  cos(phi) e1 - sin(phi) e2     cutting speed
///     e2 <--- 0 --o-- 180           n = sin(kappa) r - cos(kappa) k         normal of the envelope
///                                   m = cos(kappa) r + sin(kappa) k         along its profile
///
/// A piece of edge of length db feels  dF = -(K_tc h + K_te) db t - (K_rc h + K_re) db n
///                                          -(K_ac h + K_ae) db m                               (1)
/// as long as it removes a chip: h = c (f . n) > 0, c the feed per tooth, f the direction of feed
/// (unit). kappa is 90 deg on the flank, 0 on a flat bottom, between them on a corner radius.
///
/// Sources: Y. Altintas, Manufacturing Automation, 2nd ed., 2012, section 2.8, for the flank (its
/// F_z counts along -k: the force draws a cutter with right-hand helix towards the work);
/// S. Engin, Y. Altintas, Mechanics and dynamics of general milling cutters, part I, Int. J. Mach.
/// Tools Manuf. 41 (2001), for other kappa.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <numbers>
#include <span>

#include "plant/cutting/cutter.h"
#include "plant/cutting/material.h"

namespace servomill::plant {

/// A piece of the cutter's profile, and the angles at which its edges are in material.
struct EngagedArc {
  double width = 0.0;                     // m, db: dz on the flank, dr on a flat bottom
  double height = 0.0;                    // m, of its middle above the tip
  double kappa = 0.5 * std::numbers::pi;  // rad
  double from = 0.0, to = 0.0;            // rad, phi; 0 <= to - from <= 2 pi
  double radius = std::numeric_limits<double>::quiet_NaN();  // m, of its middle from the axis
};

/// Direction of feed f = across e1 + along k, a unit vector, across >= 0. along < 0: it plunges.
struct FeedDirection {
  double across = 1.0, along = 0.0;
};

/// Average force over a turn, as the part that grows with the feed per tooth and that of the edge:
/// F = c shear + wear edge. Components along e1, e2, k.
struct CuttingForce {
  Eigen::Vector3d shear = Eigen::Vector3d::Zero();  // N/m
  Eigen::Vector3d edge = Eigen::Vector3d::Zero();   // N

  /// @param c     m, feed per tooth
  /// @param wear  1: as the coefficients are
  Eigen::Vector3d at(double c, double wear = 1.0) const { return c * shear + wear * edge; }
};

/// Range of phi in which a profile of that kappa removes chips: f . n > 0. from > to: nowhere.
struct AngleRange {
  double from = 1.0, to = 0.0;  // rad, -pi/2 <= from <= to <= 3/2 pi
  bool empty() const { return from > to; }
};
AngleRange contact_range(const FeedDirection& feed, double kappa);

/// (1) integrated over a turn, in closed form, times the teeth that pass in it. Independent of the
/// helix. Angles outside contact_range() count nothing.
///
/// Known answer: a slot of depth a with N teeth, F . e1 = -(N a/4) K_rc c - (N a/pi) K_re,
/// F . e2 = (N a/4) K_tc c + (N a/pi) K_te, F . k = -(N a/pi) K_ac c - (N a/2) K_ae.
CuttingForce average_force(const CuttingCoefficients& K, int teeth, const FeedDirection& feed,
                           std::span<const EngagedArc> arcs);

/// Average over a turn of the torque about the axis that turns the cutter: c shear + wear edge.
struct CuttingTorque {
  double shear = 0.0;  // N, per m of feed per tooth
  double edge = 0.0;   // N m
};

/// The same for the force along t times the radius at which it acts. Power at the edges is this
/// times the speed of the spindle; that of the feed is less than 1 % of it as a rule.
/// @pre the arcs have a radius
///
/// Known answer: a slot, N a R / (2 pi) (2 K_tc c + pi K_te).
CuttingTorque average_torque(const CuttingCoefficients& K, int teeth, const FeedDirection& feed,
                             std::span<const EngagedArc> arcs);

/// (1) summed over the teeth where they stand: tooth j at height z has
/// phi = theta + 2 pi j / N - z tan(helix) / R.
/// @param arcs   thin ones: each is as its middle
/// @param theta  rad, rotation of the cutter
/// @param c      m, feed per tooth
/// @return N, along e1, e2, k
Eigen::Vector3d force_at_rotation(const CuttingCoefficients& K, const Cutter& cutter,
                                  const FeedDirection& feed, std::span<const EngagedArc> arcs,
                                  double theta, double c, double wear = 1.0);

/// Feed per tooth (m) below which an edge no longer bears with its full edge term: a cutter that
/// stands in its slot has freed itself after a turn and feels nothing. A chosen value, a fraction
/// of an edge's radius.
inline constexpr double kBearingFeed = 1e-6;

/// Share of the edge term at a feed per tooth: c / kBearingFeed, at most 1.
constexpr double bearing_share(double c) { return c < kBearingFeed ? c / kBearingFeed : 1.0; }

}  // namespace servomill::plant
