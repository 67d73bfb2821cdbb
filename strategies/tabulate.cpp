#include "strategies/tabulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/axis_displacement.h"
#include "strategies/optimal_points.h"
#include "strategies/pose_compensation.h"

namespace servomill::strategies {
namespace {

// "table over X", "grid over X, Y, Z"
std::string name_of(const std::vector<GridLine>& lines, const JointLayout& layout) {
  std::string name;
  for (const GridLine& line : lines) {
    name += fmt::format("{}{}", name.empty() ? "" : ", ", layout.letter_of(line.joint));
  }
  return fmt::format("{} over {}", lines.size() == 1 ? "table" : "grid", name);
}

constexpr double kLine = 256;

double max_points_of(const Parameters& p, double usual) {
  return p.is_word("max_points") ? usual : p.number("max_points");
}

// Keeps the best points of a table over one axis.
void choose_points(GridTable& table, std::size_t most) {
  GridLine& line = table.lines.front();
  std::vector<double> candidates;
  for (std::size_t i = 0; i < line.points; ++i) candidates.push_back(line.at(i));
  const std::vector<Eigen::Vector3d> values = std::move(table.value);
  table.value.clear();
  for (const std::size_t i : optimal_points(candidates, values, most)) {
    line.positions.push_back(candidates[i]);
    table.value.push_back(values[i]);
  }
  line.points = line.positions.size();
}

// Refuses tables that the NC would refuse, by the names that its operator reads.
void check_points(const std::vector<GridLine>& lines, const JointLayout& layout,
                  const Parameters& p) {
  constexpr double kLattice = 25.0 * 25.0 * 25.0;
  const double usual = lines.size() == 1 ? kLine : kLattice;
  const double most = max_points_of(p, usual);
  double all = 1.0;
  std::string product;
  for (const GridLine& line : lines) {
    all *= static_cast<double>(line.points);
    product += fmt::format("{}{}", product.empty() ? "" : " x ", line.points);
  }
  if (all <= most) return;
  if (lines.size() > 1) product += fmt::format(" = {:.0f}", all);
  throw InputError({}, fmt::format("{}: {} points; the NC accepts at most {} (max_points); use a "
                                   "larger spacing_mm or from_mm and to_mm",
                                   name_of(lines, layout), product, most));
}

// The search compares each candidate with all following ones.
void check_candidates(const GridLine& line, const JointLayout& layout) {
  constexpr std::size_t kMax = 10'000;
  if (line.points <= kMax) return;
  throw InputError({}, fmt::format("table over {}: {} points to choose from; at most {}: use a "
                                   "larger spacing_mm or from_mm and to_mm",
                                   layout.letter_of(line.joint), line.points, kMax));
}

void check_slopes(const GridTable& table, const JointLayout& layout, double max_ratio) {
  std::size_t n = 0;
  for_all_points(table.lines, [&](const auto& point) {
    std::size_t size = 1;
    for (std::size_t a = 0; a < table.lines.size(); ++a) {
      const GridLine& line = table.lines[a];
      const std::size_t before = size;
      size *= line.points;
      if (point[a] == 0) continue;
      const double ratio = (table.value[n] - table.value[n - before]).cwiseAbs().maxCoeff() /
                           (line.at(point[a]) - line.at(point[a] - 1));
      if (ratio <= max_ratio) continue;
      const char axis = layout.letter_of(line.joint);
      throw InputError({}, fmt::format("{}: slope {:.2f} um/mm at {} = {:.3f} mm; the NC accepts "
                                       "at most {:.2f} um/mm (max_step_ratio)",
                                       name_of(table.lines, layout), ratio / (um / mm), axis,
                                       line.at(point[a] - 1) / mm, max_ratio / (um / mm)));
    }
    ++n;
  });
}

}  // namespace

GridLine Tabulation::line(int joint) const {
  GridLine line;
  line.joint = joint;
  line.spacing = p.number("spacing_mm");
  line.first = p.is_word("from_mm") ? machine.lower[joint] : p.number("from_mm");
  const double to = p.is_word("to_mm") ? machine.upper[joint] : p.number("to_mm");
  const char axis = machine.layout.letter_of(joint);
  if (!(to > line.first)) {
    throw InputError({}, fmt::format("table over {}: from_mm = {:g} must be < to_mm = {:g}", axis,
                                     line.first / mm, to / mm));
  }
  const double intervals = std::max(1.0, std::ceil((to - line.first) / line.spacing - 1e-9));
  constexpr double kMaxIntervals = 1e7;
  if (intervals > kMaxIntervals) {
    throw InputError({}, fmt::format("table over {}: {:.3g} points exceed the capacity of any NC",
                                     axis, intervals));
  }
  line.points = static_cast<std::size_t>(intervals) + 1;
  return line;
}

GridTable Tabulation::table(std::vector<GridLine> lines, const Eigen::Vector3d& moved,
                            const Eigen::Vector3d& from_reference) const {
  const bool is_optimal = p.word("points") == "optimal";
  if (is_optimal) {
    check_candidates(lines.front(), machine.layout);
  } else {
    check_points(lines, machine.layout, p);
  }
  GridTable table;
  table.lines = std::move(lines);
  const Iterations iterations = iterations_of(p);
  const auto wanted = [&](const Joints& Q) {
    return setpoint_displacement(machine, action, iterations, Q);
  };
  Joints Q = machine.reference;
  const Eigen::Vector3d base = from_reference.cwiseProduct(wanted(Q));
  for_all_points(table.lines, [&](const auto& point) {
    for (std::size_t a = 0; a < table.lines.size(); ++a) {
      Q[table.lines[a].joint] = table.lines[a].at(point[a]) + p.number("shift_mm");
    }
    table.value.push_back(moved.cwiseProduct(wanted(Q) - base));
  });
  if (is_optimal) choose_points(table, static_cast<std::size_t>(max_points_of(p, kLine)));
  check_slopes(table, machine.layout, p.number("max_step_ratio"));
  return table;
}

}  // namespace servomill::strategies
