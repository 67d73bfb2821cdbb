#include "sim/tables/table_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/mesh_settings.h"
#include "sim/tables/skew_settings.h"
#include "sim/tables/table_uncertainty.h"
#include "sim/tables/tool_side_errors.h"
#include "sim/tables/unknown_errors.h"

namespace servomill::sim::tables {
namespace {

std::optional<double> finite(double limit) {
  return std::isfinite(limit) ? std::optional(limit) : std::nullopt;
}

double unit_of(int joint) { return joint < kLinearJoints ? mm : deg; }
const char* unit_name_of(int joint) { return joint < kLinearJoints ? "mm" : "deg"; }

std::vector<TableLine> lines_of(const model::MachineSettings& machine,
                                const TableRequest& request) {
  const FormatRules& rules = rules_of(request.format);
  std::vector<TableLine> lines;
  for (const int j : machine.joints()) {
    const TableRequest::AxisRequest& axis = request.axes[static_cast<std::size_t>(j)];
    lines.push_back(
        make_line({.joint = j,
                   .letter = machine.chain.layout.letter_of(j),
                   .lower = axis.from ? axis.from : finite(machine.nc.lower[j]),
                   .upper = axis.to ? axis.to : finite(machine.nc.upper[j]),
                   .spacing = j < kLinearJoints ? request.spacing : request.rotary_spacing,
                   .most_points = request.most_points.value_or(rules.most_points),
                   .wanted = axis.wanted},
                  rules));
  }
  return lines;
}

Joints reference_of(const TableRequest& request, const std::vector<TableLine>& lines,
                    const JointLayout& layout) {
  Joints Q = Joints::Zero();
  for (const TableLine& line : lines) {
    const auto given = request.axes[static_cast<std::size_t>(line.joint)].reference;
    const double usual = line.joint < kLinearJoints ? 0.5 * (line.from + line.to)
                                                    : std::clamp(0.0, line.from, line.to);
    Q[line.joint] = given.value_or(usual);
    if (Q[line.joint] >= line.from && Q[line.joint] <= line.to) continue;
    const double unit = unit_of(line.joint);
    throw InputError(
        {},
        fmt::format("the reference {} = {:g} {} is outside the travel, {:g} to {:g} {}",
                    layout.letter_of(line.joint), Q[line.joint] / unit, unit_name_of(line.joint),
                    line.from / unit, line.to / unit, unit_name_of(line.joint)));
  }
  return Q;
}

std::string size_of(bool angle, double value) {
  return angle ? fmt::format("{:.3f} urad", value / urad) : fmt::format("{:.3f} um", value / um);
}

// The displacements of every axis over one axis, on a grid that is finer than tables are.
struct FineLine {
  static constexpr int kIntervals = 4096;
  std::vector<Joints> d;

  FineLine(const LineCorrection& correction, const TableLine& line) {
    for (int i = 0; i <= kIntervals; ++i) {
      throw_if_interrupted();
      d.push_back(correction.over(line.joint, position(line, i)));
    }
  }

  static double position(const TableLine& line, int i) {
    return line.from + (line.to - line.from) * i / kIntervals;
  }

  double half_span(int output) const {
    double low = d[0][output], high = low;
    for (const Joints& at : d) {
      low = std::min(low, at[output]);
      high = std::max(high, at[output]);
    }
    return 0.5 * (high - low);
  }

  // Largest distance from chords over so many intervals.
  double off_chords(int output, int stride) const {
    double most = 0.0;
    for (int i = 0; i <= kIntervals; ++i) {
      const int from = std::min(i / stride * stride, kIntervals - stride);
      const double share = static_cast<double>(i - from) / stride;
      const auto at = [&](int n) { return d[static_cast<std::size_t>(n)][output]; };
      most = std::max(most, std::abs(at(i) - (1.0 - share) * at(from) - share * at(from + stride)));
    }
    return most;
  }
};

bool is_omitted(const TableExport& e, int base, int output) {
  return std::any_of(e.omitted.begin(), e.omitted.end(),
                     [&](const auto& one) { return one.base == base && one.output == output; });
}

// Largest distance of the error from what the table holds; without a table, from 0.
double largest_miss(const TableExport& e, const TableLine& line, const FineLine& fine, int output) {
  const auto table = std::find_if(e.tables.begin(), e.tables.end(), [&](const auto& one) {
    return one.line.joint == line.joint && one.output == output;
  });
  double missed = 0.0;
  for (int i = 0; i <= FineLine::kIntervals; ++i) {
    const double entry = line.entry_of(FineLine::position(line, i));
    const double held =
        table == e.tables.end() ? 0.0 : -0.5 * (table->at(entry, 1) + table->at(entry, -1));
    missed = std::max(missed, std::abs(fine.d[static_cast<std::size_t>(i)][output] - held));
  }
  return missed;
}

// Points leave a larger share of the largest value.
auto is_coarser_than(double share) {
  return
      [share](const CompensationTable& table) { return table.residual > share * table.largest(); };
}

// Spacings that nobody asked for become smaller until errors are represented, such as those of a
// screw that repeat every few millimetres.
void refine(TableExport& e) {
  for (TableLine& line : e.lines) {
    const bool is_given = line.joint < kLinearJoints ? e.request.spacing.has_value()
                                                     : e.request.rotary_spacing.has_value();
    if (!line.wanted || is_given) continue;
    const std::size_t most = e.request.most_points.value_or(e.rules().most_points);
    for (auto finer = std::optional(line); finer; finer = finer_line(*finer, e.rules(), most)) {
      line = *finer;
      const auto tables = component_tables_of(e.source, {line}, e.rules());
      if (std::none_of(tables.begin(), tables.end(), is_coarser_than(0.02))) break;
    }
  }
}

// An error that goes elsewhere between the points of a table, or is the same at all of them.
std::optional<std::string> too_coarse(const TableExport& e, const TableLine& line,
                                      const FineLine& fine, int output) {
  constexpr double kMissed = 0.2, kWanted = 0.1;  // of half the span of the error
  if (is_omitted(e, line.joint, output) || (!e.rules().cross && output != line.joint)) return {};
  const bool is_angle = output >= kLinearJoints;
  const double span = fine.half_span(output);
  if (span <= (is_angle ? e.rules().angle_step : e.rules().length_step)) return {};
  const double missed = largest_miss(e, line, fine, output);
  if (missed <= kMissed * span) return {};
  int stride = FineLine::kIntervals;
  while (stride > 1 && fine.off_chords(output, stride) > kWanted * span) stride /= 2;
  const double needed = (line.to - line.from) * stride / FineLine::kIntervals;
  if (needed >= line.spacing) return {};
  return fmt::format(
      "{} over {}: points {:g} {} apart leave a residual of {} of an error of +-{}; required: "
      "{:.3g} {}",
      e.letter(output), e.letter(line.joint), line.spacing / unit_of(line.joint),
      unit_name_of(line.joint), size_of(is_angle, missed), size_of(is_angle, span),
      needed / unit_of(line.joint), unit_name_of(line.joint));
}

std::vector<std::string> too_coarse(const TableExport& e) {
  const LineCorrection correction(e.source);
  std::vector<std::string> out;
  for (const TableLine& line : e.lines) {
    if (!line.wanted) continue;
    const FineLine fine(correction, line);
    for (int output = 0; output < kJoints; ++output) {
      if (auto one = too_coarse(e, line, fine, output)) out.push_back(std::move(*one));
    }
  }
  return out;
}

// The same of formats that hold the errors themselves.
std::vector<std::string> too_coarse_components(const TableExport& e) {
  std::vector<std::string> out;
  for (const CompensationTable& table : e.tables) {
    const double step = table.is_angle() ? e.rules().angle_step : e.rules().length_step;
    if (!is_coarser_than(0.1)(table) || table.residual <= step) continue;
    const int j = table.line.joint;
    out.push_back(fmt::format(
        "{} over {}: points {:g} {} apart leave a residual of {} of an error of up to {}",
        to_string(*table.component), e.letter(j), table.line.spacing / unit_of(j), unit_name_of(j),
        size_of(table.is_angle(), table.residual), size_of(table.is_angle(), table.largest())));
  }
  return out;
}

std::string joined(const std::vector<std::string>& reasons) {
  return reasons.empty() ? "" : fmt::format("; {}", fmt::join(reasons, "; "));
}

// Points that miss an error do harm everywhere; without them the harm is at poses off the lines
// that tables hold, of which the report tells.
void refuse_harm(const TableExport& e) {
  if (!e.makes_worse() || e.coarse.empty()) return;
  throw InputError({}, fmt::format("these tables would increase the error of the machine: TCP off "
                                   "by up to {} without them, {} with{}",
                                   size_of(false, e.volume.before), size_of(false, e.volume.after),
                                   joined(e.coarse)));
}

}  // namespace

TableExport export_tables(const model::MachineSettings& machine, const plant::ErrorModel& errors,
                          const TableRequest& request) {
  TableExport e;
  e.request = request;
  e.machine = machine.name;
  e.lines = lines_of(machine, request);
  e.source = {machine.chain,
              errors,
              {0.0, 0.0, -request.tool_length},
              reference_of(request, e.lines, machine.chain.layout)};
  refuse_unknown(e);
  if (e.rules().skew) {
    e.skew = skew_settings_of(e, !request.mesh);
    if (request.mesh) e.mesh = bed_mesh_of(e);
    return e;
  }
  const bool csv = e.rules().components;
  if (e.rules().tool_side) {
    refuse_undocumented_axes(machine.chain, errors, name_of(request.format), {});
  }
  if (csv) refine(e);
  e.tables = csv ? component_tables_of(e.source, e.lines, e.rules())
                 : tables_of(e.source, e.lines, e.rules());
  if (csv) e.grids = grid_tables_of(e.source, e.lines, e.rules());
  for (const CompensationTable& table : e.tables) {
    if (table.is_second_order) {
      e.omitted.push_back({table.line.joint, table.output, table.largest()});
    }
  }
  std::erase_if(e.tables, [](const CompensationTable& table) { return table.is_second_order; });
  take_uncertainty(e);
  if (e.tables.empty() && !(csv && !errors.is_zero())) {
    const std::string why = csv ? "" : joined(undetermined_lines(e)) + joined(too_coarse(e));
    throw InputError(
        {},
        fmt::format(
            "{} tables over the selected axes cannot represent any part of the error model '{}'{}",
            name_of(request.format), request.model, why));
  }
  if (csv) {
    e.coarse = too_coarse_components(e);
    refuse_undetermined_tip(e);
    return e;
  }
  e.base = LineCorrection(e.source).base();
  e.left = table_residuals(e.source, e.lines, e.omitted, e.rules());
  e.volume = volume(e.source, e.lines, e.tables);
  e.coarse = too_coarse(e);
  refuse_harm(e);
  return e;
}

std::shared_ptr<const TableExport> shared_export(const model::MachineSettings& machine,
                                                 const plant::ErrorModel& errors,
                                                 const TableRequest& request) {
  return std::make_shared<const TableExport>(export_tables(machine, errors, request));
}

}  // namespace servomill::sim::tables
