/// The narrowest zones that hold measured points: straightness, flatness and cylindricity. The
/// roundness is that of circle_fit.h.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/metrology/cylinder_fit.h"
#include "sim/metrology/line_fit.h"
#include "sim/metrology/plane_fit.h"
#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

/// Between two surfaces parallel to a shape, half the width on either side.
template <typename Shape>
struct Zone {
  Shape middle;
  double width = 0.0;
};

/// The two parallel lines of smallest distance that enclose the points: exactly, for points of any
/// form. One of them holds an edge of the convex hull and the other the corner farthest from it;
/// all edges are tried. The direction is from the first point towards the last.
/// nullopt: all points are in one place
/// Source: M. E. Houle, G. T. Toussaint, Computing the width of a set, IEEE Trans. Pattern Anal.
/// Mach. Intell. 10 (1988), theorem 2.1.
std::optional<Zone<Line2>> minimum_zone_line(Points2 points);

/// The two parallel planes of smallest distance that enclose the points. The search begins at the
/// least-squares plane and ends where every small turn widens the zone.
/// @pre the width is small against the extent of the points in the plane; else a zone of smaller
///      width may exist far away
/// @param outside  as for least_squares_plane
/// nullopt: the points lie in one place or on a line
std::optional<Zone<Plane>> minimum_zone_plane(Points3 points, const Eigen::Vector3d& outside);

/// The two coaxial cylinders of smallest radial separation that enclose the points, likewise.
/// @pre the points go around the axis: no gap of half a turn or more, at both ends
/// @param near  as for least_squares_cylinder
/// nullopt: as there
std::optional<Zone<Cylinder>> minimum_zone_cylinder(Points3 points, const Eigen::Vector3d& near);

}  // namespace servomill::sim::metrology
