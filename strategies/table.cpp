#include "strategies/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/compensation.h"
#include "strategies/grid_table.h"
#include "strategies/pose_compensation.h"
#include "strategies/tabulate.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 3> kForms = {"lines", "lattice", "exact"};
constexpr std::array<std::string_view, 7> kAxes = {"X", "Y", "Z", "XY", "XZ", "YZ", "all"};
constexpr std::array<std::string_view, 6> kOutputs = {"all", "own", "others", "X", "Y", "Z"};
constexpr std::array<std::string_view, 2> kAtReference = {"error", "zero"};
constexpr std::array<std::string_view, 1> kAuto = {"auto"};
constexpr std::array<std::string_view, 2> kGrids = {"power_of_two", "free"};
constexpr std::array<std::string_view, 3> kEntryPoints = {"before_filter", "position_command",
                                                          "feed_forward"};
constexpr std::array<std::string_view, 1> kTravel = {"travel"};
constexpr double kGridStep =
    0.1 * um;  // spacing is 2^n times this (TNC 407/415/425 Technical Manual, 1998, p. 153)

const std::array<ParameterSpec, 15>& specs() {
  static const std::array<ParameterSpec, 15> kSpecs = {{
      {.name = "form",
       .help =
           "lines: a table over each axis, summed; lattice: one over all of them, linear in each "
           "axis between the corners of a cell; exact: none, but the error itself, as tables of "
           "all "
           "axes with points everywhere would give it",
       .default_text = "lines",
       .is_number = false,
       .words = kForms,
       .shortcoming = Shortcoming::points,
       .ideal = "exact"},
      {.name = "axis",
       .help = "axes over which tables run; all: each linear axis",
       .default_text = "all",
       .is_number = false,
       .words = kAxes},
      {.name = "output",
       .help =
           "axes that the tables move; own: that over which the table runs, others: all but that",
       .default_text = "all",
       .is_number = false,
       .words = kOutputs},
      {.name = "at_reference",
       .help = "where the machine starts: the error there, or zero, where another table holds it",
       .default_text = "error",
       .is_number = false,
       .words = kAtReference},
      {.name = "spacing_mm",
       .help = "distance of the points",
       .unit = "mm",
       .default_text = "1.6384",
       .min = 1e-4},
      {.name = "grid",
       .help = "power_of_two: spacing must be 2^n x 0.1 um; free: any spacing",
       .default_text = "power_of_two",
       .is_number = false,
       .words = kGrids},
      {.name = "from_mm",
       .help = "machine coordinate of the first point; travel: lower end of travel",
       .unit = "mm",
       .default_text = "travel",
       .words = kTravel},
      {.name = "to_mm",
       .help = "machine coordinate that the last point must reach; travel: upper end of travel",
       .unit = "mm",
       .default_text = "travel",
       .words = kTravel},
      {.name = "max_points",
       .help =
           "points that the NC accepts in one table; auto: 256, in a lattice 15625 (25 x 25 x 25)",
       .default_text = "auto",
       .min = 2,
       .max = 1e6,
       .words = kAuto},
      {.name = "max_step_ratio",
       .help = "largest change of value between points that the NC accepts, over their distance",
       .default_text = "0.015625",
       .min = 0.0},
      {.name = "entry",
       .help = "where the value enters the NC",
       .default_text = "position_command",
       .is_number = false,
       .words = kEntryPoints},
      {.name = "response_time_ms",
       .help = "first-order lag of the NC's answer to a value",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4,
       .shortcoming = Shortcoming::delay,
       .ideal = "0"},
      {.name = "dead_time_ms",
       .help = "delay before the NC answers",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4,
       .shortcoming = Shortcoming::delay,
       .ideal = "0"},
      {.name = "update_period_ms",
       .help = "how often the NC looks into the table; 0: every position period",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4,
       .shortcoming = Shortcoming::delay,
       .ideal = "0"},
      kIterationsSpec,
  }};
  return kSpecs;
}

class Tables final : public SetPointPart {
 public:
  Tables(const SetPointEntry& entry, const std::vector<GridTable>& tables)
      : entry_(entry), tables_(tables) {}
  SetPointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints sum = Joints::Zero();
    for (const GridTable& table : tables_) sum.head<3>() += table.at(Q_ref);
    return sum;
  }

 private:
  SetPointEntry entry_;
  const std::vector<GridTable>& tables_;
};

// The error that the tables approximate.
class ErrorItself final : public SetPointPart {
 public:
  // @param base  (3; m) taken from it
  ErrorItself(const SetPointEntry& entry, const Belief& belief, Sign sign, Iterations iterations,
              const Eigen::Vector3d& base)
      : entry_(entry), belief_(belief), sign_(sign), iterations_(iterations), base_(base) {}
  SetPointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints out = Joints::Zero();
    out.head<3>() = set_point_displacement(belief_, sign_, iterations_, Q_ref) - base_;
    return out;
  }

 private:
  SetPointEntry entry_;
  const Belief& belief_;
  Sign sign_;
  Iterations iterations_;
  Eigen::Vector3d base_;
};

constexpr double kAnySigma = 1.0;  // of rotary axes, which stand as programmed

class CompensationTable final : public Strategy {
 public:
  CompensationTable(const SetPointEntry& entry, std::vector<GridTable> tables, Sign sign,
                    const Belief& belief)
      : entry_(entry), tables_(std::move(tables)), sign_(sign), belief_(belief) {}
  std::unique_ptr<SetPointPart> set_point() const override {
    return std::make_unique<Tables>(entry_, tables_);
  }
  // Errors that X, Y and Z cannot compensate; points and spacing left aside.
  std::optional<Leftover> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(belief_, sign_, DisplacedAxes::linear, kAnySigma, Q);
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
  SetPointEntry entry_;
  std::vector<GridTable> tables_;
  Sign sign_;
  Belief belief_;
};

class ExactTable final : public Strategy {
 public:
  ExactTable(const SetPointEntry& entry, Sign sign, Iterations iterations, bool from_reference,
             const Belief& belief)
      : entry_(entry), sign_(sign), iterations_(iterations), belief_(belief) {
    if (from_reference) base_ = set_point_displacement(belief, sign, iterations, belief.reference);
  }
  std::unique_ptr<SetPointPart> set_point() const override {
    return std::make_unique<ErrorItself>(entry_, belief_, sign_, iterations_, base_);
  }
  std::optional<Leftover> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(belief_, sign_, DisplacedAxes::linear, kAnySigma, Q);
  }

 private:
  SetPointEntry entry_;
  Sign sign_;
  Iterations iterations_;
  Belief belief_;
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
  throw InputError({}, fmt::format("output = \"{}\"; the machine has no such axis", output));
}

SetPointEntry entry_of(const Parameters& p) {
  SetPointEntry entry;
  const auto word = std::find(kEntryPoints.begin(), kEntryPoints.end(), p.word("entry"));
  entry.entry = static_cast<EntryPoint>(word - kEntryPoints.begin());
  entry.response_time = p.number("response_time_ms");
  entry.dead_time = p.number("dead_time_ms");
  entry.update_period = p.number("update_period_ms");
  return entry;
}

bool holds_error_at_reference(const Parameters& p) { return p.word("at_reference") == "error"; }

// One line for each axis that tables run over.
std::vector<GridLine> lines_of(const Tabulation& of) {
  std::vector<GridLine> lines;
  const std::string& axes = of.p.word("axis");
  for (int joint = 0; joint < kLinearJoints; ++joint) {
    if (!of.machine.layout.has(joint)) continue;
    const char axis = of.machine.layout.letter_of(joint);
    if (axes != "all" && axes.find(axis) == std::string::npos) continue;
    lines.push_back(of.line(joint));
  }
  if (lines.empty() || (axes != "all" && lines.size() < axes.size())) {
    throw InputError({}, fmt::format("axis = \"{}\"; the machine has no such axis", axes));
  }
  return lines;
}

std::vector<GridTable> tables_of(const Tabulation& of) {
  std::vector<GridLine> lines = lines_of(of);
  const std::string& output = of.p.word("output");
  Eigen::Vector3d from_reference = Eigen::Vector3d::Zero();
  if (of.p.word("at_reference") == "zero") from_reference.setOnes();
  std::vector<GridTable> tables;
  if (of.p.word("form") == "lattice") {
    if (output == "own" || output == "others") {
      throw InputError({},
                       fmt::format("output = \"{}\" belongs to form = \"lines\"; a lattice runs "
                                   "over several axes",
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

std::unique_ptr<Strategy> make(const Parameters& p, Sign sign, const Belief& belief) {
  if (p.word("form") == "exact") {
    return std::make_unique<ExactTable>(entry_of(p), sign, iterations_of(p),
                                        p.word("at_reference") == "zero", belief);
  }
  if (p.word("grid") == "power_of_two" && !is_power_of_two_spacing(p.number("spacing_mm"))) {
    throw InputError({}, fmt::format("spacing_mm = {:g}; must be 2^n x 0.0001 (such as 1.6384, "
                                     "3.2768, 6.5536), or set grid = \"free\"",
                                     p.number("spacing_mm") / mm));
  }
  return std::make_unique<CompensationTable>(entry_of(p), tables_of({belief, p, sign}), sign,
                                             belief);
}

}  // namespace

Entry table_entry() {
  Entry entry = {"table", "adds compensation tables to the set point inside the NC", specs(), make};
  entry.holds_error_at_reference = holds_error_at_reference;
  return entry;
}

}  // namespace servomill::strategies
