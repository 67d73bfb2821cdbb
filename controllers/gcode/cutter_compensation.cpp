#include "controllers/gcode/cutter_compensation.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kStraightTol = 0.05;     // rad; a corner that turns by less is none
constexpr double kMinEntryCosine = 1e-4;  // of the angle between the chord and the end of an arc

Vector2d left_of(const Vector2d& v) { return {-v.y(), v.x()}; }

// From the path to the tool, for a path in this direction.
Vector2d towards_tool(const Cutter& cutter, const Vector2d& direction) {
  const Vector2d left = left_of(direction);
  return cutter.is_left ? left : Vector2d(-left);
}

// Along the path, for a tool in this direction from it.
Vector2d along_path(const Cutter& cutter, const Vector2d& to_tool) {
  const Vector2d left = left_of(to_tool);
  return cutter.is_left ? Vector2d(-left) : left;
}

bool is_inside(const Cutter& cutter, int turns) { return cutter.is_left == (turns > 0); }

// +1 for a tool inside of the arc, on the side of its centre.
double inwards(const Cutter& cutter, int turns) { return is_inside(cutter, turns) ? 1.0 : -1.0; }

Vector2d direction_at_begin(const PlaneMove& move) {
  if (!move.is_arc) return (move.end - move.begin).normalized();
  const Vector2d left = left_of((move.begin - move.centre).normalized());
  return move.turns > 0 ? left : Vector2d(-left);
}

// From the end of the move to where the tool stands then, unit vector.
Vector2d to_tool_at_end(const Cutter& cutter, const PlaneMove& move) {
  if (!move.is_arc) return towards_tool(cutter, direction_at_begin(move));
  return inwards(cutter, move.turns) * (move.centre - move.end).normalized();
}

double sweep_of(const Vector2d& begin, const Vector2d& end, const Vector2d& centre, int turns) {
  const auto lift = [](const Vector2d& v) { return Eigen::Vector3d(v.x(), v.y(), 0.0); };
  return ArcSweep(lift(begin), lift(end), lift(centre), 2, turns).sweep;
}

std::string tool_too_large(double arc_radius, const Cutter& cutter) {
  return fmt::format(
      "the tool does not fit inside the arc: tool radius {:.4f} mm, arc radius {:.4f} mm",
      cutter.radius / mm, arc_radius / mm);
}

// How much the path turns away from the tool, in [-pi / 2, 3 pi / 2).
double turn_away(const Cutter& cutter, const Vector2d& before, const Vector2d& after) {
  const double cross = before.x() * after.y() - before.y() * after.x();
  const double left = std::atan2(cross, before.dot(after));
  const double away = cutter.is_left ? -left : left;
  return away < -pi / 2.0 ? away + 2.0 * pi : away;
}

// A tool that comes round an arc and turns back: it could go either way about the tangent point,
// and stays outside.
bool stays_outside(const Cutter& cutter, double away, const HeldMove& before,
                   const PlaneMove& next) {
  if (std::abs(away - pi) >= kStraightTol) return false;
  if (next.is_arc) return !is_inside(cutter, next.turns);
  return before.is_arc && !is_inside(cutter, before.turns);
}

constexpr std::string_view kNoMeeting =
    "the tool does not fit into the corner between {} and {} without gouging";

Corner line_to_line(const Cutter& cutter, const Vector2d& tool, const Vector2d& direction,
                    double away) {
  const double retreat = cutter.radius / std::tan((away + pi) / 2.0);
  return {CornerKind::concave, tool - retreat * direction, {}};
}

// Intersection of a line and a circle of the tool centre.
// @param height    of the line over the centre of the circle, towards `up` (m)
// @param forwards  which of the two points, along the line
std::optional<Vector2d> meeting(const Vector2d& centre, double radius, double height,
                                const Vector2d& up, const Vector2d& along, bool forwards) {
  if (!(std::abs(height) <= radius)) return std::nullopt;
  const double half_chord = std::sqrt((radius - height) * (radius + height));
  return centre + height * up + (forwards ? half_chord : -half_chord) * along;
}

Corner line_to_arc(const Cutter& cutter, const Vector2d& direction, double away,
                   const PlaneMove& arc) {
  const double R = (arc.end - arc.centre).norm();
  const double in = inwards(cutter, arc.turns);
  const double height = cutter.radius - in * R * std::cos(away);
  const auto point = meeting(arc.centre, R - in * cutter.radius, height,
                             towards_tool(cutter, direction), direction, in > 0.0);
  if (!point) return {CornerKind::concave, {}, fmt::format(kNoMeeting, "line", "arc")};
  return {CornerKind::concave, *point, {}};
}

Corner arc_to_line(const Cutter& cutter, const HeldMove& arc, const PlaneMove& line) {
  const double in = inwards(cutter, arc.turns);
  const double tool_R = (arc.centre - arc.end).norm();
  const double R = tool_R + in * cutter.radius;
  const Vector2d along = direction_at_begin(line);
  const Vector2d up = towards_tool(cutter, along);
  const double height = cutter.radius - R * up.dot((arc.centre - line.begin).normalized());
  const auto point = meeting(arc.centre, tool_R, height, up, along, in < 0.0);
  if (!point) return {CornerKind::concave, {}, fmt::format(kNoMeeting, "arc", "line")};
  return {CornerKind::concave, *point, {}};
}

Corner arc_to_arc(const Cutter& cutter, const HeldMove& before, const PlaneMove& next) {
  const double before_R = (before.centre - before.end).norm();
  const double next_R =
      (next.end - next.centre).norm() - inwards(cutter, next.turns) * cutter.radius;
  const Vector2d between = next.centre - before.centre;
  const double distance = between.norm();
  if (before_R == 0.0 || distance == 0.0) {
    return {CornerKind::concave,
            {},
            "two arcs with the same centre, and the corner between them is concave"};
  }
  // law of cosines
  const double cosine =
      (before_R * before_R + distance * distance - next_R * next_R) / (2.0 * before_R * distance);
  if (!(std::abs(cosine) <= 1.0)) {
    return {CornerKind::concave, {}, fmt::format(kNoMeeting, "arc", "arc")};
  }
  const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  const bool turns_left = is_inside(cutter, before.turns) == (next.turns > 0);
  const Vector2d along = between / distance;
  const Vector2d across = turns_left ? left_of(along) : Vector2d(-left_of(along));
  return {CornerKind::concave, before.centre + before_R * (cosine * along + sine * across), {}};
}

}  // namespace

Compensated entry_move(const Cutter& cutter, const PlaneMove& programmed) {
  const Vector2d& tool = programmed.begin;
  const double distance = (programmed.end - tool).norm();
  if (distance <= cutter.radius) {
    return {{},
            fmt::format("the first move with cutter compensation is {:.4f} mm long; must be longer "
                        "than the tool radius, {:.4f} mm",
                        distance / mm, cutter.radius / mm)};
  }
  const Vector2d to_tool = to_tool_at_end(cutter, programmed);
  HeldMove held;
  held.end = programmed.end + cutter.radius * to_tool;
  held.is_arc = programmed.is_arc;
  held.turns = programmed.turns;
  if (!programmed.is_arc) {
    held.direction = to_tool;
    return {held, {}};
  }
  const double arc_radius = (programmed.begin - programmed.centre).norm();
  if (is_inside(cutter, programmed.turns) && arc_radius <= cutter.radius) {
    return {held, tool_too_large(arc_radius, cutter)};
  }
  // The centre lies on the same ray from the end, as far from the tool as from the end.
  const Vector2d ray = (programmed.centre - held.end).normalized();
  const Vector2d chord = tool - held.end;
  const double cosine = chord.normalized().dot(ray);
  if (std::abs(cosine) < kMinEntryCosine) {
    return {held, "no arc connects the tool position with the end of the programmed arc"};
  }
  held.centre = held.end + chord.norm() / (2.0 * cosine) * ray;
  held.sweep = sweep_of(tool, held.end, held.centre, held.turns);
  return {held, {}};
}

Compensated following_move(const Cutter& cutter, const PlaneMove& programmed) {
  HeldMove held;
  held.end = programmed.end + cutter.radius * to_tool_at_end(cutter, programmed);
  if (!programmed.is_arc) {
    held.direction = programmed.end - programmed.begin;
    return {held, {}};
  }
  held.is_arc = true;
  held.centre = programmed.centre;
  held.turns = programmed.turns;
  held.sweep = sweep_of(programmed.begin, programmed.end, programmed.centre, programmed.turns);
  const double arc_radius = (programmed.end - programmed.centre).norm();
  if (is_inside(cutter, programmed.turns) && arc_radius <= cutter.radius) {
    return {held, tool_too_large(arc_radius, cutter)};
  }
  return {held, {}};
}

Corner corner(const Cutter& cutter, const Vector2d& tool, const HeldMove& before,
              const PlaneMove& next) {
  const Vector2d direction = along_path(cutter, (tool - next.begin).normalized());
  const Vector2d next_direction = direction_at_begin(next);
  const double away = turn_away(cutter, direction, next_direction);
  const bool is_concave =
      away < -kStraightTol || away > pi + kStraightTol || stays_outside(cutter, away, before, next);
  if (is_concave) {
    if (next.is_arc) {
      return before.is_arc ? arc_to_arc(cutter, before, next)
                           : line_to_arc(cutter, direction, away, next);
    }
    return before.is_arc ? arc_to_line(cutter, before, next)
                         : line_to_line(cutter, tool, direction, away);
  }
  if (away <= kStraightTol) return {CornerKind::straight, tool, {}};
  return {CornerKind::convex, point_beside_begin(cutter, next), {}};
}

Vector2d point_beside_begin(const Cutter& cutter, const PlaneMove& move) {
  return move.begin + cutter.radius * towards_tool(cutter, direction_at_begin(move));
}

std::string move_end(HeldMove& move, const std::optional<Vector2d>& begin, const Vector2d& end,
                     const EndTolerance& tolerance) {
  if (move.is_arc) {
    const double before = (move.end - move.centre).norm(), after = (end - move.centre).norm();
    if (std::abs(before - after) > tolerance.radius) {
      return fmt::format(
          "the compensated arc would have radius {:.4f} mm at its start, but {:.4f} mm at its end",
          before / mm, after / mm);
    }
    if (begin && std::abs(sweep_of(*begin, end, move.centre, move.turns)) >
                     std::abs(move.sweep) + tolerance.sweep) {
      return "the tool cannot reach the arc in the concave corner without gouging";
    }
  } else if (begin && move.direction.dot(end - *begin) < 0.0) {
    return "the tool cannot reach the line in the concave corner without gouging";
  }
  move.end = end;
  return {};
}

}  // namespace servomill::controllers
