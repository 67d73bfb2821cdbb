#include "strategies/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/axis_displacement.h"
#include "strategies/grid_table.h"
#include "strategies/pose_compensation.h"
#include "strategies/tabulate.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 3> kLayouts = {"axis_tables", "grid", "continuous"};
constexpr std::array<std::string_view, 7> kBaseAxes = {"X", "Y", "Z", "XY", "XZ", "YZ", "all"};
constexpr std::array<std::string_view, 6> kCompensatedAxes = {"all", "own", "others",
                                                              "X",   "Y",   "Z"};
constexpr std::array<std::string_view, 2> kBoolean = {"false", "true"};
constexpr std::array<std::string_view, 1> kAuto = {"auto"};
constexpr std::array<std::string_view, 2> kSpacingRules = {"power_of_two", "free"};
constexpr std::array<std::string_view, 3> kInjectionPoints = {"before_filter", "position_command",
                                                              "feed_forward"};
constexpr std::array<std::string_view, 1> kTravel = {"travel"};
constexpr std::array<std::string_view, 2> kPoints = {"equidistant", "optimal"};
constexpr double kGridStep =
    0.1 * um;  // spacing is 2^n times this (TNC 407/415/425 Technical Manual, 1998, p. 153)

constexpr ParameterSpec kLayoutSpec = {
    .name = "layout",
    .help =
        "axis_tables: the sum of one table per axis; grid: one table over all axes, "
        "multilinear within each cell; continuous: the error itself, as an infinitely fine "
        "table would give it",
    .default_text = "axis_tables",
    .is_number = false,
    .words = kLayouts,
    .shortcoming = Shortcoming::points,
    .ideal = "continuous"};

// A time of the NC's response; 0: it has none.
constexpr ParameterSpec response_time(std::string_view name, std::string_view help) {
  return {.name = name,
          .help = help,
          .unit = "ms",
          .default_text = "0",
          .min = 0.0,
          .max = 1e4,
          .shortcoming = Shortcoming::delay,
          .ideal = "0"};
}

// Machine coordinate of an end of the tables.
constexpr ParameterSpec end_of_table(std::string_view name, std::string_view help) {
  return {.name = name, .help = help, .unit = "mm", .default_text = "travel", .words = kTravel};
}

constexpr ParameterSpec kPointsSpec = {
    .name = "points",
    .help =
        "equidistant; optimal: the max_points of the points at spacing_mm between which "
        "linear interpolation deviates least, for NCs that accept any positions",
    .default_text = "equidistant",
    .is_number = false,
    .words = kPoints};

constexpr ParameterSpec kShiftSpec = {
    .name = "shift_mm",
    .help =
        "each point contains the error that far ahead along its base axis; v times the delay of "
        "the table compensates this delay at the feed v, in one direction",
    .unit = "mm",
    .default_text = "0",
    .min = -100.0,
    .max = 100.0,
    .shortcoming = Shortcoming::delay,
    .ideal = "0"};

const std::array<ParameterSpec, 17>& specs() {
  static const std::array<ParameterSpec, 17> kSpecs = {{
      kLayoutSpec,
      {.name = "base_axis",
       .help = "base axes of the tables; all: each linear axis",
       .default_text = "all",
       .is_number = false,
       .words = kBaseAxes},
      {.name = "compensated_axis",
       .help =
           "axes that the tables displace; own: the base axis, others: all except the base axis",
       .default_text = "all",
       .is_number = false,
       .words = kCompensatedAxes},
      {.name = "zero_at_reference",
       .help = "true: the tables are zero at the reference position, because another table "
               "contains the error there",
       .default_text = "false",
       .is_number = false,
       .words = kBoolean},
      kPointsSpec,
      {.name = "spacing_mm",
       .help = "spacing of the points",
       .unit = "mm",
       .default_text = "1.6384",
       .min = 1e-4},
      {.name = "spacing_rule",
       .help = "power_of_two: the spacing must be 2^n x 0.1 um; free: any spacing",
       .default_text = "power_of_two",
       .is_number = false,
       .words = kSpacingRules},
      end_of_table("from_mm", "machine coordinate of the first point; travel: lower travel limit"),
      end_of_table("to_mm",
                   "machine coordinate that the last point must reach; travel: upper travel limit"),
      {.name = "max_points",
       .help = "maximum number of points per table; auto: 256, in a grid 15625 (25 x 25 x 25)",
       .default_text = "auto",
       .min = 2,
       .max = 1e6,
       .words = kAuto},
      {.name = "max_step_ratio",
       .help = "maximum slope between points that the NC accepts",
       .default_text = "0.015625",
       .min = 0.0},
      {.name = "injection_point",
       .help = "point of the NC at which the value is added",
       .default_text = "position_command",
       .is_number = false,
       .words = kInjectionPoints},
      response_time("time_constant_ms",
                    "time constant of the NC's first-order response to a value"),
      response_time("dead_time_ms", "dead time of the NC's response"),
      response_time("update_period_ms",
                    "interval at which the NC evaluates the table; 0: every position period"),
      kShiftSpec,
      kIterationsSpec,
  }};
  return kSpecs;
}

class Tables final : public SetpointPart {
 public:
  Tables(const SetpointEntry& entry, const std::vector<GridTable>& tables) : entry_(entry) {
    for (const GridTable& table : tables) {
      if (!is_zero(table)) tables_.push_back(&table);
    }
  }
  SetpointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints sum = Joints::Zero();
    for (const GridTable* table : tables_) sum.head<3>() += table->at(Q_ref);
    return sum;
  }

 private:
  static bool is_zero(const GridTable& table) {
    return std::all_of(table.value.begin(), table.value.end(),
                       [](const Eigen::Vector3d& value) { return value.isZero(0.0); });
  }

  SetpointEntry entry_;
  std::vector<const GridTable*> tables_;  // those that displace an axis somewhere
};

// The error that the tables approximate.
class ErrorItself final : public SetpointPart {
 public:
  // @param base  (3; m) taken from it
  ErrorItself(const SetpointEntry& entry, const IdentifiedMachine& identified, Action action,
              Iterations iterations, const Eigen::Vector3d& base)
      : entry_(entry),
        identified_(identified),
        action_(action),
        iterations_(iterations),
        base_(base) {}
  SetpointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints out = Joints::Zero();
    out.head<3>() = setpoint_displacement(identified_, action_, iterations_, Q_ref) - base_;
    return out;
  }

 private:
  SetpointEntry entry_;
  const IdentifiedMachine& identified_;
  Action action_;
  Iterations iterations_;
  Eigen::Vector3d base_;
};

constexpr double kAnySigma = 1.0;  // of rotary axes, which stand as programmed

class CompensationTable final : public Strategy {
 public:
  CompensationTable(const SetpointEntry& entry, std::vector<GridTable> tables, Action action,
                    const IdentifiedMachine& identified)
      : entry_(entry), tables_(std::move(tables)), action_(action), identified_(identified) {}
  std::unique_ptr<SetpointPart> setpoint() const override {
    return std::make_unique<Tables>(entry_, tables_);
  }
  // Errors that X, Y and Z cannot compensate; points and spacing left aside.
  std::optional<Residual> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(identified_, action_, DisplacedAxes::linear, kAnySigma, Q);
  }
  std::vector<BeyondTable> beyond_tables(const Joints& Q) const override {
    constexpr double kRounding = 1e-9;  // m
    std::vector<BeyondTable> out;
    for (const GridTable& table : tables_) {
      for (const GridLine& line : table.lines) {
        const double q = Q[line.joint];
        if (q < line.first - kRounding) out.push_back({line.joint, line.first});
        if (q > line.last() + kRounding) out.push_back({line.joint, line.last()});
      }
    }
    return out;
  }

 private:
  SetpointEntry entry_;
  std::vector<GridTable> tables_;
  Action action_;
  IdentifiedMachine identified_;
};

class ExactTable final : public Strategy {
 public:
  ExactTable(const SetpointEntry& entry, Action action, Iterations iterations, bool from_reference,
             const IdentifiedMachine& identified)
      : entry_(entry), action_(action), iterations_(iterations), identified_(identified) {
    if (from_reference)
      base_ = setpoint_displacement(identified, action, iterations, identified.reference);
  }
  std::unique_ptr<SetpointPart> setpoint() const override {
    return std::make_unique<ErrorItself>(entry_, identified_, action_, iterations_, base_);
  }
  std::optional<Residual> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(identified_, action_, DisplacedAxes::linear, kAnySigma, Q);
  }

 private:
  SetpointEntry entry_;
  Action action_;
  Iterations iterations_;
  IdentifiedMachine identified_;
  Eigen::Vector3d base_ = Eigen::Vector3d::Zero();
};

bool is_power_of_two_spacing(double spacing) {
  const double exponent = std::log2(spacing / kGridStep);
  return std::abs(exponent - std::round(exponent)) < 1e-9;
}

// Axes that a table over `joint` moves.
Eigen::Vector3d moved_by(const std::string& output, int joint, const JointLayout& layout) {
  const Eigen::Vector3d own = Eigen::Vector3d::Unit(joint), all = Eigen::Vector3d::Ones();
  if (output == "all") return all;
  if (output == "own") return own;
  if (output == "others") return all - own;
  for (int j = 0; j < kLinearJoints; ++j) {
    if (layout.has(j) && layout.letter_of(j) == output[0]) return Eigen::Vector3d::Unit(j);
  }
  throw InputError({},
                   fmt::format("compensated_axis = \"{}\"; the machine has no such axis", output));
}

SetpointEntry entry_of(const Parameters& p) {
  SetpointEntry entry;
  const auto word =
      std::find(kInjectionPoints.begin(), kInjectionPoints.end(), p.word("injection_point"));
  entry.entry = static_cast<EntryPoint>(word - kInjectionPoints.begin());
  entry.time_constant = p.number("time_constant_ms");
  entry.dead_time = p.number("dead_time_ms");
  entry.update_period = p.number("update_period_ms");
  return entry;
}

bool holds_error_at_reference(const Parameters& p) {
  return p.word("zero_at_reference") == "false";
}

// One line for each axis that tables run over.
std::vector<GridLine> lines_of(const Tabulation& of) {
  std::vector<GridLine> lines;
  const std::string& axes = of.p.word("base_axis");
  for (int joint = 0; joint < kLinearJoints; ++joint) {
    if (!of.machine.layout.has(joint)) continue;
    const char axis = of.machine.layout.letter_of(joint);
    if (axes != "all" && axes.find(axis) == std::string::npos) continue;
    lines.push_back(of.line(joint));
  }
  if (lines.empty() || (axes != "all" && lines.size() < axes.size())) {
    throw InputError({}, fmt::format("base_axis = \"{}\"; the machine has no such axis", axes));
  }
  return lines;
}

std::vector<GridTable> tables_of(const Tabulation& of) {
  std::vector<GridLine> lines = lines_of(of);
  if (of.p.number("shift_mm") != 0.0 && lines.size() > 1) {
    throw InputError({}, "shift_mm requires one base_axis: on several, feeds and delays differ");
  }
  const std::string& output = of.p.word("compensated_axis");
  Eigen::Vector3d from_reference = Eigen::Vector3d::Zero();
  if (of.p.word("zero_at_reference") == "true") from_reference.setOnes();
  std::vector<GridTable> tables;
  if (of.p.word("layout") == "grid") {
    if (of.p.word("points") == "optimal") {
      throw InputError({}, "points = \"optimal\" requires layout = \"axis_tables\"");
    }
    if (output == "own" || output == "others") {
      throw InputError({}, fmt::format("compensated_axis = \"{}\" requires layout = "
                                       "\"axis_tables\"; a grid has several base axes",
                                       output));
    }
    const Eigen::Vector3d moved = moved_by(output, lines.front().joint, of.machine.layout);
    tables.push_back(of.table(std::move(lines), moved, from_reference));
  } else {
    // The tables of several axes are summed: each holds its change from the reference position, and
    // the first one that moves an axis the value there.
    for (const GridLine& line : lines) {
      const Eigen::Vector3d moved = moved_by(output, line.joint, of.machine.layout);
      tables.push_back(of.table({line}, moved, from_reference));
      from_reference = from_reference.cwiseMax(moved);
    }
  }
  return tables;
}

std::unique_ptr<Strategy> make(const Parameters& p, Action action,
                               const IdentifiedMachine& identified) {
  if (p.word("layout") == "continuous") {
    if (p.number("shift_mm") != 0.0) {
      throw InputError({}, "shift_mm requires layout = \"axis_tables\"");
    }
    return std::make_unique<ExactTable>(entry_of(p), action, iterations_of(p),
                                        p.word("zero_at_reference") == "true", identified);
  }
  if (p.word("points") == "equidistant" && p.word("spacing_rule") == "power_of_two" &&
      !is_power_of_two_spacing(p.number("spacing_mm"))) {
    throw InputError({}, fmt::format("spacing_mm = {:g}; must be 2^n x 0.0001 (such as 1.6384, "
                                     "3.2768, 6.5536), or set spacing_rule = \"free\"",
                                     p.number("spacing_mm") / mm));
  }
  return std::make_unique<CompensationTable>(entry_of(p), tables_of({identified, p, action}),
                                             action, identified);
}

}  // namespace

Entry table_entry() {
  Entry entry = {"table", "adds compensation tables to the setpoint inside the NC", specs(), make};
  entry.holds_error_at_reference = holds_error_at_reference;
  return entry;
}

}  // namespace servomill::strategies
