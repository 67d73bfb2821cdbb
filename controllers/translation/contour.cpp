#include "controllers/translation/contour.h"

#include <array>
#include <cmath>
#include <numbers>

namespace servomill::controllers::translation {
namespace {

using std::numbers::pi;

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

Point tangent(const Element& arc, const Point& at) {
  const Point left = left_of((at - arc.centre).normalized());
  return arc.sweep > 0.0 ? left : Point(-left);
}

using Points = std::array<std::optional<Point>, 2>;

Points line_and_line(const Element& a, const Element& b) {
  const Point u = direction_at_begin(a), v = direction_at_begin(b);
  const double sine = cross(u, v);
  if (sine == 0.0) return {};
  return {Point(a.begin + cross(b.begin - a.begin, v) / sine * u), std::nullopt};
}

Points line_and_arc(const Element& line, const Element& arc) {
  const Point u = direction_at_begin(line);
  const Point middle = line.begin + (arc.centre - line.begin).dot(u) * u;
  const double r = (arc.begin - arc.centre).norm(), h = (middle - arc.centre).norm();
  if (h > r) return {};
  const double half = std::sqrt((r - h) * (r + h));
  return {Point(middle - half * u), Point(middle + half * u)};
}

Points arc_and_arc(const Element& a, const Element& b) {
  const Point between = b.centre - a.centre;
  const double d = between.norm();
  const double ra = (a.begin - a.centre).norm(), rb = (b.begin - b.centre).norm();
  if (d == 0.0) return {};
  const double along = (ra * ra - rb * rb + d * d) / (2.0 * d);
  if (std::abs(along) > ra) return {};
  const double half = std::sqrt((ra - along) * (ra + along));
  const Point u = between / d;
  const Point middle = a.centre + along * u;
  return {Point(middle - half * left_of(u)), Point(middle + half * left_of(u))};
}

}  // namespace

Point left_of(const Point& v) { return {-v.y(), v.x()}; }

Point direction_at_begin(const Element& element) {
  if (element.is_arc) return tangent(element, element.begin);
  const Point way = element.end - element.begin;
  return way.isZero(0.0) ? Point(Point::Zero()) : Point(way.normalized());
}

Point direction_at_end(const Element& element) {
  return element.is_arc ? tangent(element, element.end) : direction_at_begin(element);
}

double turn_at(const Point& before, const Point& after) {
  return std::atan2(cross(before, after), before.dot(after));
}

double sweep_between(const Point& centre, const Point& begin, const Point& end, double sign) {
  constexpr double kSame = 1e-6;  // mm; below the resolution of any control
  if ((end - begin).norm() < kSame) return sign * 2.0 * pi;
  double sweep = turn_at(begin - centre, end - centre);
  if (sign * sweep <= 0.0) sweep += sign * 2.0 * pi;
  return sweep;
}

std::optional<Element> tangential_arc(const Point& begin, const Point& along, const Point& end) {
  const Point chord = end - begin;
  const double side = cross(along, chord);  // > 0: the end lies to the left
  constexpr double kStraight = 1e-9;
  if (std::abs(side) <= kStraight * chord.norm()) return std::nullopt;
  Element arc;
  arc.begin = begin;
  arc.end = end;
  arc.is_arc = true;
  arc.centre = begin + chord.squaredNorm() / (2.0 * side) * left_of(along);
  arc.sweep = sweep_between(arc.centre, begin, end, side > 0.0 ? 1.0 : -1.0);
  return arc;
}

std::optional<Element> arc_of_radius(const Point& begin, const Point& end, double radius,
                                     double sign, bool is_large) {
  const Point chord = end - begin;
  const double half = chord.norm() / 2.0;
  constexpr double kRounding = 1e-3;  // mm, of a semicircle whose numbers are rounded
  if (half == 0.0 || half > radius + kRounding) return std::nullopt;
  const double height = half >= radius ? 0.0 : std::sqrt((radius - half) * (radius + half));
  // the centre of a small counter-clockwise arc lies to the left of its chord
  const double side = (sign > 0.0) != is_large ? 1.0 : -1.0;
  Element arc;
  arc.begin = begin;
  arc.end = end;
  arc.is_arc = true;
  arc.centre = begin + chord / 2.0 + side * height * left_of(chord.normalized());
  arc.sweep = sweep_between(arc.centre, begin, end, sign);
  return arc;
}

std::optional<Element> parallel(const Element& element, double distance) {
  Element out = element;
  if (!element.is_arc) {
    const Point shift = distance * left_of(direction_at_begin(element));
    out.begin += shift;
    out.end += shift;
    return out;
  }
  const double inwards = element.sweep > 0.0 ? distance : -distance;
  const double r = (element.begin - element.centre).norm();
  if (!(r - inwards > 0.0)) return std::nullopt;
  const auto moved = [&](const Point& p) {
    const Point ray = p - element.centre;
    return Point(element.centre + (ray.norm() - inwards) * ray.normalized());
  };
  out.begin = moved(element.begin);
  out.end = moved(element.end);
  return out;
}

std::optional<Point> meeting_point(const Element& a, const Element& b, const Point& near) {
  const Points found = a.is_arc   ? b.is_arc ? arc_and_arc(a, b) : line_and_arc(b, a)
                         : b.is_arc ? line_and_arc(a, b)
                                  : line_and_line(a, b);
  std::optional<Point> nearest;
  for (const auto& point : found) {
    if (point && (!nearest || (*point - near).norm() < (*nearest - near).norm())) nearest = point;
  }
  return nearest;
}

Point foot(const Element& element, const Point& point) {
  if (!element.is_arc) {
    const Point u = direction_at_begin(element);
    return element.begin + (point - element.begin).dot(u) * u;
  }
  const double r = (element.begin - element.centre).norm();
  return element.centre + r * (point - element.centre).normalized();
}

double position_on(const Element& element, const Point& point, double near) {
  if (!element.is_arc) {
    const Point way = element.end - element.begin;
    return (point - element.begin).dot(way) / way.squaredNorm();
  }
  const double turned = turn_at(element.begin - element.centre, point - element.centre);
  const double wanted = near * element.sweep;
  return (wanted + std::remainder(turned - wanted, 2.0 * pi)) / element.sweep;
}

Element cut_at_begin(Element element, const Point& begin) {
  if (element.is_arc) element.sweep *= 1.0 - position_on(element, begin, 0.0);
  element.begin = begin;
  return element;
}

Element cut_at_end(Element element, const Point& end) {
  if (element.is_arc) element.sweep *= position_on(element, end, 1.0);
  element.end = end;
  return element;
}

}  // namespace servomill::controllers::translation
