#include "sim/standards/ball_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/readings/columns.h"

namespace servomill::sim::standards {
namespace {

constexpr std::array<std::string_view, 7> kSensorColumns = {"radial", "tangential", "axial", "bar",
                                                            "dx",     "dy",         "dz"};

int direction_of(std::string_view word) {
  constexpr std::array<std::string_view, 5> kUp = {"forward", "ccw", "up", "+", "1"};
  constexpr std::array<std::string_view, 5> kDown = {"backward", "cw", "down", "-", "-1"};
  if (std::find(kUp.begin(), kUp.end(), word) != kUp.end()) return 1;
  return std::find(kDown.begin(), kDown.end(), word) != kDown.end() ? -1 : 0;
}

std::string_view direction_name(int direction) {
  return direction > 0 ? "forward" : direction < 0 ? "backward" : "all";
}

BallTest::Path& path_of(BallTest& test, int direction) {
  for (BallTest::Path& path : test.paths) {
    if (path.direction == direction) return path;
  }
  BallTest::Path path{direction, {}, {}};
  path.values.resize(test.sensors.size());
  return test.paths.emplace_back(std::move(path));
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// A reading of a sensor; a fault where there is none, or one too large for its unit.
double reading_of(const readings::Table& table, const readings::Row& row,
                  const readings::Column& column, std::vector<Fault>& faults) {
  const auto value = table.number(row, column, faults);
  if (!value) {
    faults.push_back({table.place(row, column), fmt::format("{} is empty", column.written)});
  } else if (std::abs(*value) > readings::kLargestDeviation) {
    faults.push_back(
        {table.place(row, column),
         fmt::format("{} = {}; must be at most {:g} mm: check the unit", column.written,
                     table.text(row, column), readings::kLargestDeviation / mm)});
  }
  return value.value_or(0.0);
}

// The column of angles, if there is one.
const readings::Column* angle_of(const readings::Table& table) {
  for (const std::string_view name : {"angle", "A", "B", "C"}) {
    const readings::Column* column = table.find(name);
    if (column != nullptr && column->unit.quantity == config::kAngle) return column;
  }
  return nullptr;
}

// Readings of one path in their order.
ReportTable curve_of(const BallTest& test, const BallTest::Path& path) {
  ReportTable out{fmt::format("curve {}", direction_name(path.direction)), true, {}, {}};
  if (path.angles.size() == path.values[0].size()) {
    out.columns.push_back({"angle", Dimension::angle, true, path.angles});
  } else {
    std::vector<double> numbers(path.values[0].size());
    std::iota(numbers.begin(), numbers.end(), 1.0);
    out.columns.push_back({"reading", Dimension::count, false, std::move(numbers)});
  }
  for (std::size_t k = 0; k < test.sensors.size(); ++k) {
    out.columns.push_back({test.sensors[k], Dimension::length, false, path.values[k]});
  }
  return out;
}

// The sensors of a table, and their names.
std::vector<const readings::Column*> sensors_of(const readings::Table& table, BallTest& out) {
  std::vector<Fault> faults;
  std::vector<const readings::Column*> columns;
  for (const std::string_view name : kSensorColumns) {
    const readings::Column* column = table.find(name);
    if (column == nullptr) continue;
    if (!(column->unit.quantity == config::kLength)) {
      faults.push_back(
          {{table.file},
           fmt::format("column {} must name its unit, such as {}_um", column->written, name)});
    }
    columns.push_back(column);
    out.sensors.emplace_back(name);
  }
  if (columns.empty()) {
    faults.push_back({{table.file},
                      fmt::format("has no sensor; known are {} with a unit, such as "
                                  "radial_um",
                                  fmt::join(kSensorColumns, ", "))});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return columns;
}

// The rotary joint that moves; none where several do, or none.
std::optional<int> turning_joint(const readings::Group& group) {
  std::optional<int> out;
  for (int j = kLinearJoints; j < kJoints; ++j) {
    const bool moves = std::any_of(group.rows.begin(), group.rows.end(), [&](const auto& row) {
      return row.Q[j] != group.rows.front().Q[j];
    });
    if (moves && out) return std::nullopt;
    if (moves) out = j;
  }
  return out;
}

}  // namespace

BallTest read_ball(const std::string& path) {
  const readings::Table table = readings::read_table(path);
  BallTest out{path, {}, {}};
  const std::vector<const readings::Column*> columns = sensors_of(table, out);
  const readings::Column* direction = table.find("direction");
  const readings::Column* angle = angle_of(table);
  std::vector<Fault> faults;
  for (const readings::Row& row : table.rows) {
    const int sense = direction == nullptr ? 0 : direction_of(table.text(row, *direction));
    if (direction != nullptr && sense == 0) {
      faults.push_back({table.place(row, *direction),
                        fmt::format("direction = {}; must be forward or backward (ccw, cw)",
                                    table.text(row, *direction))});
      continue;
    }
    BallTest::Path& mine = path_of(out, sense);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      mine.values[k].push_back(reading_of(table, row, *columns[k], faults));
    }
    if (angle == nullptr) continue;
    if (const auto value = table.number(row, *angle, faults)) mine.angles.push_back(*value);
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return out;
}

BallTest ball_of(const readings::Group& group) {
  BallTest out{group.name, {"dx", "dy", "dz"}, {}};
  const auto turning = turning_joint(group);
  for (const readings::Reading& one : group.rows) {
    const auto moved = std::find_if(one.direction.begin(), one.direction.end(),
                                    [](int direction) { return direction != 0; });
    BallTest::Path& mine = path_of(out, moved == one.direction.end() ? 0 : *moved);
    for (std::size_t k = 0; k < 3; ++k) {
      mine.values[k].push_back(one.deviation[static_cast<Eigen::Index>(k)]);
    }
    if (turning) mine.angles.push_back(one.Q[*turning]);
  }
  return out;
}

Report ball_report(const BallTest& test) {
  Report out;
  out.standard = "ISO 10791-6";
  out.name = test.name;
  const std::size_t readings = std::accumulate(
      test.paths.begin(), test.paths.end(), std::size_t{0},
      [](std::size_t sum, const BallTest::Path& path) { return sum + path.values[0].size(); });
  out.headline = fmt::format("{} readings, ranges of the sensors", readings);
  for (std::size_t k = 0; k < test.sensors.size(); ++k) {
    std::vector<double> both;
    for (const BallTest::Path& path : test.paths) {
      both.insert(both.end(), path.values[k].begin(), path.values[k].end());
      if (test.paths.size() < 2) continue;
      const std::string_view name = direction_name(path.direction);
      out.values.push_back({fmt::format("{}_{}", test.sensors[k], name),
                            fmt::format("range of {}, {}", test.sensors[k], name),
                            range(path.values[k])});
    }
    out.values.push_back({test.sensors[k],
                          fmt::format("range of {}{}", test.sensors[k],
                                      test.paths.size() > 1 ? ", both directions" : ""),
                          range(both)});
  }
  for (const BallTest::Path& path : test.paths) out.tables.push_back(curve_of(test, path));
  if (test.paths.size() < 2) {
    out.remarks.emplace_back(
        "one direction: ISO 10791-6 requires both; give them in a column direction");
  }
  return out;
}

}  // namespace servomill::sim::standards
