#include "sim/input/read_machine_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

using model::MachineTest;

constexpr double kMaxSeed = 9007199254740992.0;  // 2^53: whole numbers are exact up to there
using model::TestStandard;

std::string read_name(config::Reader& table, std::set<std::string>& names) {
  std::string name = table.text("name");
  if (name.empty() && table.is("name", config::Value::Type::text)) {
    table.fault("name", "must not be empty");
  }
  constexpr std::string_view kBlanks = " \t";
  if (name.find_first_of("()/\r\n") != std::string::npos) {
    table.fault("name", "must not contain ( ) / or line breaks: it names a section of the program");
  } else if (!name.empty() && (kBlanks.find(name.front()) != std::string_view::npos ||
                               kBlanks.find(name.back()) != std::string_view::npos)) {
    table.fault("name", "must not begin or end with blanks");
  } else if (name == "." || name == "..") {
    table.fault("name", "must not be . or ..: it names a group of the result file");
  }
  if (!name.empty() && !names.insert(name).second) {
    table.fault("name", "is already the name of an earlier test");
  }
  return name;
}

std::optional<Axis> linear_axis(char name, const JointLayout& layout) {
  const auto axis = axis_of(name);
  if (!axis || !is_linear(*axis)) return std::nullopt;
  if (layout != JointLayout{} && !layout.joint_of(*axis)) return std::nullopt;
  return axis;
}

void read_axis(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const std::size_t before = table.faults();
  const std::string text = table.text("axis");
  if (table.faults() > before) return;
  const auto axis = text.size() == 1 ? axis_of(text.front()) : std::nullopt;
  if (!axis || !is_linear(*axis)) {
    table.fault("axis", "must be X, Y or Z: tests of rotary axes are not simulated");
  } else if (!linear_axis(text.front(), layout)) {
    table.fault("axis", fmt::format("the machine has no axis {}", text));
  } else {
    out.axes = {*axis};
  }
}

// "XY", "ZX" or "YZ": counter-clockwise is from the first axis to the second.
void read_plane(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  constexpr std::array<std::string_view, 3> kPlanes = {"XY", "ZX", "YZ"};
  const std::size_t before = table.faults();
  const std::string_view plane = kPlanes[table.choice("plane", kPlanes)];
  if (table.faults() > before) return;
  for (const char name : plane) {
    const auto axis = linear_axis(name, layout);
    if (!axis) {
      table.fault("plane", fmt::format("the machine has no axis {}", name));
      return;
    }
    out.axes.push_back(*axis);
  }
}

// Axes that a table of corners names, X_mm, Y_mm, Z_mm.
std::vector<Axis> named_axes(const config::Reader& corner) {
  std::vector<Axis> out;
  for (const std::string& key : corner.keys()) {
    if (const auto axis = key.ends_with("_mm") ? axis_of(key.front()) : std::nullopt) {
      out.push_back(*axis);
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

// from = { X_mm, Y_mm, Z_mm }, to = { ... }: opposite corners of a box or a face.
// @return length of the diagonals, m; 0 if there are faults
double read_corners(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const std::size_t before = table.faults();
  config::Reader from = table.table("from"), to = table.table("to");
  const AxisWords begin = read_words(from, layout), end = read_words(to, layout);
  const std::vector<Axis> axes = named_axes(from);
  if (table.faults() > before) return 0.0;
  if (axes != named_axes(to) || axes.size() < 2 || !is_linear(axes.back())) {
    table.fault("to",
                "must name the axes of from: X, Y, Z for diagonals of a box, two of them "
                "for those of a face");
    return 0.0;
  }
  for (const Axis axis : axes) {
    if (begin[index_of(axis)] < end[index_of(axis)]) continue;
    to.fault(fmt::format("{}_mm", letter(axis)), "must be above that of from");
    return 0.0;
  }
  out.axes = axes;
  return (end - begin).head<3>().norm();
}

// Lines of a test, once the positions of all axes are known.
void place_lines(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  if (out.standard == TestStandard::positioning && !out.axes.empty()) {
    const auto axis = static_cast<Eigen::Index>(index_of(out.axes.front()));
    Eigen::Vector3d from = out.at.head<3>();
    from[axis] = 0.0;
    out.lines = {{out.name, from, Eigen::Vector3d::Unit(axis)}};
  } else if (out.standard == TestStandard::diagonals && !out.axes.empty()) {
    config::Reader from = table.table("from"), to = table.table("to");
    Eigen::Vector3d begin = out.at.head<3>(), end = begin;
    for (const Axis axis : out.axes) {
      const auto i = static_cast<Eigen::Index>(index_of(axis));
      begin[i] = read_words(from, layout)[i];
      end[i] = read_words(to, layout)[i];
    }
    out.lines = model::diagonals(begin, end, out.axes);
  }
}

// Equally spaced targets and their spread.
// @param before  faults before the ends were read: without them there are no targets
std::vector<double> read_spaced(config::Reader& table, double from, double to, std::size_t before) {
  const int count =
      static_cast<int>(table.integer_or("target_count", standards::usual_target_count(to - from),
                                        {config::at_least(2), config::at_most(1000)}));
  const double spread =
      table.real_or("target_spread_mm", 0.0, config::kLength, {config::at_least(0.0)});
  if (table.faults() > before) return {};
  if (!(2.0 * spread < (to - from) / (count - 1))) {
    table.fault("target_spread_mm", "must be below half of the distance between targets");
    return {};
  }
  constexpr std::uint64_t kSeed = 230;  // targets do not depend on the errors of the device
  return standards::spaced_targets(from, to, count, spread, kSeed);
}

// targets_mm = [...], or from_mm, to_mm with their number and spread.
std::vector<double> read_targets(config::Reader& table) {
  const std::size_t before = table.faults();
  if (table.has("targets_mm")) {
    for (const char* const key : {"from_mm", "to_mm", "target_count", "target_spread_mm"}) {
      if (table.raw(key) != nullptr) table.fault(key, "has no effect beside targets_mm");
    }
    std::vector<double> targets = table.reals("targets_mm", config::kLength);
    if (table.faults() == before &&
        (targets.size() < 2 ||
         !std::is_sorted(targets.begin(), targets.end(), std::less_equal<>()))) {
      table.fault("targets_mm", "must be two targets or more in rising order");
    }
    return targets;
  }
  const double from = table.real("from_mm", config::kLength);
  const double to = table.real("to_mm", config::kLength);
  if (table.faults() == before && !(from < to)) table.fault("to_mm", "must be above from_mm");
  return read_spaced(table, from, to, before);
}

void read_cycle(config::Reader& table, MachineTest& out) {
  out.cycle.runs =
      static_cast<int>(table.integer_or("runs", 5, {config::at_least(1), config::at_most(100)}));
  out.cycle.overrun = table.real_or("overrun_mm", 1.0 * mm, config::kLength, {config::above(0.0)});
}

void read_motion(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  switch (out.standard) {
    case TestStandard::positioning:
      read_axis(table, layout, out);
      out.cycle.targets = read_targets(table);
      read_cycle(table, out);
      break;
    case TestStandard::diagonals: {
      const double length = read_corners(table, layout, out);
      if (length > 0.0) out.cycle.targets = read_spaced(table, 0.0, length, table.faults());
      read_cycle(table, out);
      break;
    }
    case TestStandard::circles:
      read_plane(table, layout, out);
      out.radius = table.real("radius_mm", config::kLength, {config::above(0.0)});
      out.readings = static_cast<int>(
          table.integer_or("reading_count", 720, {config::at_least(72), config::at_most(36000)}));
      break;
  }
  out.feed = table.real("feed", config::kVelocity, {config::above(0.0)});
  out.dwell = table.real_or("dwell_s", 1.0, config::kTime, {config::at_least(0.1)});
}

// Keys of the tests of other standards.
void refuse_other_keys(config::Reader& table, TestStandard standard) {
  struct Key {
    const char* name;
    bool positioning, diagonals, circles;
  };
  constexpr std::array<Key, 13> kKeys = {{{"axis", true, false, false},
                                          {"from_mm", true, false, false},
                                          {"to_mm", true, false, false},
                                          {"targets_mm", true, false, false},
                                          {"target_count", true, true, false},
                                          {"target_spread_mm", true, true, false},
                                          {"runs", true, true, false},
                                          {"overrun_mm", true, true, false},
                                          {"from", false, true, false},
                                          {"to", false, true, false},
                                          {"plane", false, false, true},
                                          {"radius_mm", false, false, true},
                                          {"reading_count", false, false, true}}};
  for (const Key& key : kKeys) {
    const bool belongs = standard == TestStandard::positioning ? key.positioning
                         : standard == TestStandard::diagonals ? key.diagonals
                                                               : key.circles;
    if (!belongs && table.raw(key.name) != nullptr) {
      table.fault(key.name, fmt::format("has no effect on a test after {}",
                                        model::kTestStandards[static_cast<std::size_t>(standard)]));
    }
  }
}

// A ball bar has a length of its own, and errors of its readings; no beam.
void read_device(config::Reader& table, MachineTest& out) {
  config::Reader device = table.table("device");
  if (out.standard == TestStandard::circles) {
    for (const char* const key :
         {"scale_uncertainty_um_per_m", "target_uncertainty_um", "misalignment_mrad",
          "coefficient_per_K", "coefficient_uncertainty_per_K", "temperature_degC",
          "temperature_uncertainty_K"}) {
      if (device.raw(key) != nullptr) device.fault(key, "has no effect on a circle");
    }
  }
  out.device = standards::contributions_of(device, false);
}

void read_others(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  config::Reader words = table.table("at");
  out.at = read_words(words, layout);
  if (out.standard == TestStandard::circles) return;  // their centre
  for (const Axis axis : out.axes) {
    const std::string own = fmt::format("{}_mm", letter(axis));
    if (words.has(own)) words.fault(own, "is the axis under test");
  }
}

MachineTest read_test(config::Reader& table, const JointLayout& layout,
                      std::set<std::string>& names) {
  MachineTest out;
  out.name = read_name(table, names);
  const std::size_t before = table.faults();
  out.standard = static_cast<TestStandard>(table.choice("standard", model::kTestStandards));
  if (table.faults() == before) refuse_other_keys(table, out.standard);
  read_motion(table, layout, out);
  if (table.has("at")) read_others(table, layout, out);
  place_lines(table, layout, out);
  out.tool =
      static_cast<int>(table.integer_or("tool", 0, {config::at_least(0), config::at_most(99999)}));
  out.seed = static_cast<std::uint64_t>(
      table.integer_or("seed", 1, {config::at_least(0), config::at_most(kMaxSeed)}));
  if (table.has("device")) read_device(table, out);
  return out;
}

}  // namespace

model::MachineTests read_machine_tests(config::Reader& root, const JointLayout& layout) {
  model::MachineTests out;
  std::set<std::string> names;
  for (config::Reader& table : root.tables_or_none("test")) {
    auto test = std::make_shared<MachineTest>(read_test(table, layout, names));
    test->place = table.place("name");
    out.push_back(std::move(test));
  }
  return out;
}

namespace {

struct Range {
  double from = 0.0, to = 0.0;  // m, rad
};

// Positions of an axis in a test, in work coordinates.
Range range_of(const MachineTest& test, Axis axis) {
  const int i = index_of(axis);
  Range out{test.at[i], test.at[i]};
  if (std::find(test.axes.begin(), test.axes.end(), axis) == test.axes.end()) return out;
  if (test.standard == TestStandard::circles) return {out.from - test.radius, out.to + test.radius};
  out = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const model::TestStop& stop : model::stops(test)) {
    out.from = std::min(out.from, stop.position[i]);
    out.to = std::max(out.to, stop.position[i]);
  }
  return out;
}

std::string travel_text(const MachineTest& test, Axis axis, const Range& at) {
  const double unit = is_linear(axis) ? mm : deg;
  if (at.from == at.to) {
    return fmt::format("test {} is made at {} = {:g} {}", test.name, letter(axis), at.from / unit,
                       is_linear(axis) ? "mm" : "deg");
  }
  return fmt::format("test {} moves {} from {:g} to {:g} mm{}", test.name, letter(axis),
                     at.from / unit, at.to / unit,
                     test.standard == TestStandard::circles ? "" : " with its overrun");
}

}  // namespace

std::vector<Fault> faults_of_travel(const model::MachineTests& tests,
                                    const model::MachineSettings& machine,
                                    const model::ProgramSpec& program) {
  std::vector<Fault> out;
  for (const auto& test : tests) {
    if (!test->moves()) continue;
    const controllers::ToolEntry* tool = program.tools.find(test->tool);
    for (const Axis axis : kAllAxes) {
      const auto joint = machine.chain.layout.joint_of(axis);
      if (!joint) continue;
      const int i = index_of(axis);
      const double offset = program.work_offset[i] + (tool != nullptr ? tool->offset[i] : 0.0);
      Range at = range_of(*test, axis);
      at = {at.from + offset, at.to + offset};
      const double lower = machine.nc.lower[*joint], upper = machine.nc.upper[*joint];
      if (at.from >= lower && at.to <= upper) continue;
      const double unit = is_linear(axis) ? mm : deg;
      out.push_back(
          {test->place, fmt::format("{}, in machine coordinates; the travel is {:g} to {:g} {}",
                                    travel_text(*test, axis, at), lower / unit, upper / unit,
                                    is_linear(axis) ? "mm" : "deg")});
    }
  }
  return out;
}

}  // namespace servomill::sim::input
