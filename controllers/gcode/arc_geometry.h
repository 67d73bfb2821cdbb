/// Circles of G2 and G3 in their plane.
#pragma once

#include <Eigen/Core>
#include <string>

namespace servomill::controllers {

/// How far the geometry of an arc may be off. LinuxCNC's default values; they depend on the unit in
/// force (G20 or G21), because they stand for the rounding of the program's numbers.
struct ArcTolerance {
  double spiral;    // m, radius at the end against radius at the start, if also over `relative`
  double relative;  // the same, relative
  double radius;    // m, smallest radius, and how much an R may be too short for its chord
};

inline constexpr double kSqrt2 = 1.4142135623730951;
inline constexpr ArcTolerance kArcToleranceMm = {2.0 * 0.01e-3 * kSqrt2, 1e-3, 1.27e-6};
inline constexpr ArcTolerance kArcToleranceInch = {2.0 * 25.4e-6 * kSqrt2, 1e-3, 1.27e-6};

/// Centre of an arc, or why there is none (`fault` not empty).
struct ArcCentre {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::string fault;
};

/// Checks the centre given by I J K.
/// @param start, end, centre  (2; m) in the order of the plane: XY, ZX, YZ
ArcCentre centre_format(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                        const Eigen::Vector2d& centre, const ArcTolerance& tolerance);

/// Centre of the arc of radius |R| (m); R < 0 asks for the arc longer than a semicircle.
ArcCentre radius_format(const Eigen::Vector2d& start, const Eigen::Vector2d& end, double R,
                        bool clockwise, const ArcTolerance& tolerance);

}  // namespace servomill::controllers
