#include "sim/tables/grid_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "plant/geometry/travelling_errors.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/for_all_points.h"
#include "sim/tables/tool_side_errors.h"
#include "sim/tables/tool_side_poses.h"

namespace servomill::sim::tables {
namespace {

using controllers::ErrorColumn;
using controllers::ErrorGrid;

constexpr double kChord = 0.5e-9;    // m, rad: deviation of conversion along one argument
constexpr double kAgreement = 2e-9;  // m, rad

plant::ErrorName name_of(const std::string& text) { return *plant::error_name_of(text); }

double value_at(const ErrorGrid& grid, const AxisWords& q) {
  std::vector<double> position;
  for (const Axis axis : grid.axes) position.push_back(q[index_of(axis)]);
  return grid.value(position);
}

// All that the file has of one axis, whatever its arguments.
class AxisErrors {
 public:
  AxisErrors(const ImportedColumns& imported, const plant::ChainAxis& axis) : axis_(axis) {
    for (const ErrorColumn& column : imported.columns.components) {
      if (column.base_axis == axis.axis) columns_.push_back(&column);
    }
    for (const ErrorGrid& grid : imported.columns.grids) {
      if (name_of(grid.name).axis == axis.axis) grids_.push_back(&grid);
    }
  }

  const std::vector<const ErrorColumn*>& columns() const { return columns_; }
  const std::vector<const ErrorGrid*>& grids() const { return grids_; }

  ComponentErrors ours(const AxisWords& q) const {
    ComponentErrors theirs;
    const double s = q[index_of(axis_.axis)];
    for (const ErrorColumn* column : columns_) {
      part_of(theirs, name_of(column->name).direction) =
          controllers::ControlTable{.file = column->file, .points = column->points}.at(s, 1);
    }
    for (const ErrorGrid* grid : grids_) {
      part_of(theirs, name_of(grid->name).direction) = value_at(*grid, q);
    }
    return from_tool_side(axis_, theirs, s);
  }

  // Arguments of all grids, the axis itself last, with all their positions.
  plant::GridPoints arguments() const {
    plant::GridPoints out;
    for (const Axis axis : kAllAxes) {
      if (axis == axis_.axis) continue;
      const std::vector<double> at = positions(axis);
      if (at.empty()) continue;
      out.axes.push_back(axis);
      out.at.push_back(at);
    }
    out.axes.push_back(axis_.axis);
    out.at.push_back(positions(axis_.axis));
    return out;
  }

 private:
  std::vector<double> positions(Axis axis) const {
    std::vector<double> at;
    for (const ErrorGrid* grid : grids_) {
      for (std::size_t k = 0; k < grid->axes.size(); ++k) {
        if (grid->axes[k] == axis) at.insert(at.end(), grid->at[k].begin(), grid->at[k].end());
      }
    }
    for (const ErrorColumn* column : columns_) {
      if (axis != axis_.axis) break;
      for (const auto& point : column->points) at.push_back(point.position);
    }
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    return at;
  }

  const plant::ChainAxis& axis_;
  std::vector<const ErrorColumn*> columns_;
  std::vector<const ErrorGrid*> grids_;
};

double distance(const ComponentErrors& a, const ComponentErrors& b) {
  return std::max((a.shift - b.shift).cwiseAbs().maxCoeff(),
                  (a.turn - b.turn).cwiseAbs().maxCoeff());
}

// How far the converted errors are off their chord between two positions of one argument, the
// others at any of theirs.
double off_chord(const AxisErrors& errors, const plant::GridPoints& points, std::size_t argument,
                 double from, double to) {
  plant::GridPoints others = points;
  others.at[argument] = {0.5 * (from + to)};
  double off = 0.0;
  AxisWords q = AxisWords::Zero();
  for_all_points(others, 0, q, [&](AxisWords at) {
    const ComponentErrors middle = errors.ours(at);
    at[index_of(points.axes[argument])] = from;
    const ComponentErrors a = errors.ours(at);
    at[index_of(points.axes[argument])] = to;
    const ComponentErrors b = errors.ours(at);
    off = std::max(off, distance(middle, {0.5 * (a.shift + b.shift), 0.5 * (a.turn + b.turn)}));
  });
  return off;
}

// Positions of one argument at which the converted errors, linear in between, are those of the
// file.
std::vector<double> refined(const AxisErrors& errors, const plant::GridPoints& points,
                            std::size_t argument) {
  const std::vector<double>& at = points.at[argument];
  std::vector<double> out = {at.front()};
  for (std::size_t n = 1; n < at.size(); ++n) {
    const double from = at[n - 1], width = at[n] - from;
    // the deviation of a chord falls with the square of its length
    const double off = off_chord(errors, points, argument, from, at[n]);
    const int parts = std::max(1, static_cast<int>(std::ceil(std::sqrt(off / kChord))));
    for (int i = 1; i < parts; ++i) out.push_back(from + width * i / parts);
    out.push_back(at[n]);
  }
  return out;
}

void import_converted(const AxisErrors& errors, Axis axis, plant::ErrorModel& out) {
  const plant::GridPoints of_file = errors.arguments();
  plant::GridPoints points = of_file;
  for (std::size_t k = 0; k < of_file.axes.size(); ++k) points.at[k] = refined(errors, of_file, k);
  for (const Axis direction : kAllAxes) {
    points.error.clear();
    AxisWords q = AxisWords::Zero();
    for_all_points(points, 0, q, [&](const AxisWords& at) {
      ComponentErrors ours = errors.ours(at);
      points.error.push_back(part_of(ours, direction));
    });
    plant::ErrorFunction f = plant::grid(points);
    if (!f.is_zero()) out.component({direction, axis, false}) = std::move(f);
  }
}

void import_as_they_are(const AxisErrors& errors, plant::ErrorModel& out) {
  for (const ErrorColumn* column : errors.columns()) {
    std::vector<double> s, error;
    for (const auto& point : column->points) {
      s.push_back(point.position);
      error.push_back(point.up);
    }
    out.component(name_of(column->name)) = plant::linear_table(std::move(s), std::move(error));
  }
  for (const ErrorGrid* grid : errors.grids()) {
    out.component(name_of(grid->name)) = plant::grid({grid->axes, grid->at, grid->error, {}});
  }
}

// Values of a nested list, from the first of a row on.
std::string nested_text(const plant::GridPoints& points, std::size_t argument, std::size_t& next,
                        double unit) {
  if (argument == points.at.size())
    return fmt::format("{:.13g}", points.error[next++] / unit + 0.0);
  std::string text;
  for (std::size_t i = 0; i < points.at[argument].size(); ++i) {
    text += (i == 0 ? "" : ", ") + nested_text(points, argument + 1, next, unit);
  }
  return "[" + text + "]";
}

void refuse_part_of_turn(const ErrorGrid& grid, Axis axis, double from, double to) {
  constexpr double kSlack = 1e-9;  // rad
  if (std::abs(to - from - 360 * deg) <= kSlack) return;
  throw InputError({grid.file, grid.line},
                   fmt::format("{} covers {:g} to {:g} deg of {}, whose travel is endless; must "
                               "cover one turn",
                               grid.name, from / deg, to / deg, letter(axis)));
}

// Over an endless axis, errors repeat: they end as they begin.
void refuse_step_of_turn(const ErrorGrid& grid, std::size_t argument) {
  constexpr double kClosed = 1e-12;  // m, rad; rounding
  plant::GridPoints points{grid.axes, grid.at, {}, {}};
  points.at[argument] = {grid.at[argument].front()};
  AxisWords q = AxisWords::Zero();
  for_all_points(points, 0, q, [&](AxisWords at) {
    const double begin = value_at(grid, at);
    at[index_of(grid.axes[argument])] = grid.at[argument].back();
    if (std::abs(value_at(grid, at) - begin) <= kClosed) return;
    throw InputError({grid.file, grid.line},
                     fmt::format("{} is not the same at both ends of a turn of {}", grid.name,
                                 letter(grid.axes[argument])));
  });
}

// Positions from one end of the travel to the other.
std::vector<double> over_travel(std::vector<double> at, double lower, double upper) {
  if (std::isfinite(lower) && lower < at.front()) at.insert(at.begin(), lower);
  if (std::isfinite(upper) && upper > at.back()) at.push_back(upper);
  return at;
}

std::string held_note(const ErrorGrid& grid, const ErrorGrid& covering) {
  std::string text;
  for (std::size_t k = 0; k < grid.axes.size(); ++k) {
    if (grid.at[k] == covering.at[k]) continue;
    const double unit = is_linear(grid.axes[k]) ? mm : deg;
    text += fmt::format("{}{} {:g} to {:g} {}", text.empty() ? "" : ", ", letter(grid.axes[k]),
                        grid.at[k].front() / unit, grid.at[k].back() / unit,
                        is_linear(grid.axes[k]) ? "mm" : "deg");
  }
  return fmt::format(
      "assumed: {} is constant from the ends of the table ({}) to the ends of the travel",
      grid.name, text);
}

ErrorGrid covering(const ErrorGrid& grid, const model::MachineSettings& machine) {
  ErrorGrid out = grid;
  plant::GridPoints points{grid.axes, {}, {}, {}};
  for (std::size_t k = 0; k < grid.axes.size(); ++k) {
    const auto joint = machine.chain.layout.joint_of(grid.axes[k]);
    if (!joint) return grid;  // refused where it is imported
    const double lower = machine.nc.lower[*joint], upper = machine.nc.upper[*joint];
    if (machine.nc.is_endless(*joint)) {
      refuse_part_of_turn(grid, grid.axes[k], grid.at[k].front(), grid.at[k].back());
      refuse_step_of_turn(grid, k);
    }
    out.at[k] = over_travel(grid.at[k], lower, upper);
  }
  points.at = out.at;
  out.error.clear();
  AxisWords q = AxisWords::Zero();
  for_all_points(points, 0, q,
                 [&](const AxisWords& at) { out.error.push_back(value_at(grid, at)); });
  return out;
}

}  // namespace

void cover_travel(ImportedColumns& imported, const model::MachineSettings& machine,
                  std::vector<std::string>& notes) {
  for (ErrorGrid& grid : imported.columns.grids) {
    ErrorGrid over_all = covering(grid, machine);
    if (over_all.at == grid.at) continue;
    notes.push_back(held_note(grid, over_all));
    grid = std::move(over_all);
  }
}

bool has_grids(const ImportedColumns& imported, Axis axis) {
  return std::any_of(imported.columns.grids.begin(), imported.columns.grids.end(),
                     [&](const ErrorGrid& grid) { return name_of(grid.name).axis == axis; });
}

void import_grids(const ImportedColumns& imported, const plant::ChainAxis& axis,
                  plant::ErrorModel& errors) {
  const AxisErrors of_axis(imported, axis);
  if (is_as_ours(axis)) {
    import_as_they_are(of_axis, errors);
    return;
  }
  for (const ErrorGrid* grid : of_axis.grids()) {
    if (std::count(grid->axes.begin(), grid->axes.end(), axis.axis) > 0) continue;
    throw InputError(
        {grid->file, grid->line},
        fmt::format("{0} is not a function of {1}; the errors of {1}, which carries the "
                    "workpiece, are converted, and that needs its positions",
                    grid->name, letter(axis.axis)));
  }
  import_converted(of_axis, axis.axis, errors);
}

std::size_t verify_grids(const ImportedColumns& imported, const plant::MachineChain& chain,
                         const plant::ErrorModel& read_back) {
  constexpr int kPositions = 1000;
  // irrational steps, one for each axis: they fill the volume and repeat on no axis
  constexpr std::array<double, kAxisWords> kSteps = {0.41421356, 0.73205081, 0.23606798,
                                                     0.64575131, 0.31662479, 0.60555128};
  std::size_t positions = 0;
  for (const ErrorGrid& grid : imported.columns.grids) {
    const plant::ErrorName name = name_of(grid.name);
    for (int n = 0; n < kPositions; ++n) {
      AxisWords q = AxisWords::Zero();
      for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        const auto axis = static_cast<std::size_t>(index_of(grid.axes[k]));
        const double from = grid.at[k].front(), to = grid.at[k].back();
        q[index_of(grid.axes[k])] = from + (to - from) * std::fmod((n + 1) * kSteps[axis], 1.0);
      }
      const ToolSidePoses poses(chain, plant::held(read_back, name.axis, q), name.axis);
      const double wanted = value_at(grid, q);
      const double read = poses.value(name.direction, q[index_of(name.axis)]);
      ++positions;
      if (std::abs(read - wanted) <= kAgreement) continue;
      throw InputError(
          {grid.file, grid.line},
          fmt::format("verification failed: {} is {:.9g} in this file and {:.9g} in the "
                      "error model (m, rad)",
                      grid.name, wanted, read));
    }
  }
  return positions;
}

std::string grid_toml(const plant::GridPoints& points, bool is_length) {
  std::string axes, at;
  const auto linear = std::count_if(points.axes.begin(), points.axes.end(), is_linear);
  for (std::size_t k = 0; k < points.axes.size(); ++k) {
    const double unit = is_linear(points.axes[k]) ? mm : deg;
    std::vector<std::string> positions;
    for (const double q : points.at[k]) positions.push_back(fmt::format("{:.13g}", q / unit + 0.0));
    axes += letter(points.axes[k]);
    at += fmt::format("{}[{}]", k == 0 ? "" : ", ", fmt::join(positions, ", "));
  }
  std::size_t next = 0;
  return fmt::format("{{ axes = \"{}\", at_{} = [{}], value_{} = {} }}", axes,
                     linear == std::ssize(points.axes) ? "mm"
                     : linear == 0                     ? "deg"
                                                       : "mm_deg",
                     at, is_length ? "um" : "urad", nested_text(points, 0, next, um));
}

}  // namespace servomill::sim::tables
