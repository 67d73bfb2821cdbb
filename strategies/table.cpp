#include "strategies/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/compensation.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 4> kAxes = {"X", "Y", "Z", "all"};
constexpr std::array<std::string_view, 2> kGrids = {"power_of_two", "free"};
constexpr std::array<std::string_view, 3> kEntryPoints = {"before_filter", "position_command",
                                                          "feed_forward"};
constexpr std::array<std::string_view, 1> kTravel = {"travel"};
constexpr double kGridStep =
    0.1 * um;  // spacing is 2^n times this (TNC 407/415/425 Technical Manual, 1998, p. 153)

const std::array<ParameterSpec, 12>& specs() {
  static const std::array<ParameterSpec, 12> kSpecs = {{
      {.name = "axis",
       .help = "axis over which the table runs; all: one table for each linear axis, summed",
       .default_text = "all",
       .is_number = false,
       .words = kAxes},
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
       .help = "points that the NC accepts in one table",
       .default_text = "256",
       .min = 2,
       .max = 1e6},
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
       .max = 1e4},
      {.name = "dead_time_ms",
       .help = "delay before the NC answers",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4},
      {.name = "update_period_ms",
       .help = "how often the NC looks into the table; 0: every position period",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4},
      kIterationsSpec,
  }};
  return kSpecs;
}

// Values at equidistant points of one axis; linear between them, constant beyond the ends.
struct AxisTable {
  int joint = 0;
  double first = 0.0;    // m
  double spacing = 1.0;  // m
  std::vector<Eigen::Vector3d> value;

  Eigen::Vector3d at(double q) const {
    const double last = static_cast<double>(value.size() - 1);
    const double u = std::clamp((q - first) / spacing, 0.0, last);
    const auto i = std::min(static_cast<std::size_t>(u), value.size() - 2);
    return value[i] + (u - static_cast<double>(i)) * (value[i + 1] - value[i]);
  }
};

class Tables final : public SetPointPart {
 public:
  Tables(const SetPointEntry& entry, const std::vector<AxisTable>& tables)
      : entry_(entry), tables_(tables) {}
  SetPointEntry entry() const override { return entry_; }
  Joints offset(const Joints& Q_ref) const override {
    Joints sum = Joints::Zero();
    for (const AxisTable& table : tables_) sum.head<3>() += table.at(Q_ref[table.joint]);
    return sum;
  }

 private:
  SetPointEntry entry_;
  const std::vector<AxisTable>& tables_;
};

class CompensationTable final : public Strategy {
 public:
  CompensationTable(const SetPointEntry& entry, std::vector<AxisTable> tables)
      : entry_(entry), tables_(std::move(tables)) {}
  std::unique_ptr<SetPointPart> set_point() const override {
    return std::make_unique<Tables>(entry_, tables_);
  }

 private:
  SetPointEntry entry_;
  std::vector<AxisTable> tables_;
};

bool is_power_of_two_spacing(double spacing) {
  const double exponent = std::log2(spacing / kGridStep);
  return std::abs(exponent - std::round(exponent)) < 1e-9;
}

// What the NC would refuse, named as its operator would read it.
void check_as_the_nc_would(const AxisTable& table, char axis, double max_points, double max_ratio) {
  if (static_cast<double>(table.value.size()) > max_points) {
    throw InputError({}, fmt::format("table over {}: {} points; the NC accepts at most {} "
                                     "(max_points); use a larger spacing_mm or from_mm and to_mm",
                                     axis, table.value.size(), max_points));
  }
  for (std::size_t i = 1; i < table.value.size(); ++i) {
    const Eigen::Vector3d step = table.value[i] - table.value[i - 1];
    const double ratio = step.cwiseAbs().maxCoeff() / table.spacing;
    if (ratio <= max_ratio) continue;
    throw InputError(
        {}, fmt::format("table over {}: slope {:.2f} um/mm at {} = {:.3f} mm; the NC accepts at "
                        "most {:.2f} um/mm (max_step_ratio)",
                        axis, ratio / (um / mm), axis,
                        (table.first + static_cast<double>(i - 1) * table.spacing) / mm,
                        max_ratio / (um / mm)));
  }
}

// The tables of several axes are summed, so each holds its change from the reference position and
// the first one the value there.
AxisTable tabulate(const Belief& belief, const Parameters& p, Sign sign, int joint,
                   bool with_base) {
  AxisTable table;
  table.joint = joint;
  table.spacing = p.number("spacing_mm");
  table.first = p.is_word("from_mm") ? belief.lower[joint] : p.number("from_mm");
  const double to = p.is_word("to_mm") ? belief.upper[joint] : p.number("to_mm");
  const char axis = belief.layout.letter_of(joint);
  if (!(to > table.first)) {
    throw InputError({}, fmt::format("table over {}: from_mm = {:g} must be < to_mm = {:g}", axis,
                                     table.first / mm, to / mm));
  }
  const double intervals = std::max(1.0, std::ceil((to - table.first) / table.spacing - 1e-9));
  constexpr double kMostIntervals = 1e7;
  if (intervals > kMostIntervals) {
    throw InputError({}, fmt::format("table over {}: {:.3g} points are more than any NC holds",
                                     axis, intervals));
  }
  const Iterations iterations = iterations_of(p);
  Joints Q = belief.reference;
  const Eigen::Vector3d base = set_point_displacement(belief, sign, iterations, Q);
  for (int i = 0; i <= static_cast<int>(intervals); ++i) {
    Q[joint] = table.first + i * table.spacing;
    const Eigen::Vector3d value = set_point_displacement(belief, sign, iterations, Q);
    table.value.push_back(with_base ? value : value - base);
  }
  check_as_the_nc_would(table, axis, p.number("max_points"), p.number("max_step_ratio"));
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

std::unique_ptr<Strategy> make(const Parameters& p, Sign sign, const Belief& belief) {
  if (p.word("grid") == "power_of_two" && !is_power_of_two_spacing(p.number("spacing_mm"))) {
    throw InputError({}, fmt::format("spacing_mm = {:g}; must be 2^n x 0.0001 (such as 1.6384, "
                                     "3.2768, 6.5536), or set grid = \"free\"",
                                     p.number("spacing_mm") / mm));
  }
  std::vector<AxisTable> tables;
  for (int joint = 0; joint < kLinearJoints; ++joint) {
    if (!belief.layout.has(joint)) continue;
    if (p.word("axis") != "all" && p.word("axis")[0] != belief.layout.letter_of(joint)) continue;
    tables.push_back(tabulate(belief, p, sign, joint, tables.empty()));
  }
  if (tables.empty()) {
    throw InputError({},
                     fmt::format("axis = \"{}\"; the machine has no such axis", p.word("axis")));
  }
  return std::make_unique<CompensationTable>(entry_of(p), std::move(tables));
}

}  // namespace

Entry table_entry() {
  return {"table", "adds compensation tables to the set point inside the NC", specs(), make};
}

}  // namespace servomill::strategies
