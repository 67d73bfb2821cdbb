#include "controllers/tables/control_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::controllers {

double ControlTable::within(double position) const {
  constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
  if (is_one_turn && (position < 0.0 || position > kTurn)) {
    return position - kTurn * std::floor(position / kTurn);
  }
  const double first = points.front().position, length = points.back().position - first;
  if (repeats && (position < first || position > first + length)) {
    return position - length * std::floor((position - first) / length);
  }
  return position;
}

const TablePoint& ControlTable::point_below(double position) const {
  const double at = within(position);
  const auto above =
      std::upper_bound(points.begin(), points.end(), at,
                       [](double value, const TablePoint& p) { return value < p.position; });
  return above == points.begin() ? points.front() : *(above - 1);
}

double ControlTable::at(double position, int direction) const {
  const double at = within(position);
  const auto value = [direction](const TablePoint& p) { return direction < 0 ? p.down : p.up; };
  const TablePoint& a = point_below(position);
  if (at <= points.front().position || &a == &points.back()) return value(a);
  const TablePoint& b = *(&a + 1);
  return value(a) + (at - a.position) / (b.position - a.position) * (value(b) - value(a));
}

}  // namespace servomill::controllers
