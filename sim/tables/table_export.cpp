#include "sim/tables/table_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"

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
    throw InputError({}, fmt::format("the reference {} = {:g} {} lies outside the travel, {:g} to "
                                     "{:g} {}",
                                     layout.letter_of(line.joint), Q[line.joint] / unit,
                                     unit_name_of(line.joint), line.from / unit, line.to / unit,
                                     unit_name_of(line.joint)));
  }
  return Q;
}

std::string size_of(bool angle, double value) {
  return angle ? fmt::format("{:.3f} urad", value / urad) : fmt::format("{:.3f} um", value / um);
}

std::string title_of(const TableExport& e, const CompensationTable& table) {
  const char over = e.letter(table.line.joint);
  return table.component ? fmt::format("{} over {}", to_string(*table.component), over)
                         : fmt::format("{} over {}", e.letter(table.output), over);
}

std::string line_of(const TableExport& e, const CompensationTable& table) {
  const int j = table.line.joint;
  return fmt::format(
      "  {}: {} points, {:g} {} apart from {:g} {}, up to {}; linear interpolation "
      "and rounding leave up to {}",
      title_of(e, table), table.line.points, table.line.spacing / unit_of(j), unit_name_of(j),
      table.line.first / unit_of(j), unit_name_of(j), size_of(table.is_angle(), table.largest()),
      size_of(table.is_angle(), table.residual));
}

std::string reference_line(const TableExport& e) {
  std::string where;
  for (const TableLine& line : e.lines) {
    const int j = line.joint;
    where += fmt::format("{}{} = {:g} {}", where.empty() ? "" : ", ", e.letter(j),
                         e.source.reference[j] / unit_of(j), unit_name_of(j));
  }
  return fmt::format("reference: each table holds the line along its axis through {}, tool {:g} mm",
                     where, e.request.tool_length / mm);
}

void add_base(const TableExport& e, std::vector<std::string>& out) {
  std::string text;
  for (const TableLine& line : e.lines) {
    const double error = -e.base[line.joint];
    if (std::abs(error) <= kNothing) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", e.letter(line.joint),
                        size_of(line.joint >= kLinearJoints, error));
  }
  if (text.empty()) return;
  out.push_back(fmt::format(
      "zero: the tables are 0 at the reference; the error there stays for the work offset: {}",
      text));
}

void add_table_residuals(const TableExport& e, std::vector<std::string>& out) {
  if (e.left.empty()) {
    out.push_back("not in these tables: nothing");
    return;
  }
  out.push_back(
      "not in these tables, or only on their lines (largest size; what it alone leaves within the "
      "travel, beside that of the reference):");
  for (const TableResidual& one : e.left) {
    std::string leaves;
    if (one.tip > kNothing) leaves = fmt::format("tip {}", size_of(false, one.tip));
    if (one.tool_axis > kNothing) {
      leaves +=
          fmt::format("{}tool axis {}", leaves.empty() ? "" : ", ", size_of(true, one.tool_axis));
    }
    out.push_back(fmt::format("  {:<5} {}; {}", to_string(one.name),
                              size_of(!is_linear(one.name.direction), one.size), leaves));
  }
}

// Is there a table that this error over the position of the axis goes into?
bool has_table(const TableExport& e, const TableLine& line, const plant::ErrorName& name) {
  const auto joint = e.source.chain.layout.joint_of(name.direction);
  return std::any_of(e.tables.begin(), e.tables.end(), [&](const CompensationTable& table) {
    if (table.line.joint != line.joint) return false;
    if (table.component) return *table.component == name;
    return !is_linear(name.direction) || (joint && table.output == *joint);
  });
}

// The directions of travel that the tables over one axis hold.
std::string directions_in(const TableExport& e, const TableLine& line) {
  std::string both, mean;
  for (const CompensationTable& table : e.tables) {
    if (table.line.joint != line.joint) continue;
    std::string& list = table.depends_on_direction() ? both : mean;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", title_of(e, table));
  }
  if (both.empty()) return "the tables hold the mean";
  return "both directions are held by " + both + (mean.empty() ? "" : "; the mean by " + mean);
}

void add_omitted(const TableExport& e, std::vector<std::string>& out) {
  for (const OmittedTable& table : e.omitted) {
    out.push_back(fmt::format(
        "note: no table {} over {}: {} at most, of second order in errors of other directions",
        e.letter(table.output), e.letter(table.base),
        size_of(table.output >= kLinearJoints, table.largest)));
  }
}

// SINUMERIK 828D: eight tables of $AN_CEC, which cannot be extended (6FC5397-1BP40-3BA1, page 264).
void add_table_count(const TableExport& e, std::vector<std::string>& out) {
  constexpr int kTables = 8;
  if (e.request.format != TableFormat::siemens) return;
  int count = 0;
  for (const CompensationTable& table : e.tables) {
    const bool is_cross = table.output != table.line.joint;
    count += table.depends_on_direction() ? 2 : static_cast<int>(is_cross);
  }
  if (count <= kTables) return;
  out.push_back(
      fmt::format("note: {} tables of $AN_CEC; a SINUMERIK 828D has {}: choose axes with --axis",
                  count, kTables));
}

bool does_harm(const TableExport& e) {
  return e.volume.after > e.volume.before + e.rules().length_step;
}

void note_ends_of_turns(const TableExport& e, std::vector<std::string>& out) {
  for (const CompensationTable& table : e.tables) {
    if (!table.line.one_turn || table.line.wraps || table.component) continue;
    out.push_back(fmt::format(
        "note: {}: the control does not repeat the table: beyond 0 and 360 deg the end values hold",
        title_of(e, table)));
  }
}

void note_reversals(const TableExport& e, const TableLine& line, std::vector<std::string>& out) {
  const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName name{direction, axis, false};
    const plant::ErrorFunction& error = e.source.errors.component(name);
    if (error.reversals.empty()) continue;
    const double most = std::max(std::abs(error.width(line.from)), std::abs(error.width(line.to)));
    out.push_back(fmt::format(
        "note: {} depends on the direction of travel, by {} at the ends of the travel; {}",
        to_string(name), size_of(!is_linear(direction), most),
        has_table(e, line, name)
            ? directions_in(e, line)
            : fmt::format("there is no table {} over {}: half of it, {}, stays in each direction",
                          letter(direction), e.letter(line.joint),
                          size_of(!is_linear(direction), 0.5 * most))));
  }
}

void note_powers_of_two(const TableExport& e, std::vector<std::string>& out) {
  for (const TableLine& line : e.lines) {
    const double exponent = std::log2(line.spacing / kGridStep);
    if (line.joint >= kLinearJoints || !line.wanted) continue;
    if (std::abs(exponent - std::round(exponent)) < 1e-9) continue;
    out.push_back(fmt::format(
        "note: {}: controls without the column AXISPOS need a spacing of 2^n x 0.0001 mm",
        e.letter(line.joint)));
  }
  for (const CompensationTable& table : e.tables) {
    if (table.is_angle() || table.steepest() <= 1.0 / kGridSteps) continue;
    out.push_back(fmt::format(
        "note: {}: {:.3f} um/mm; tables of 64 points (code number 105 296) take at most {:g} um/mm",
        title_of(e, table), table.steepest() / (um / mm), 1.0 / kGridSteps / (um / mm)));
  }
}

void add_notes(const TableExport& e, std::vector<std::string>& out) {
  note_ends_of_turns(e, out);
  for (const TableLine& line : e.lines) note_reversals(e, line, out);
  for (const std::string& one : e.coarse) out.push_back("note: " + one);
  if (does_harm(e)) {
    out.push_back(
        fmt::format("note: worse at some poses off the lines that the tables hold: tip off by up "
                    "to {} without them, {} with",
                    size_of(false, e.volume.before), size_of(false, e.volume.after)));
  }
  add_omitted(e, out);
  add_table_count(e, out);
  if (e.rules().power_of_two) note_powers_of_two(e, out);
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

// An error that goes elsewhere between the points of a table, or is the same at all of them.
std::optional<std::string> too_coarse(const TableExport& e, const TableLine& line,
                                      const FineLine& fine, int output) {
  constexpr double kMissed = 0.5, kWanted = 0.1;  // of half the span of the error
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
      "{} over {}: points {:g} {} apart leave {} of an error of +-{}; it needs {:.3g} {}",
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

std::string joined(const std::vector<std::string>& reasons) {
  return reasons.empty() ? "" : fmt::format("; {}", fmt::join(reasons, "; "));
}

// Points that miss an error do harm everywhere; without them the harm is at poses off the lines
// that tables hold, of which the report tells.
void refuse_harm(const TableExport& e) {
  if (!does_harm(e) || e.coarse.empty()) return;
  throw InputError({}, fmt::format("these tables would make the machine worse: tip off by up to {} "
                                   "without them, {} with{}",
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
  const bool csv = request.format == TableFormat::csv;
  e.tables = csv ? component_tables_of(e.source, e.lines, e.rules())
                 : tables_of(e.source, e.lines, e.rules());
  for (const CompensationTable& table : e.tables) {
    if (table.is_second_order) {
      e.omitted.push_back({table.line.joint, table.output, table.largest()});
    }
  }
  std::erase_if(e.tables, [](const CompensationTable& table) { return table.is_second_order; });
  if (e.tables.empty() && !(csv && !errors.is_zero())) {
    const std::string why = csv ? "" : joined(too_coarse(e));
    throw InputError({}, fmt::format("{} tables over the chosen axes can hold nothing "
                                     "of the error model '{}'{}",
                                     name_of(request.format), request.model, why));
  }
  if (csv) return e;
  e.base = LineCorrection(e.source).base();
  e.left = table_residuals(e.source, e.lines, e.omitted, e.rules());
  e.volume = volume(e.source, e.lines, e.tables);
  e.coarse = too_coarse(e);
  refuse_harm(e);
  return e;
}

std::vector<std::string> report(const TableExport& e) {
  const bool csv = e.request.format == TableFormat::csv;
  std::vector<std::string> out;
  out.push_back(
      fmt::format("compensation tables of error model '{}' on {}", e.request.model, e.machine));
  out.push_back(fmt::format("document: {}", e.rules().document));
  if (!csv) out.push_back(reference_line(e));
  add_base(e, out);
  out.push_back("tables:");
  for (const CompensationTable& table : e.tables) out.push_back(line_of(e, table));
  add_notes(e, out);
  if (csv) {
    out.push_back("not in these tables: nothing");
    return out;
  }
  add_table_residuals(e, out);
  out.push_back(
      fmt::format("tip at poses all over the travel, beside that of the reference: off by up to {} "
                  "without these "
                  "tables, {} with",
                  size_of(false, e.volume.before), size_of(false, e.volume.after)));
  return out;
}

}  // namespace servomill::sim::tables
