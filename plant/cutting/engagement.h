/// Which pieces of a cutter's edges are in material at which angles of rotation.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

#include "plant/cutting/cutter.h"
#include "plant/cutting/cutting_force.h"

namespace servomill::plant {

/// A cutter as it moves: where it stands, where it goes and how it turns.
struct CutterMotion {
  CutterPosition position;
  Eigen::Vector3d feed = Eigen::Vector3d::UnitX();  // unit
  bool clockwise = true;  // seen from the spindle; else the frame of cutting_force.h is mirrored,
                          // e2 = e1 x k: a left-hand cutter
};

/// Frame of cutting_force.h (columns e1, e2, k) and the feed in it. Where the feed is along the
/// axis, e1 is any direction across it.
struct CutterFrame {
  Eigen::Matrix3d axes;
  FeedDirection feed;
};
CutterFrame frame_of(const CutterMotion& motion);

/// Directions x, y across an axis k from which angles of the spindle are counted, in the frame in
/// which k is given: x is its X as far as that is across k (its Y where k is within 0.1 deg of X),
/// y = k x x. At angle psi, clockwise seen from the spindle, tooth 0 is in the direction
/// sin(psi) x + cos(psi) y.
Eigen::Matrix<double, 3, 2> spindle_directions(const Eigen::Vector3d& k);

/// phi of a tooth at an angle of the spindle: phi = start + sense psi.
struct ToothAngle {
  double start = 0.0;  // rad
  double sense = 1.0;  // 1 clockwise, -1 counter-clockwise
  double at(double psi) const { return start + sense * psi; }
};
ToothAngle tooth_angle(const CutterFrame& frame);

/// True if there is material at a point (m, in the frame of the cutter's position).
using IsMaterial = std::function<bool(const Eigen::Vector3d&)>;

/// Pieces of the cutter's profile from the middle of its bottom over the corner to the end of the
/// flutes and the angles at which they are in material, as far as they remove chips there
/// (contact_range): the bottom of a flat cutter where it plunges.
///
/// The profile is searched at some heights, close to each other near the tip, and directions, close
/// to each other at the sides; where material begins or ends between two of them is found by
/// bisection. Material thinner than the steps between them may be missed: steps of the flank grow
/// from 5e-5 of the height that can be in material at the tip to 0.5 mm, those of the directions
/// from 0.5 deg at the sides to 15 deg in the middle.
/// @param within  no material is outside of this box
std::vector<EngagedArc> engagement(const Cutter& cutter, const CutterMotion& motion,
                                   const IsMaterial& is_material,
                                   const Eigen::AlignedBox3d& within);

/// Height above the tip (m) up to which these pieces reach, on a corner to 0.3 % of its radius; 0
/// for those of a flat bottom.
double engaged_height(std::span<const EngagedArc> arcs);

}  // namespace servomill::plant
