#include "sim/input/read_test_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

using model::MachineTest;
using model::TestStandard;

// Tests by the keys that they have, as bits.
enum Kind : unsigned { linear = 1, rotary = 2, diagonal = 4, circle = 8, rotating = 16, ball = 32 };

Kind kind_of(const MachineTest& test) {
  switch (test.standard) {
    case TestStandard::positioning:
      return test.is_rotary() ? rotary : linear;
    case TestStandard::diagonals:
      return diagonal;
    case TestStandard::circles:
      return circle;
    case TestStandard::error_motion:
      return rotating;
    case TestStandard::ball:
      break;
  }
  return ball;
}

// Keys of the tests of other standards.
void refuse_other_keys(config::Reader& table, const MachineTest& test) {
  struct Key {
    const char* name;
    unsigned of;
  };
  constexpr unsigned kRotary = rotary | rotating | ball;
  constexpr std::array<Key, 22> kKeys = {{{"axis", linear | kRotary},
                                          {"from_mm", linear},
                                          {"to_mm", linear},
                                          {"targets_mm", linear},
                                          {"target_spread_mm", linear | diagonal},
                                          {"overrun_mm", linear | diagonal},
                                          {"from_deg", kRotary},
                                          {"to_deg", rotary | ball},
                                          {"targets_deg", rotary},
                                          {"target_spread_deg", rotary},
                                          {"overrun_deg", kRotary},
                                          {"target_count", linear | rotary | diagonal},
                                          {"runs", linear | rotary | diagonal},
                                          {"from", diagonal},
                                          {"to", diagonal},
                                          {"plane", circle},
                                          {"radius_mm", circle},
                                          {"reading_count", circle | rotating | ball},
                                          {"revolutions", rotating},
                                          {"distance_mm", rotating},
                                          {"feed", linear | diagonal | circle},
                                          {"rotary_feed", kRotary}}};
  const Kind kind = kind_of(test);
  const std::string_view axis = kind == linear   ? " of a linear axis"
                                : kind == rotary ? " of a rotary axis"
                                                 : "";
  for (const Key& key : kKeys) {
    if ((key.of & kind) != 0 || table.raw(key.name) == nullptr) continue;
    table.fault(key.name,
                fmt::format("has no effect on a test after {}{}",
                            model::kTestStandards[static_cast<std::size_t>(test.standard)], axis));
  }
}

// "X, Y, Z" of the axes that a test may move.
std::string axes_text(const JointLayout& layout, bool with_linear) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis) || (is_linear(axis) && !with_linear)) continue;
    out += fmt::format("{}{}", out.empty() ? "" : ", ", letter(axis));
  }
  return out;
}

void read_axis(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const std::size_t before = table.faults();
  const std::string text = table.text("axis");
  if (table.faults() > before) return;
  const bool takes_linear = out.standard == TestStandard::positioning;
  const auto axis = text.size() == 1 ? axis_of(text.front()) : std::nullopt;
  const bool is_known = layout != JointLayout{};
  if (!axis || (is_linear(*axis) && !takes_linear) || (is_known && !layout.joint_of(*axis))) {
    const std::string axes = axes_text(layout, takes_linear);
    table.fault(
        "axis",
        fmt::format("must be {} axis of the machine{}", takes_linear ? "an" : "a rotary",
                    axes.empty() ? ", which has none" : fmt::format(", which has {}", axes)));
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
    const Axis axis = axis_of(name).value();
    if (layout != JointLayout{} && !layout.joint_of(axis)) {
      table.fault("plane", fmt::format("the machine has no axis {}", name));
      return;
    }
    out.axes.push_back(axis);
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

// Corners have no rotary axes.
JointLayout linear_part(JointLayout layout) {
  for (std::size_t joint = kLinearJoints; joint < layout.axis.size(); ++joint) {
    layout.axis[joint].reset();
  }
  return layout;
}

// from = { X_mm, Y_mm, Z_mm }, to = { ... }: opposite corners of a box or a face.
// @return length of the diagonals, m; 0 if there are faults
double read_corners(config::Reader& table, const JointLayout& machine, MachineTest& out) {
  const std::size_t before = table.faults();
  const JointLayout layout = linear_part(machine);
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

// Keys of targets along a line, or of positions of a rotary axis.
struct TargetKeys {
  const char *targets, *from, *to, *spread, *overrun;
  config::Quantity quantity;
  double overrun_usual;  // m, rad
};
constexpr TargetKeys kLinearKeys = {"targets_mm", "from_mm",       "to_mm", "target_spread_mm",
                                    "overrun_mm", config::kLength, 1.0 * mm};
constexpr TargetKeys kRotaryKeys = {"targets_deg", "from_deg",     "to_deg", "target_spread_deg",
                                    "overrun_deg", config::kAngle, 1.0 * deg};
const TargetKeys& keys_of(const MachineTest& test) {
  return test.is_rotary() ? kRotaryKeys : kLinearKeys;
}

// Equally spaced targets and their spread.
// @param before  faults before the ends were read: without them there are no targets
std::vector<double> read_spaced(config::Reader& table, const MachineTest& test, double from,
                                double to, std::size_t before) {
  const int usual = test.is_rotary() ? standards::usual_rotary_target_count(to - from)
                                     : standards::usual_target_count(to - from);
  const int count = static_cast<int>(
      table.integer_or("target_count", usual, {config::at_least(2), config::at_most(1000)}));
  const TargetKeys& keys = keys_of(test);
  const double spread = table.real_or(keys.spread, 0.0, keys.quantity, {config::at_least(0.0)});
  if (table.faults() > before || !(from < to)) return {};
  if (!(2.0 * spread < (to - from) / (count - 1))) {
    table.fault(keys.spread, "must be below half of the distance between targets");
    return {};
  }
  constexpr std::uint64_t kSeed = 230;  // targets do not depend on the errors of the device
  return standards::spaced_targets(from, to, count, spread, kSeed);
}

// targets_mm = [...], or from_mm, to_mm with their number and spread; of a rotary axis in deg.
std::vector<double> read_targets(config::Reader& table, const MachineTest& test) {
  const std::size_t before = table.faults();
  const TargetKeys& keys = keys_of(test);
  if (table.has(keys.targets)) {
    for (const char* const key : {keys.from, keys.to, "target_count", keys.spread}) {
      if (table.raw(key) != nullptr) {
        table.fault(key, fmt::format("has no effect with {}", keys.targets));
      }
    }
    std::vector<double> targets = table.reals(keys.targets, keys.quantity);
    if (table.faults() == before &&
        (targets.size() < 2 ||
         !std::is_sorted(targets.begin(), targets.end(), std::less_equal<>()))) {
      table.fault(keys.targets, "must be two targets or more in rising order");
    }
    return targets;
  }
  const double from = table.real(keys.from, keys.quantity);
  const double to = table.real(keys.to, keys.quantity);
  if (table.faults() == before && !(from < to)) {
    table.fault(keys.to, fmt::format("must be above {}", keys.from));
  }
  return read_spaced(table, test, from, to, before);
}

void read_overrun(config::Reader& table, MachineTest& out, double usual) {
  const TargetKeys& keys = keys_of(out);
  out.cycle.overrun = table.real_or(keys.overrun, usual, keys.quantity, {config::above(0.0)});
}

void read_cycle(config::Reader& table, MachineTest& out) {
  out.cycle.runs =
      static_cast<int>(table.integer_or("runs", 5, {config::at_least(1), config::at_most(100)}));
  read_overrun(table, out, keys_of(out).overrun_usual);
}

void read_reading_count(config::Reader& table, MachineTest& out) {
  out.readings = static_cast<int>(
      table.integer_or("reading_count", 720, {config::at_least(72), config::at_most(36000)}));
}

void read_circle(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  read_plane(table, layout, out);
  out.radius = table.real("radius_mm", config::kLength, {config::above(0.0)});
  read_reading_count(table, out);
}

constexpr double kRunUp = 10.0 * deg;  // before and after the readings

void read_revolutions(config::Reader& table, MachineTest& out) {
  out.begin = table.real_or("from_deg", 0.0, config::kAngle);
  out.revolutions = static_cast<int>(
      table.integer_or("revolutions", 1, {config::at_least(1), config::at_most(1000)}));
  out.end = out.begin + 2.0 * std::numbers::pi * out.revolutions;
  if (table.has("distance_mm")) {
    out.distance = table.real("distance_mm", config::kLength, {config::above(0.0)});
  }
  read_overrun(table, out, kRunUp);
  read_reading_count(table, out);
}

void read_turn(config::Reader& table, MachineTest& out) {
  const std::size_t before = table.faults();
  out.begin = table.real("from_deg", config::kAngle);
  out.end = table.real("to_deg", config::kAngle);
  if (table.faults() == before && !(out.begin < out.end)) {
    table.fault("to_deg", "must be above from_deg");
  }
  read_overrun(table, out, kRunUp);
  read_reading_count(table, out);
}

}  // namespace

bool read_test_motion(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const bool names_axis =
      out.standard != TestStandard::diagonals && out.standard != TestStandard::circles;
  if (names_axis) read_axis(table, layout, out);
  if (names_axis && out.axes.empty()) return false;
  refuse_other_keys(table, out);
  switch (out.standard) {
    case TestStandard::positioning:
      out.cycle.targets = read_targets(table, out);
      read_cycle(table, out);
      break;
    case TestStandard::diagonals: {
      const std::size_t before = table.faults();
      const double length = read_corners(table, layout, out);
      out.cycle.targets = read_spaced(table, out, 0.0, length, before);
      read_cycle(table, out);
      break;
    }
    case TestStandard::circles:
      read_circle(table, layout, out);
      break;
    case TestStandard::error_motion:
      read_revolutions(table, out);
      break;
    case TestStandard::ball:
      read_turn(table, out);
      break;
  }
  out.feed = out.is_rotary()
                 ? table.real("rotary_feed", config::kAngularVelocity, {config::above(0.0)})
                 : table.real("feed", config::kVelocity, {config::above(0.0)});
  return true;
}

void place_lines(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  if (out.standard == TestStandard::positioning && !out.axes.empty()) {
    const int axis = index_of(out.axes.front());
    model::TestLine line{out.name, out.at, AxisWords::Zero()};
    line.from[axis] = 0.0;
    line.direction[axis] = 1.0;
    out.lines = {line};
  } else if (out.standard == TestStandard::diagonals && !out.axes.empty()) {
    config::Reader from = table.table("from"), to = table.table("to");
    const JointLayout linear = linear_part(layout);
    AxisWords begin = out.at, end = out.at;
    for (const Axis axis : out.axes) {
      begin[index_of(axis)] = read_words(from, linear)[index_of(axis)];
      end[index_of(axis)] = read_words(to, linear)[index_of(axis)];
    }
    out.lines = model::diagonals(begin, end, out.axes);
  }
}

}  // namespace servomill::sim::input
