#include "sim/metrology/line_fit.h"

#include <Eigen/Geometry>

namespace servomill::sim::metrology {
namespace {

template <typename Line, typename Points>
std::optional<Line> line_through(Points points) {
  if (points.empty()) return std::nullopt;
  const auto axes = principal_axes(points);
  if (!axes.span_directions(1)) return std::nullopt;
  Line line{axes.mean, axes.axes.col(0)};
  if (line.direction.dot(points.back() - points.front()) < 0.0) line.direction *= -1.0;
  return line;
}

}  // namespace

double Line2::distance(const Eigen::Vector2d& p) const {
  return direction.x() * (p - point).y() - direction.y() * (p - point).x();
}

double Line3::distance(const Eigen::Vector3d& p) const { return direction.cross(p - point).norm(); }

std::optional<Line2> least_squares_line(Points2 points) { return line_through<Line2>(points); }
std::optional<Line3> least_squares_line(Points3 points) { return line_through<Line3>(points); }

}  // namespace servomill::sim::metrology
