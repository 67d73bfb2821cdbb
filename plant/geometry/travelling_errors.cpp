#include "plant/geometry/travelling_errors.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace servomill::plant {
namespace {

// A spline over several axes is one over each of them: through its values at the positions.
ErrorFunction on_line(const GridFunction& grid, Axis axis, AxisWords q) {
  const GridPoints& points = grid.points();
  const auto place = std::find(points.axes.begin(), points.axes.end(), axis);
  if (place == points.axes.end()) return constant(grid.value(q));
  const auto k = static_cast<std::size_t>(place - points.axes.begin());
  GridPoints line{{axis}, {points.at[k]}, {}, points.interpolation};
  if (!points.repeats.empty()) line.repeats = {points.repeats[k]};
  for (const double s : line.at.front()) {
    q[index_of(axis)] = s;
    line.error.push_back(grid.value(q));
  }
  return plant::grid(std::move(line));
}

}  // namespace

ErrorModel travelling(const ErrorModel& errors, Axis axis, double direction) {
  ErrorModel out = errors;
  for (const Axis of : kAllAxes) {
    ErrorFunction& error = out.component({of, axis, false});
    error = travelling(error, direction);
  }
  return out;
}

ErrorModel held(const ErrorModel& errors, Axis axis, const AxisWords& q) {
  ErrorModel out = errors;
  for (const Axis of : kAllAxes) {
    ErrorFunction& f = out.component({of, axis, false});
    std::vector<GridFunction> grids;
    grids.swap(f.grids);
    for (const GridFunction& g : grids) f = f + on_line(g, axis, q);
  }
  return out;
}

}  // namespace servomill::plant
