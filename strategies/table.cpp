#include "strategies/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/compensation.h"
#include "strategies/pose_compensation.h"

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

// Equidistant points of one axis.
struct Line {
  int joint = 0;
  double first = 0.0;      // m
  double spacing = 1.0;    // m
  std::size_t points = 2;  // at least

  double at(std::size_t i) const { return first + static_cast<double>(i) * spacing; }
  double last() const { return at(points - 1); }
};

// Values at the points of one to three lines that cross; linear in each coordinate between the
// corners of a cell, constant beyond the ends.
struct Table {
  std::vector<Line> lines;
  std::vector<Eigen::Vector3d> value;  // m, of X, Y, Z; the first line's points are neighbours

  Eigen::Vector3d at(const Joints& Q) const {
    Eigen::Vector3d corner[1 << kLinearJoints];
    const std::size_t axes = lines.size();
    double share[kLinearJoints];  // of the cell, that has been passed
    std::size_t base = 0, step[kLinearJoints], size = 1;
    for (std::size_t a = 0; a < axes; ++a) {
      const Line& line = lines[a];
      const auto last = static_cast<double>(line.points - 1);
      const double u = std::clamp((Q[line.joint] - line.first) / line.spacing, 0.0, last);
      const auto i = std::min(static_cast<std::size_t>(u), line.points - 2);
      share[a] = u - static_cast<double>(i);
      base += i * size;
      step[a] = size;
      size *= line.points;
    }
    for (std::size_t c = 0; c < std::size_t{1} << axes; ++c) {
      std::size_t place = base;
      for (std::size_t a = 0; a < axes; ++a) place += (c >> a & 1U) * step[a];
      corner[c] = value[place];
    }
    for (std::size_t a = axes; a-- > 0;) {  // from corners to the point, axis by axis
      for (std::size_t c = 0; c < std::size_t{1} << a; ++c) {
        corner[c] += share[a] * (corner[c + (std::size_t{1} << a)] - corner[c]);
      }
    }
    return corner[0];
  }
};

class Tables final : public SetPointPart {
 public:
  Tables(const SetPointEntry& entry, const std::vector<Table>& tables)
      : entry_(entry), tables_(tables) {}
  SetPointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints sum = Joints::Zero();
    for (const Table& table : tables_) sum.head<3>() += table.at(Q_ref);
    return sum;
  }

 private:
  SetPointEntry entry_;
  const std::vector<Table>& tables_;
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
  CompensationTable(const SetPointEntry& entry, std::vector<Table> tables, Sign sign,
                    const Belief& belief)
      : entry_(entry), tables_(std::move(tables)), sign_(sign), belief_(belief) {}
  std::unique_ptr<SetPointPart> set_point() const override {
    return std::make_unique<Tables>(entry_, tables_);
  }
  // What X, Y and Z cannot; lines, lattice and spacing left aside.
  std::optional<Leftover> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(belief_, sign_, DisplacedAxes::linear, kAnySigma, Q);
  }
  std::vector<BeyondTable> beyond_tables(const Joints& Q) const override {
    constexpr double kRounding = 1e-9;  // m
    std::vector<BeyondTable> out;
    for (const Table& table : tables_) {
      for (const Line& line : table.lines) {
        const double q = Q[line.joint];
        if (q < line.first - kRounding) out.push_back({line.joint, line.first});
        if (q > line.last() + kRounding) out.push_back({line.joint, line.last()});
      }
    }
    return out;
  }

 private:
  SetPointEntry entry_;
  std::vector<Table> tables_;
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

// "table over X", "lattice over X, Y, Z"
std::string name_of(const std::vector<Line>& lines, const JointLayout& layout) {
  std::string name;
  for (const Line& line : lines) {
    name += fmt::format("{}{}", name.empty() ? "" : ", ", layout.letter_of(line.joint));
  }
  return fmt::format("{} over {}", lines.size() == 1 ? "table" : "lattice", name);
}

// Refuses tables that the NC would refuse, by the names that its operator reads.
void check_points(const std::vector<Line>& lines, const JointLayout& layout, const Parameters& p) {
  constexpr double kLine = 256, kLattice = 25.0 * 25.0 * 25.0;
  const double usual = lines.size() == 1 ? kLine : kLattice;
  const double most = p.is_word("max_points") ? usual : p.number("max_points");
  double all = 1.0;
  std::string product;
  for (const Line& line : lines) {
    all *= static_cast<double>(line.points);
    product += fmt::format("{}{}", product.empty() ? "" : " x ", line.points);
  }
  if (all <= most) return;
  if (lines.size() > 1) product += fmt::format(" = {:.0f}", all);
  throw InputError({}, fmt::format("{}: {} points; the NC accepts at most {} (max_points); use a "
                                   "larger spacing_mm or from_mm and to_mm",
                                   name_of(lines, layout), product, most));
}

// Calls f(point) for all points of the lines, (i, j, k) of each, the first line's first.
template <class F>
void for_all_points(const std::vector<Line>& lines, F f) {
  std::array<std::size_t, kLinearJoints> point{};
  for (std::size_t a = 0; a < lines.size();) {
    f(point);
    for (a = 0; a < lines.size() && ++point[a] == lines[a].points; ++a) point[a] = 0;
  }
}

void check_slopes(const Table& table, const JointLayout& layout, double max_ratio) {
  std::size_t n = 0;
  for_all_points(table.lines, [&](const auto& point) {
    std::size_t size = 1;
    for (std::size_t a = 0; a < table.lines.size(); ++a) {
      const Line& line = table.lines[a];
      const std::size_t before = size;
      size *= line.points;
      if (point[a] == 0) continue;
      const double ratio =
          (table.value[n] - table.value[n - before]).cwiseAbs().maxCoeff() / line.spacing;
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

Line line_of(const Belief& belief, const Parameters& p, int joint) {
  Line line;
  line.joint = joint;
  line.spacing = p.number("spacing_mm");
  line.first = p.is_word("from_mm") ? belief.lower[joint] : p.number("from_mm");
  const double to = p.is_word("to_mm") ? belief.upper[joint] : p.number("to_mm");
  const char axis = belief.layout.letter_of(joint);
  if (!(to > line.first)) {
    throw InputError({}, fmt::format("table over {}: from_mm = {:g} must be < to_mm = {:g}", axis,
                                     line.first / mm, to / mm));
  }
  const double intervals = std::max(1.0, std::ceil((to - line.first) / line.spacing - 1e-9));
  constexpr double kMostIntervals = 1e7;
  if (intervals > kMostIntervals) {
    throw InputError({}, fmt::format("table over {}: {:.3g} points are more than any NC holds",
                                     axis, intervals));
  }
  line.points = static_cast<std::size_t>(intervals) + 1;
  return line;
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

// @param moved  axes that the table moves
// @param from_reference  of which it holds the change from the reference position only
Table tabulate(const Belief& belief, const Parameters& p, Sign sign, std::vector<Line> lines,
               const Eigen::Vector3d& moved, const Eigen::Vector3d& from_reference) {
  check_points(lines, belief.layout, p);
  Table table;
  table.lines = std::move(lines);
  const Iterations iterations = iterations_of(p);
  const auto wanted = [&](const Joints& Q) {
    return set_point_displacement(belief, sign, iterations, Q);
  };
  Joints Q = belief.reference;
  const Eigen::Vector3d base = from_reference.cwiseProduct(wanted(Q));
  for_all_points(table.lines, [&](const auto& point) {
    for (std::size_t a = 0; a < table.lines.size(); ++a) {
      Q[table.lines[a].joint] = table.lines[a].at(point[a]);
    }
    table.value.push_back(moved.cwiseProduct(wanted(Q) - base));
  });
  check_slopes(table, belief.layout, p.number("max_step_ratio"));
  return table;
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
  std::vector<Line> lines;
  const std::string& axes = p.word("axis");
  for (int joint = 0; joint < kLinearJoints; ++joint) {
    if (!belief.layout.has(joint)) continue;
    const char axis = belief.layout.letter_of(joint);
    if (axes != "all" && axes.find(axis) == std::string::npos) continue;
    lines.push_back(line_of(belief, p, joint));
  }
  if (lines.empty() || (axes != "all" && lines.size() < axes.size())) {
    throw InputError({}, fmt::format("axis = \"{}\"; the machine has no such axis", axes));
  }
  const std::string& output = p.word("output");
  Eigen::Vector3d from_reference = Eigen::Vector3d::Zero();
  if (p.word("at_reference") == "zero") from_reference.setOnes();
  std::vector<Table> tables;
  if (p.word("form") == "lattice") {
    if (output == "own" || output == "others") {
      throw InputError({},
                       fmt::format("output = \"{}\" belongs to form = \"lines\"; a lattice runs "
                                   "over several axes",
                                   output));
    }
    const Eigen::Vector3d moved = moved_by(output, lines.front().joint, belief.layout);
    tables.push_back(tabulate(belief, p, sign, std::move(lines), moved, from_reference));
  } else {
    // The tables of several axes are summed: each holds its change from the reference position, and
    // the first one that moves an axis the value there.
    for (const Line& line : lines) {
      const Eigen::Vector3d moved = moved_by(output, line.joint, belief.layout);
      tables.push_back(tabulate(belief, p, sign, {line}, moved, from_reference));
      from_reference = from_reference.cwiseMax(moved);
    }
  }
  return std::make_unique<CompensationTable>(entry_of(p), std::move(tables), sign, belief);
}

}  // namespace

Entry table_entry() {
  Entry entry = {"table", "adds compensation tables to the set point inside the NC", specs(), make};
  entry.holds_error_at_reference = holds_error_at_reference;
  return entry;
}

}  // namespace servomill::strategies
