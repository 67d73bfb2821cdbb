/// Milling cutters: the body that their teeth sweep as they turn.
///
///      |       |        axis k, from the tip to the spindle
///      |       |        height h above the tip (m)
///      |       |        flank: radius R
///       \_____/         corner radius r: 0 flat, R ball, between them bull nose
///          tip
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace servomill::plant {

/// An end mill. The body is convex: all points at height h in [0, length] no farther than
/// radius_at(h) from the axis.
struct Cutter {
  double radius = 0.0;         // R, m
  double corner_radius = 0.0;  // r, m, 0 <= r <= R
  double length = 0.0;         // m, of the flutes; nothing above them cuts
  int teeth = 2;
  double helix = 0.0;             // rad
  double runout = 0.0;            // m, radial: reading of an indicator over a turn, twice the
                                  // eccentricity
  double runout_direction = 0.0;  // rad, from tooth 0 in the sense of rotation

  bool is_flat() const { return corner_radius == 0.0; }
  bool is_ball() const { return corner_radius == radius; }

  /// Distance of the envelope from the axis (m) at height h (m): R - r + sqrt(r^2 - (r - h)^2) for
  /// h < r, else R.
  /// @pre 0 <= h <= length
  double radius_at(double h) const;

  /// Distance by which the edge of a tooth is farther from the axis of rotation (m), in first
  /// order: runout / 2 cos(2 pi tooth / teeth - runout_direction). 0 on average over equal teeth.
  double radius_offset(int tooth) const;
};

/// Largest plausible run-out of a cutter in its holder (m): a tool beyond it is not clamped.
inline constexpr double kMaxRunout = 0.2e-3;

/// Rules that the values break, each as "KEY RULE" ("corner_radius must be <= radius"). Empty for
/// a possible cutter.
std::vector<std::string> implausible(const Cutter& cutter);

/// Position of a cutter in the workpiece frame.
struct CutterPosition {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // k, from the tip to the spindle
};

}  // namespace servomill::plant
