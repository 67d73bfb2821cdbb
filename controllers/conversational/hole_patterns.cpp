// Cycles 220 (holes on a circle) and 221 (holes on lines): they run the drilling cycle defined last
// where they are defined. Source: iTNC 530 cycle programming, cycles 220 and 221, from memory:
// order of the holes, heights by Q301, and that Q200, Q203 and Q204 apply to the drilling cycle.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

constexpr int kMaxHoles = 99999;  // in a row, on a circle
constexpr double kFullCircle = 360.0;

Point in_direction(double degrees) { return {std::cos(degrees * deg), std::sin(degrees * deg)}; }

}  // namespace

void Translator::call_hole_pattern(bool is_circle) {
  const int number = is_circle ? 220 : 221;
  if (!cycle_ || cycle_->number < 200 || cycle_->number == 247) {
    fail(fmt::format("CYCL DEF {} requires a preceding drilling cycle (200 or higher)", number));
  }
  if (is_circle && parameters_.find({'Q', 365}).value_or(0.0) != 0.0) {
    fail(
        "cycle 220 with Q365 (travel along the pitch circle): the feed rate is undocumented; set "
        "Q365=0");
  }
  drill_points(is_circle ? points_on_circle() : points_on_lines());
}

// Centre Q216, Q217, diameter Q244, first angle Q245, last Q246, step Q247, count Q241. A step of 0
// divides the angle between the first and the last hole, or a full circle.
std::vector<Point> Translator::points_on_circle() const {
  const Point centre(q(216) * unit(), q(217) * unit());
  const double radius = 0.5 * q(244) * unit(), first = q(245);
  const int count = whole(q(241), kMaxHoles, place_, "Q241");
  if (count == 0) fail("Q241 must be > 0");
  double step = q(247);
  if (step == 0.0 && count > 1) {
    const double span = q(246) - first;
    step = span / (std::abs(span) == kFullCircle ? count : count - 1);
  }
  std::vector<Point> out;
  for (int i = 0; i < count; ++i) {
    out.emplace_back(centre + radius * in_direction(first + i * step));
  }
  return out;
}

// First hole Q225, Q226, spacing Q237 along a line and Q238 between lines, Q242 holes on each of
// Q243 lines, turned by Q224 about the first hole; every second line runs backwards.
std::vector<Point> Translator::points_on_lines() const {
  const Point start(q(225) * unit(), q(226) * unit());
  const Point along = in_direction(q(224)), across(-along.y(), along.x());
  const int columns = whole(q(242), kMaxHoles, place_, "Q242");
  const int lines = whole(q(243), kMaxHoles, place_, "Q243");
  if (columns == 0 || lines == 0) fail("Q242 and Q243 must be > 0");
  std::vector<Point> out;
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < columns; ++i) {
      const int column = line % 2 == 0 ? i : columns - 1 - i;
      out.emplace_back(start + column * q(237) * unit() * along + line * q(238) * unit() * across);
    }
  }
  return out;
}

// To the second set-up clearance, over the first hole, to the set-up clearance; then from hole to
// hole at the set-up clearance (Q301=0) or at the second one (Q301=1).
void Translator::drill_points(const std::vector<Point>& points) {
  const double surface = q(203) * unit(), clearance = surface + q(200) * unit();
  const double second = std::max(clearance, surface + q(204) * unit());
  const double between = parameters_.find({'Q', 301}).value_or(0.0);
  if (between != 0.0 && between != 1.0) fail(fmt::format("Q301={:g}; must be 0 or 1", between));
  if (between == 0.0 && second > clearance) {
    fail(
        "Q301=0 with a second set-up clearance: the height after the last hole is undocumented; "
        "set Q301=1, or Q204=0");
  }
  is_modal_call_ = false;
  cycle_move({}, second);
  for (const Point& point : points) {
    Positioning to;
    to.feed = Feed{};
    set_program_point(to, 2, point);
    move_straight(to);
    drill();
  }
}

}  // namespace servomill::controllers::conversational
