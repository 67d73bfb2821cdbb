#include "sim/tables/error_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "controllers/tables/etalon_table.h"
#include "controllers/tables/isg_table.h"
#include "plant/geometry/travelling_errors.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/grid_import.h"
#include "sim/tables/tool_side_errors.h"
#include "sim/tables/tool_side_poses.h"

namespace servomill::sim::tables {
namespace {

using controllers::ErrorColumn;

constexpr double kLargest = 0.1;     // m, rad: no machine has more
constexpr double kChord = 1e-9;      // m, rad: deviation of conversion between points
constexpr double kAgreement = 2e-9;  // m, rad

bool is_tool_side(const ImportedColumns& imported) { return rules_of(imported.format).tool_side; }

plant::ErrorName name_of(const ErrorColumn& column) { return *plant::error_name_of(column.name); }

double value_at(const ErrorColumn& column, double q) {
  return controllers::ControlTable{.file = column.file, .points = column.points}.at(q, 1);
}

void refuse_size(const std::string& name, bool is_length, double value, const Place& at) {
  if (std::abs(value) <= kLargest) return;
  throw InputError(at, fmt::format("{} is {:g} {}, implausible for a machine{}", name,
                                   value / (is_length ? mm : 1.0), is_length ? "mm" : "rad",
                                   is_length ? "" : "; angles are in rad, not in deg"));
}

void refuse_meaningless_grids(const ImportedColumns& imported, const JointLayout& layout) {
  for (const controllers::ErrorGrid& grid : imported.columns.grids) {
    const Place at{grid.file, grid.line};
    const plant::ErrorName name = *plant::error_name_of(grid.name);
    for (const double e : grid.error) refuse_size(grid.name, is_linear(name.direction), e, at);
    if (const auto why = plant::why_meaningless(name, layout)) {
      throw InputError(at, fmt::format("{} {}", grid.name, *why));
    }
    for (const Axis axis : grid.axes) {
      if (layout.joint_of(axis)) continue;
      throw InputError(at, fmt::format("{} is a function of {}, which the machine lacks", grid.name,
                                       letter(axis)));
    }
  }
}

// The columns that the machine can have and that are not 0 everywhere.
std::vector<const ErrorColumn*> usable(const ImportedColumns& imported, const JointLayout& layout,
                                       ErrorImport& out) {
  std::vector<const ErrorColumn*> columns;
  for (const ErrorColumn& column : imported.columns.components) {
    const Place at{column.file, column.points.front().line};
    if (column.direction != 0) {
      throw InputError(at, fmt::format("{} depends on the direction of travel; tables do not "
                                       "contain reversal distances, so only means are imported",
                                       column.name));
    }
    const plant::ErrorName name = name_of(column);
    bool is_zero = true;
    for (const controllers::TablePoint& point : column.points) {
      is_zero = is_zero && point.up == 0.0;
      refuse_size(column.name, is_linear(name.direction), point.up, {column.file, point.line});
    }
    const auto why = plant::why_meaningless(name, layout);
    if (why && !is_zero) throw InputError(at, fmt::format("{} {}", column.name, *why));
    if (is_zero) {
      out.notes.push_back(fmt::format("not imported: {}, which is 0 everywhere", column.name));
    } else {
      columns.push_back(&column);
    }
  }
  refuse_meaningless_grids(imported, layout);
  return columns;
}

void import_locations(const ImportedColumns& imported, const JointLayout& layout,
                      ErrorImport& out) {
  for (const auto& [text, location] : imported.columns.locations) {
    const auto name = plant::error_name_of(text);
    const Place at{location.file, location.line};
    if (!name) throw InputError(at, fmt::format("{} is no error", text));
    refuse_size(text, is_linear(name->direction), location.value, at);
    const auto why = plant::why_meaningless(*name, layout);
    if (why && location.value != 0.0) throw InputError(at, fmt::format("{} {}", text, *why));
    if (!why) out.errors.location(*name) = location.value;
  }
}

std::vector<const ErrorColumn*> of_axis(const std::vector<const ErrorColumn*>& columns, Axis axis) {
  std::vector<const ErrorColumn*> out;
  for (const ErrorColumn* column : columns) {
    if (column->base_axis == axis) out.push_back(column);
  }
  return out;
}

void import_as_they_are(const std::vector<const ErrorColumn*>& columns, ErrorImport& out) {
  for (const ErrorColumn* column : columns) {
    std::vector<double> s, error;
    for (const controllers::TablePoint& point : column->points) {
      s.push_back(point.position);
      error.push_back(point.up);
    }
    out.errors.component(name_of(*column)) = plant::linear_table(std::move(s), std::move(error));
  }
}

// All errors of one axis that carries the workpiece, at one position.
ComponentErrors converted(const std::vector<const ErrorColumn*>& columns,
                          const plant::ChainAxis& axis, double q) {
  ComponentErrors theirs;
  for (const ErrorColumn* column : columns) {
    part_of(theirs, name_of(*column).direction) = value_at(*column, q);
  }
  return from_tool_side(axis, theirs, q);
}

double distance(const ComponentErrors& a, const ComponentErrors& b) {
  return std::max((a.shift - b.shift).cwiseAbs().maxCoeff(),
                  (a.turn - b.turn).cwiseAbs().maxCoeff());
}

// Positions at which the converted errors, linear in between, are those of the file.
std::vector<double> refined(const std::vector<const ErrorColumn*>& columns,
                            const plant::ChainAxis& axis) {
  std::set<double> points;
  for (const ErrorColumn* column : columns) {
    for (const auto& point : column->points) points.insert(point.position);
  }
  std::vector<double> out = {*points.begin()};
  for (auto next = std::next(points.begin()); next != points.end(); ++next) {
    const double from = out.back();
    const auto at = [&](double q) { return converted(columns, axis, q); };
    const ComponentErrors a = at(from), b = at(*next), middle = at(0.5 * (from + *next));
    const ComponentErrors chord{0.5 * (a.shift + b.shift), 0.5 * (a.turn + b.turn)};
    // the deviation of a chord falls with the square of its length
    const int parts =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(distance(middle, chord) / kChord))));
    for (int i = 1; i < parts; ++i) out.push_back(from + (*next - from) * i / parts);
    out.push_back(*next);
  }
  return out;
}

void import_converted(const std::vector<const ErrorColumn*>& columns, const plant::ChainAxis& axis,
                      ErrorImport& out) {
  const std::vector<double> s = refined(columns, axis);
  for (const Axis direction : kAllAxes) {
    std::vector<double> error;
    for (const double q : s) {
      ComponentErrors ours = converted(columns, axis, q);
      error.push_back(part_of(ours, direction));
    }
    const bool is_zero = std::all_of(error.begin(), error.end(), [](double e) { return e == 0.0; });
    if (is_zero) continue;
    out.errors.component({direction, axis.axis, false}) = plant::linear_table(s, error);
  }
}

void note_conversion(const plant::ChainAxis& axis, ErrorImport& out) {
  out.notes.push_back(
      fmt::format("converted: the errors of {}, which {}", letter(axis.axis),
                  axis.side == plant::Side::workpiece
                      ? "carries the workpiece, but is treated in the file as carrying the tool"
                      : "rotate about its centre here and about the machine zero in the file"));
}

std::string list_text(const std::vector<double>& values, double unit) {
  std::string text;
  for (const double value : values) {
    text += fmt::format("{}{:.13g}", text.empty() ? "" : ", ", value / unit + 0.0);
  }
  return "[" + text + "]";
}

}  // namespace

ImportedColumns read_columns(TableFormat format, std::span<const controllers::TableText> files) {
  if (!rules_of(format).components) {
    throw InputError({"--import"},
                     fmt::format("{} contains axis displacements, from which errors cannot be "
                                 "derived; csv, isg and etalon contain errors",
                                 name_of(format)));
  }
  if (format == TableFormat::csv) return {controllers::read_csv_tables(files), format};
  if (files.size() != 1) {
    throw InputError({"--import"}, fmt::format("{} files; {} is imported from one file",
                                               files.size(), name_of(format)));
  }
  return {format == TableFormat::isg ? controllers::read_isg_table(files.front())
                                     : controllers::read_etalon_table(files.front()),
          format};
}

ErrorImport import_errors(const ImportedColumns& imported, const plant::MachineChain& chain) {
  ErrorImport out;
  const auto columns = usable(imported, chain.layout, out);
  import_locations(imported, chain.layout, out);
  for (const plant::ChainAxis& axis : chain.axes) {
    const auto own = of_axis(columns, axis.axis);
    if (has_grids(imported, axis.axis)) {
      import_grids(imported, axis, out.errors);
      if (!is_as_ours(axis)) note_conversion(axis, out);
      continue;
    }
    if (own.empty()) continue;
    if (!is_tool_side(imported) || is_as_ours(axis)) {
      import_as_they_are(own, out);
      continue;
    }
    import_converted(own, axis, out);
    note_conversion(axis, out);
  }
  if (is_tool_side(imported)) {
    const auto& columns_read = imported.columns.components;
    const auto& grids_read = imported.columns.grids;
    const std::string file = !columns_read.empty() ? columns_read.front().file
                             : !grids_read.empty() ? grids_read.front().file
                                                   : std::string(name_of(imported.format));
    refuse_undocumented_axes(chain, out.errors, name_of(imported.format), {file});
    out.notes.push_back(
        "assumed: workpiece_axes 0 and alternative_model 0; component errors belong to the body "
        "that the axis moves (ISO 230-1)");
  }
  if (!imported.columns.not_read.empty()) {
    out.notes.push_back(fmt::format("not imported: {}; the machine file has the kinematics",
                                    fmt::join(imported.columns.not_read, ", ")));
  }
  return out;
}

namespace {

std::string component_toml(const plant::ErrorName& name, const plant::ErrorFunction& f) {
  const bool is_length = is_linear(name.direction), over_length = is_linear(name.axis);
  std::string text;
  for (const plant::LinearTable& table : f.tables) {
    text += fmt::format("{} = {{ table = {{ at_{} = {}, value_{} = {} }} }}\n", to_string(name),
                        over_length ? "mm" : "deg", list_text(table.s, over_length ? mm : deg),
                        is_length ? "um" : "urad", list_text(table.error, um));  // um is urad
  }
  for (const plant::GridFunction& grid : f.grids) {
    text +=
        fmt::format("{} = {{ grid = {} }}\n", to_string(name), grid_toml(grid.points(), is_length));
  }
  return text;
}

}  // namespace

std::string errors_toml(const plant::ErrorModel& errors, const std::string& name,
                        const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += fmt::format("# {}\n", comment);
  text += fmt::format("[errors.{}]\n", name);
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName location{direction, axis, true}, component{direction, axis, false};
      const bool is_length = is_linear(direction);
      if (const double value = errors.location(location); value != 0.0) {
        text += fmt::format("{} = {{ constant_{} = {:.13g} }}\n", to_string(location),
                            is_length ? "um" : "urad", value / um);  // um is urad
      }
      text += component_toml(component, errors.component(component));
    }
  }
  return text;
}

std::size_t verify_import(const ImportedColumns& imported, const plant::MachineChain& chain,
                          const plant::ErrorModel& read_back) {
  constexpr int kPositions = 1000;
  std::size_t positions = verify_grids(imported, chain, read_back);
  const auto check = [&](const std::string& file, int line, const std::string& name, double wanted,
                         double read) {
    ++positions;
    if (std::abs(read - wanted) <= kAgreement) return;
    throw InputError({file, line}, fmt::format("verification failed: {} is {:.9g} in this file and "
                                               "{:.9g} in the error model (m, rad)",
                                               name, wanted, read));
  };
  for (const Axis axis : kAllAxes) {
    if (!chain.layout.joint_of(axis)) continue;
    const ToolSidePoses poses(chain, plant::held(read_back, axis, AxisWords::Zero()), axis);
    for (const ErrorColumn& column : imported.columns.components) {
      if (column.base_axis != axis) continue;
      const plant::ErrorName name = name_of(column);
      const double from = column.points.front().position, to = column.points.back().position;
      for (int n = 0; n < kPositions; ++n) {
        const double q = from + (to - from) * n / (kPositions - 1);
        const double read = is_tool_side(imported) ? poses.value(name.direction, q)
                                                   : read_back.component(name).value(q);  // csv
        check(column.file, column.points.front().line, column.name, value_at(column, q), read);
      }
    }
  }
  for (const auto& [text, location] : imported.columns.locations) {
    const plant::ErrorName name = *plant::error_name_of(text);
    if (plant::why_meaningless(name, chain.layout)) continue;
    check(location.file, location.line, text, location.value, read_back.location(name));
  }
  return positions;
}

}  // namespace servomill::sim::tables
