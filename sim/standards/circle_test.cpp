#include "sim/standards/circle_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "plant/vocabulary/units.h"
#include "sim/numerics/dense_solver.h"
#include "sim/readings/columns.h"

namespace servomill::sim::standards {
namespace {

using Eigen::Vector2d;
using metrology::Sense;

constexpr double kLikelyRadius = 0.2 * mm;  // difference of a radius that is entered rightly
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string_view sense_name(Sense sense) {
  return sense == Sense::counter_clockwise ? "ccw" : "cw";
}

std::optional<Sense> sense_of_word(std::string_view word) {
  if (word == "ccw" || word == "+" || word == "1") return Sense::counter_clockwise;
  if (word == "cw" || word == "-" || word == "-1") return Sense::clockwise;
  return std::nullopt;
}

CirclePath& turn_of(CircleTest& test, Sense sense) {
  for (CirclePath& turn : test.turns) {
    if (turn.sense == sense) return turn;
  }
  return test.turns.emplace_back(CirclePath{sense, {}, {}});
}

// Refuses arcs, and turns that go the other way than their rows say.
void check(const CircleTest& test, const std::string& file) {
  std::vector<Fault> faults;
  const metrology::Circle nominal{Vector2d::Zero(), test.radius};
  for (const CirclePath& turn : test.turns) {
    const std::string_view name = sense_name(turn.sense);
    if (const auto why = metrology::why_no_turn(turn.points, nominal, metrology::kWidestSpacing)) {
      faults.push_back({{file},
                        fmt::format("the {} circle {}; remove the feed-in and feed-out arcs, and "
                                    "check the radius and its unit",
                                    name, *why)});
    } else if (metrology::sense_of(turn.points, nominal) != turn.sense) {
      faults.push_back({{file},
                        fmt::format("the {} circle runs in the opposite direction; put its rows in "
                                    "the order of the motion, or correct the direction",
                                    name)});
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Columns of a table of readings on a circle.
struct CircleColumns {
  const readings::Column *direction = nullptr, *angle = nullptr, *deviation = nullptr, *x = nullptr,
                         *y = nullptr;
  bool is_ball_bar() const { return angle != nullptr; }
};

void require_unit(const readings::Table& table, const readings::Column* column,
                  config::Quantity quantity, std::string_view example, std::vector<Fault>& faults) {
  if (column == nullptr) {
    faults.push_back({{table.file}, fmt::format("column {} is missing", example)});
  } else if (!(column->unit.quantity == quantity)) {
    faults.push_back(
        {{table.file},
         fmt::format("column {} must name its unit, such as {}", column->written, example)});
  }
}

CircleColumns columns_of(const readings::Table& table, std::vector<Fault>& faults) {
  CircleColumns out{table.find("direction"), table.find("angle"), table.find("deviation"),
                    table.find("x"), table.find("y")};
  if (out.direction == nullptr) {
    faults.push_back({{table.file}, "column direction is missing; it must be ccw or cw"});
  }
  if (out.is_ball_bar()) {
    require_unit(table, out.angle, config::kAngle, "angle_deg", faults);
    require_unit(table, out.deviation, config::kLength, "deviation_um", faults);
  } else if (out.x != nullptr || out.y != nullptr) {
    require_unit(table, out.x, config::kLength, "x_mm", faults);
    require_unit(table, out.y, config::kLength, "y_mm", faults);
  } else {
    faults.push_back({{table.file},
                      "has no circle: columns angle_deg and deviation_um of a ball bar, or x_mm "
                      "and y_mm of a grid encoder, are missing"});
  }
  return out;
}

Vector2d point_of(const readings::Table& table, const readings::Row& row,
                  const CircleColumns& columns, double radius, std::vector<Fault>& faults) {
  const auto number = [&](const readings::Column& column) {
    const auto value = table.number(row, column, faults);
    if (!value) {
      faults.push_back({table.place(row, column), fmt::format("{} is empty", column.written)});
    }
    return value.value_or(0.0);
  };
  if (!columns.is_ball_bar()) return {number(*columns.x), number(*columns.y)};
  const double angle = number(*columns.angle), deviation = number(*columns.deviation);
  if (std::abs(deviation) > readings::kLargestDeviation) {
    faults.push_back({table.place(row, *columns.deviation),
                      fmt::format("deviation of {:g} mm; must be at most {:g} mm: check the unit, "
                                  "and that it is a deviation from the nominal radius",
                                  deviation / mm, readings::kLargestDeviation / mm)});
  }
  return (radius + deviation) * Vector2d(std::cos(angle), std::sin(angle));
}

void add_turn(const metrology::CircularTurn& turn, Report& out) {
  const std::string name(sense_name(turn.sense));
  const auto add = [&](std::string symbol, std::string meaning, double value) {
    out.values.push_back({std::move(symbol), std::move(meaning), value});
  };
  add("G_" + name, "circular error " + name + ", minimum zone", turn.G);
  add("G_LSC_" + name, "circular error " + name + ", least-squares centre", turn.G_least_squares);
  add("F_max_" + name, "largest radial error " + name + ", least-squares centre", turn.F_max);
  add("F_min_" + name, "smallest radial error " + name + ", least-squares centre", turn.F_min);
  add("F_max_set_up_" + name, "largest radial error " + name + ", centre of the set-up",
      turn.F_max_set_up);
  add("F_min_set_up_" + name, "smallest radial error " + name + ", centre of the set-up",
      turn.F_min_set_up);
}

ReportTable reversal_table(const std::vector<metrology::CircularTurn>& turns) {
  ReportTable out{"reversal", true, {}, {}};
  for (const char* const name : {"first axis, 0 deg", "second axis, 90 deg", "first axis, 180 deg",
                                 "second axis, 270 deg"}) {
    out.rows.emplace_back(name);
  }
  for (const metrology::CircularTurn& turn : turns) {
    ReportColumn step{fmt::format("step {}", sense_name(turn.sense)), Dimension::length, false, {}};
    ReportColumn spike{
        fmt::format("spike {}", sense_name(turn.sense)), Dimension::length, false, {}};
    for (const metrology::Reversal& one : turn.reversals) {
      step.values.push_back(one.step);
      spike.values.push_back(one.spike);
    }
    out.columns.push_back(std::move(step));
    out.columns.push_back(std::move(spike));
  }
  return out;
}

// Radial errors about the least-squares centre, as the polar diagram magnifies them.
ReportTable curve_table(const CirclePath& turn, double radius) {
  ReportTable out{fmt::format("curve {}", sense_name(turn.sense)), true, {}, {}};
  out.columns.push_back({"angle", Dimension::angle, true, {}});
  out.columns.push_back({"radial error", Dimension::length, false, {}});
  const metrology::Circle mine{metrology::least_squares_circle(turn.points).centre, radius};
  for (const auto& [theta, dr] : metrology::radial_error(turn.points, mine)) {
    out.columns[0].values.push_back(theta);
    out.columns[1].values.push_back(dr);
  }
  return out;
}

// Radius of each point less the cubic through the two points on either side of it (m).
std::vector<double> off_neighbours(const CirclePath& turn) {
  const auto n = static_cast<std::ptrdiff_t>(turn.points.size());
  const auto r = [&](std::ptrdiff_t i) {
    return turn.points[static_cast<std::size_t>((i + n) % n)].norm();
  };
  std::vector<double> out;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    out.push_back(r(i) - (4.0 * (r(i - 1) + r(i + 1)) - (r(i - 2) + r(i + 2))) / 6.0);
  }
  return out;
}

// Single points far off the curve through their neighbours. They put these off by 2/3 the other
// way; a step at a reversal does so on one side only.
void add_outliers(const CirclePath& turn, Report& out) {
  constexpr double kFar = 10.0;          // of the usual distance
  constexpr double kDisplay = 0.2 * um;  // usual distance: a step of the display
  constexpr double kOpposite = 0.5;
  constexpr std::size_t kFewest = 16;
  const std::size_t n = turn.points.size();
  if (n < kFewest) return;
  const std::vector<double> off = off_neighbours(turn);
  std::vector<double> sizes;
  for (const double one : off) sizes.push_back(std::abs(one));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double usual = std::max(*middle, kDisplay);
  for (std::size_t i = 0; i < n; ++i) {
    const double before = off[(i + n - 1) % n] / off[i], after = off[(i + 1) % n] / off[i];
    if (std::abs(off[i]) <= kFar * usual || before > -kOpposite || after > -kOpposite) continue;
    out.remarks.push_back(
        fmt::format("{}: is {:.4g} um off its neighbours on the circle {}; it is evaluated: check "
                    "it at the machine",
                    to_string(turn.places[i]), off[i] / um, sense_name(turn.sense)));
  }
}

// Rows that are there twice.
void add_copies(const CirclePath& turn, Report& out) {
  std::map<std::pair<double, double>, int> lines;
  for (std::size_t i = 0; i < turn.points.size(); ++i) {
    const auto [found, is_new] =
        lines.try_emplace({turn.points[i].x(), turn.points[i].y()}, turn.places[i].line);
    if (is_new) continue;
    out.remarks.push_back(
        fmt::format("{}: equals line {} on the circle {}; it is used: remove copied rows",
                    to_string(turn.places[i]), found->second, sense_name(turn.sense)));
  }
}

}  // namespace

CircleTest read_circle(const std::string& path, double radius) {
  const readings::Table table = readings::read_table(path);
  std::vector<Fault> faults;
  const CircleColumns columns = columns_of(table, faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  CircleTest out{path, radius, {}};
  for (const readings::Row& row : table.rows) {
    const std::string& word = table.text(row, *columns.direction);
    const auto sense = sense_of_word(word);
    if (!sense) {
      faults.push_back({table.place(row, *columns.direction),
                        fmt::format("direction = {}; must be ccw or cw", word)});
      continue;
    }
    CirclePath& turn = turn_of(out, *sense);
    turn.points.push_back(point_of(table, row, columns, radius, faults));
    turn.places.push_back({path, row.line});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  check(out, path);
  return out;
}

std::vector<CircleTest> circles_of(const readings::Group& group, const JointLayout& layout) {
  std::map<int, CircleTest> runs;
  const int a = *layout.joint_of(group.plane[0]), b = *layout.joint_of(group.plane[1]);
  for (const readings::Reading& one : group.rows) {
    const Vector2d nominal(one.Q[a] - group.at[a], one.Q[b] - group.at[b]);
    const Vector2d travel(one.direction[static_cast<std::size_t>(a)],
                          one.direction[static_cast<std::size_t>(b)]);
    // moment of the travel about the centre
    const double sense = nominal.x() * travel.y() - nominal.y() * travel.x();
    if (sense == 0.0) {
      throw InputError({group.file, one.line}, "has no direction; a circular test needs ccw or cw");
    }
    CircleTest& run =
        runs.try_emplace(one.run, CircleTest{group.name, group.radius, {}}).first->second;
    CirclePath& turn = turn_of(run, sense > 0.0 ? Sense::counter_clockwise : Sense::clockwise);
    turn.points.emplace_back(nominal.normalized() * (group.radius + one.deviation[0]));
    turn.places.push_back({group.file, one.line});
  }
  std::vector<CircleTest> out;
  for (auto& [run, test] : runs) {
    if (runs.size() > 1) test.name += fmt::format(", run {}", run + 1);
    check(test, group.file);
    out.push_back(std::move(test));
  }
  return out;
}

CircleFit fit_circle(const CircleTest& test) {
  constexpr int kUnknowns = 7;
  std::vector<Vector2d> all;
  for (const CirclePath& turn : test.turns) {
    all.insert(all.end(), turn.points.begin(), turn.points.end());
  }
  const metrology::Circle about{metrology::least_squares_circle(all).centre, test.radius};
  Eigen::MatrixXd A(static_cast<Eigen::Index>(all.size()), kUnknowns);
  Eigen::VectorXd b(A.rows());
  Eigen::Index i = 0;
  for (const CirclePath& turn : test.turns) {
    const double sense = turn.sense == Sense::counter_clockwise ? 1.0 : -1.0;
    for (const auto& [theta, dr] : metrology::radial_error(turn.points, about)) {
      const double c = std::cos(theta), s = std::sin(theta);
      const auto sign = [](double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0; };
      A.row(i) << 1.0, c, s, std::cos(2.0 * theta), std::sin(2.0 * theta),
          0.5 * sign(-sense * s) * c, 0.5 * sign(sense * c) * s;
      b[i++] = dr;
    }
  }
  const Eigen::VectorXd x = numerics::least_squares(A, b);
  return {2.0 * x[4] / test.radius, 2.0 * x[3] / test.radius, {x[5], x[6]}};
}

Report circle_report(const CircleTest& test) {
  const metrology::Circle nominal{Vector2d::Zero(), test.radius};
  Report out;
  out.standard = "ISO 230-4";
  out.name = test.name;
  std::vector<metrology::CircularTurn> turns;
  for (const CirclePath& turn : test.turns) {
    turns.push_back(metrology::evaluate_turn(turn.points, nominal));
    const double off = turns.back().least_squares.radius - test.radius;
    if (std::abs(off) > kLikelyRadius) {
      out.remarks.push_back(fmt::format(
          "the circle {} is {:.3g} mm {} than the nominal radius: "
          "check the length of the bar and the radius",
          sense_name(turn.sense), std::abs(off) / mm, off > 0.0 ? "larger" : "smaller"));
    }
    add_turn(turns.back(), out);
    if (turn.places.size() == turn.points.size()) {
      add_outliers(turn, out);
      add_copies(turn, out);
    }
  }
  const bool both = test.turns.size() == 2;
  double G_b = kNone, D = kNone;
  if (both) {
    const auto circle =
        metrology::evaluate_both(test.turns[0].points, test.turns[1].points, nominal);
    G_b = circle.G_b;
    D = circle.D;
  } else {
    out.remarks.push_back(
        fmt::format("one circle, {}: G_b and D need one in the other direction, and squareness "
                    "includes direction-dependent errors",
                    sense_name(test.turns[0].sense)));
  }
  out.values.push_back({"G_b", "bi-directional circular error, minimum zone", G_b});
  out.values.push_back({"D", "mean bi-directional radial error (nominal minus actual)", D});
  const CircleFit fit = fit_circle(test);
  out.values.push_back({"squareness", "positive: angle between the positive axes below 90 deg",
                        fit.squareness, Dimension::angle});
  out.values.push_back({"scale_mismatch", "scale of the first axis minus that of the second",
                        fit.scale_mismatch, Dimension::ratio});
  out.values.push_back(
      {"B_1", "reversal error of the first axis, upwards minus downwards", fit.B[0]});
  out.values.push_back({"B_2", "reversal error of the second axis, likewise", fit.B[1]});
  out.headline = fmt::format("radius {:.6g} mm, {}", test.radius / mm,
                             both ? "one circle in each direction" : "one circle");
  out.tables.push_back(reversal_table(turns));
  for (const CirclePath& turn : test.turns) out.tables.push_back(curve_table(turn, test.radius));
  return out;
}

}  // namespace servomill::sim::standards
