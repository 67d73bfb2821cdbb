#include "sim/model/machine_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::model {
namespace {

double axis_unit(Axis axis) { return is_linear(axis) ? mm : deg; }

// Point of a circle of the test in the plane of its axes.
AxisWords on_circle(const MachineTest& test, double angle) {
  AxisWords out = test.at;
  out[index_of(test.axes[0])] += test.radius * std::cos(angle);
  out[index_of(test.axes[1])] += test.radius * std::sin(angle);
  return out;
}

TestStop measured(const AxisWords& position, int direction) {
  return {position, 0, {0.0, direction, 0, 0}};
}

std::vector<TestStop> stops_of_circles(const MachineTest& test) {
  return {measured(test.at, 1), measured(on_circle(test, -kFeedIn), 1),
          measured(on_circle(test, kFeedIn), 1), measured(on_circle(test, -kFeedIn), -1)};
}

std::vector<TestStop> stops_of_rotation(const MachineTest& test) {
  AxisWords first = test.at, last = test.at;
  first[index_of(test.axes[0])] = test.begin - test.cycle.overrun;
  last[index_of(test.axes[0])] = test.end + test.cycle.overrun;
  std::vector<TestStop> out = {measured(first, 1), measured(last, 1)};
  if (test.standard == TestStandard::ball) out.push_back(measured(first, -1));
  return out;
}

std::string words_of(const std::vector<Axis>& axes, const AxisWords& position) {
  std::string out;
  for (const Axis axis : axes) {
    out += fmt::format(" {}{:.9f}", letter(axis), position[index_of(axis)] / axis_unit(axis));
  }
  return out;
}

// Axes of the machine that the test does not move.
std::vector<Axis> others_of(const MachineTest& test, const JointLayout& layout) {
  std::vector<Axis> out;
  for (const Axis axis : kAllAxes) {
    const bool moves = std::count(test.axes.begin(), test.axes.end(), axis) > 0;
    if (!moves && layout.joint_of(axis)) out.push_back(axis);
  }
  return out;
}

// Linear axes in mm/min, a rotary one in deg/min.
std::string feed_word(const MachineTest& test) {
  return fmt::format("F{:.6f}\n", test.feed / (axis_unit(test.axes.front()) / minute));
}

void append_approach(const MachineTest& test, const JointLayout& layout, std::string& out) {
  const std::string words = words_of(others_of(test, layout), test.at);
  if (!words.empty()) out += fmt::format("G0{}\n", words);
}

// The nose after a test with a tool: that is unloaded, its length would stay compensated.
void append_tool(int tool, int tool_before, bool follows, std::string& out) {
  if (tool > 0) {
    out += fmt::format("T{0} M6\n{1} H{0}\n", tool, follows ? "G43.4" : "G43");
  } else if (tool_before > 0) {
    out += "G49\nT0 M6\n";
  }
}

std::string dwell_block(const MachineTest& test) { return fmt::format("G4 P{:.6f}\n", test.dwell); }

void append_lines(const MachineTest& test, std::string& out) {
  std::size_t line = test.lines.size();
  for (const TestStop& stop : stops(test)) {
    const bool is_first = stop.line != line;  // of its line
    line = stop.line;
    out += fmt::format("{}{}\n", is_first ? "G0" : "G1", words_of(test.axes, stop.position));
    if (stop.is_measured()) out += dwell_block(test);
    if (is_first) out += feed_word(test);
  }
}

// The turn that is measured, and the arcs of feed-in and feed-out.
void append_arc(const MachineTest& test, const TestStop& begin, const TestStop& end,
                std::string& out) {
  constexpr std::array kOffset = {'I', 'J', 'K'};
  const AxisWords to_centre = test.at - begin.position;
  out += fmt::format("{}{}", end.on_line.direction > 0 ? "G3" : "G2",
                     words_of(test.axes, end.position));
  for (const Axis axis : test.axes) {
    const int k = index_of(axis);
    out += fmt::format(" {}{:.9f}", kOffset[static_cast<std::size_t>(k)], to_centre[k] / mm);
  }
  out += " P2\n";
}

void append_circles(const MachineTest& test, std::string& out) {
  const std::string dwell = dwell_block(test);
  const std::vector<TestStop> all = stops(test);
  const int normal = 3 - index_of(test.axes[0]) - index_of(test.axes[1]);
  constexpr int kLastPlane = 19;  // G19: YZ
  out += fmt::format("G0{}\n{}", words_of(test.axes, all[0].position), dwell);
  out += feed_word(test) + fmt::format("G{}\n", kLastPlane - normal);
  out += fmt::format("G1{}\n{}", words_of(test.axes, all[1].position), dwell);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    append_arc(test, all[k], all[k + 1], out);
    out += dwell;
  }
  out += "G17\n";
}

// The axis turns past its readings; of a ball, the linear axes follow under TCP control.
void append_rotation(const MachineTest& test, std::string& out) {
  const char* motion = "G0";
  out += feed_word(test);
  for (const TestStop& stop : stops(test)) {
    out += fmt::format("{}{}\n", motion, words_of(test.axes, stop.position)) + dwell_block(test);
    motion = "G1";
  }
  if (test.standard == TestStandard::ball) out += "G49\n";
}

void append_test(const MachineTest& test, const JointLayout& layout, std::string& out) {
  append_approach(test, layout, out);
  if (test.has_lines()) {
    append_lines(test, out);
  } else if (test.standard == TestStandard::circles) {
    append_circles(test, out);
  } else {
    append_rotation(test, out);
  }
}

}  // namespace

bool MachineTest::moves() const {
  if (has_lines()) return !lines.empty() && !cycle.targets.empty();
  return standard == TestStandard::circles ? axes.size() == 2 : axes.size() == 1;
}

double MachineTest::reading_spacing() const {
  if (standard == TestStandard::ball) return (end - begin) / std::max(readings - 1, 1);
  return 360.0 * deg / std::max(readings, 1);
}

std::vector<TestStop> stops(const MachineTest& test) {
  if (test.standard == TestStandard::circles) return stops_of_circles(test);
  if (!test.has_lines()) return stops_of_rotation(test);
  std::vector<TestStop> out;
  for (std::size_t line = 0; line < test.lines.size(); ++line) {
    const TestLine& along = test.lines[line];
    for (const standards::CycleStop& stop : standards::stops(test.cycle)) {
      out.push_back({along.from + stop.position * along.direction, line, stop});
    }
  }
  return out;
}

std::vector<TestLine> diagonals(const AxisWords& from, const AxisWords& to,
                                const std::vector<Axis>& axes) {
  std::vector<TestLine> out;
  // with no axis downwards, or one: the other corners begin the same diagonals, reversed
  for (std::size_t down = 0; down <= (axes.size() == 3 ? 3U : 1U); ++down) {
    AxisWords begin = from, end = from;
    std::string name;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const int i = index_of(axes[k]);
      const bool is_up = down != k + 1;
      begin[i] = is_up ? from[i] : to[i];
      end[i] = is_up ? to[i] : from[i];
      name += is_up ? 'P' : 'N';
    }
    out.push_back({std::move(name), begin, (end - begin).normalized()});
  }
  return out;
}

std::string program_of(const MachineTests& tests, const JointLayout& layout) {
  std::string out = "G21 G90 G17 G94 G54 G61\n";
  int tool = 0;
  for (const auto& test : tests) {
    out += fmt::format("(MSG, {})\n", test->name);
    append_tool(test->tool, tool, test->standard == TestStandard::ball, out);
    append_test(*test, layout, out);
    tool = test->tool;
  }
  return out + "M2\n";
}

}  // namespace servomill::sim::model
