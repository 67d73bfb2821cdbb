/// Contour elements in their plane: offsets, corners, tangential arcs. All lengths in mm.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace servomill::controllers::translation {

using Point = Eigen::Vector2d;

/// A straight line or an arc in the plane, (2; mm) in the order of the plane: XY, YZ, ZX.
struct Element {
  Point begin = Point::Zero();
  Point end = Point::Zero();
  bool is_arc = false;
  Point centre = Point::Zero();  // of an arc
  double sweep = 0.0;            // of an arc; rad, > 0 counter-clockwise

  bool operator==(const Element&) const = default;
};

Point left_of(const Point& v);
/// Unit vectors of travel. Zero for a line without length.
Point direction_at_begin(const Element& element);
Point direction_at_end(const Element& element);
/// Angle by which the path turns left at a corner; rad, in (-pi, pi].
double turn_at(const Point& before, const Point& after);

/// The signed angle of an arc in the direction of `sign`, in (0, 2 pi]; 2 pi where the ends are
/// equal.
double sweep_between(const Point& centre, const Point& begin, const Point& end, double sign);

/// The arc that leaves `begin` in direction `along` and reaches `end`; nullopt where the end lies
/// straight ahead or behind.
std::optional<Element> tangential_arc(const Point& begin, const Point& along, const Point& end);

/// The arc of the radius from one point to another.
/// @param sign        +1 counter-clockwise
/// @param is_large    longer than a semicircle
/// @return nullopt where the radius is less than half the distance
std::optional<Element> arc_of_radius(const Point& begin, const Point& end, double radius,
                                     double sign, bool is_large);

/// The element offset to its left (`distance` > 0) or right; nullopt where the radius of an arc
/// would vanish.
std::optional<Element> parallel(const Element& element, double distance);

/// Intersection of two elements, each extended without limit, nearest to `near`.
std::optional<Point> meeting_point(const Element& a, const Element& b, const Point& near);

/// Foot of the perpendicular from a point to an element, extended without limit.
Point foot(const Element& element, const Point& point);

/// Fraction of an element at which a point on it is located: 0 at its start, 1 at its end. A point
/// on an arc has several such values, one turn apart; the one nearest to `near` is returned.
double position_on(const Element& element, const Point& point, double near);

/// The element with another start or end point on it.
Element cut_at_begin(Element element, const Point& begin);
Element cut_at_end(Element element, const Point& end);

}  // namespace servomill::controllers::translation
