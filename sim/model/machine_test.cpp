#include "sim/model/machine_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::model {
namespace {

using Eigen::Vector3d;

// Point of a circle of the test in the plane of its axes.
Vector3d on_circle(const MachineTest& test, double angle) {
  Vector3d out = test.at.head<3>();
  out[static_cast<Eigen::Index>(index_of(test.axes[0]))] += test.radius * std::cos(angle);
  out[static_cast<Eigen::Index>(index_of(test.axes[1]))] += test.radius * std::sin(angle);
  return out;
}

std::vector<TestStop> stops_of_circles(const MachineTest& test) {
  const auto measured = [](const Vector3d& position, int direction) {
    return TestStop{position, 0, {0.0, direction, 0, 0}};
  };
  return {measured(test.at.head<3>(), 1), measured(on_circle(test, -kFeedIn), 1),
          measured(on_circle(test, kFeedIn), 1), measured(on_circle(test, -kFeedIn), -1)};
}

std::string words_of(const std::vector<Axis>& axes, const Vector3d& position) {
  std::string out;
  for (const Axis axis : axes) {
    out += fmt::format(" {}{:.9f}", letter(axis),
                       position[static_cast<Eigen::Index>(index_of(axis))] / mm);
  }
  return out;
}

void append_approach(const MachineTest& test, const JointLayout& layout, std::string& out) {
  std::string words;
  for (const Axis axis : kAllAxes) {
    if (std::count(test.axes.begin(), test.axes.end(), axis) > 0 || !layout.joint_of(axis)) {
      continue;
    }
    const double unit = is_linear(axis) ? mm : deg;
    words += fmt::format(" {}{:.9f}", letter(axis), test.at[index_of(axis)] / unit);
  }
  if (!words.empty()) out += fmt::format("G0{}\n", words);
}

// The nose after a test with a tool: that is unloaded, its length would stay compensated.
void append_tool(int tool, int tool_before, std::string& out) {
  if (tool > 0) {
    out += fmt::format("T{0} M6\nG43 H{0}\n", tool);
  } else if (tool_before > 0) {
    out += "G49\nT0 M6\n";
  }
}

void append_lines(const MachineTest& test, std::string& out) {
  std::size_t line = test.lines.size();
  for (const TestStop& stop : stops(test)) {
    const bool is_first = stop.line != line;  // of its line
    line = stop.line;
    out += fmt::format("{}{}\n", is_first ? "G0" : "G1", words_of(test.axes, stop.position));
    if (stop.is_measured()) out += fmt::format("G4 P{:.6f}\n", test.dwell);
    if (is_first) out += fmt::format("F{:.6f}\n", test.feed / mm_per_min);
  }
}

// The turn that is measured, and the arcs of feed-in and feed-out.
void append_arc(const MachineTest& test, const TestStop& begin, const TestStop& end,
                std::string& out) {
  constexpr std::array kOffset = {'I', 'J', 'K'};
  const Vector3d to_centre = test.at.head<3>() - begin.position;
  out += fmt::format("{}{}", end.on_line.direction > 0 ? "G3" : "G2",
                     words_of(test.axes, end.position));
  for (const Axis axis : test.axes) {
    const auto k = static_cast<Eigen::Index>(index_of(axis));
    out += fmt::format(" {}{:.9f}", kOffset[static_cast<std::size_t>(k)], to_centre[k] / mm);
  }
  out += " P2\n";
}

void append_circles(const MachineTest& test, std::string& out) {
  const std::string dwell = fmt::format("G4 P{:.6f}\n", test.dwell);
  const std::vector<TestStop> all = stops(test);
  const int normal = 3 - index_of(test.axes[0]) - index_of(test.axes[1]);
  constexpr int kLastPlane = 19;  // G19: YZ
  out += fmt::format("G0{}\n{}", words_of(test.axes, all[0].position), dwell);
  out += fmt::format("F{:.6f}\nG{}\n", test.feed / mm_per_min, kLastPlane - normal);
  out += fmt::format("G1{}\n{}", words_of(test.axes, all[1].position), dwell);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    append_arc(test, all[k], all[k + 1], out);
    out += dwell;
  }
  out += "G17\n";
}

void append_test(const MachineTest& test, const JointLayout& layout, std::string& out) {
  append_approach(test, layout, out);
  if (test.standard == TestStandard::circles) {
    append_circles(test, out);
  } else {
    append_lines(test, out);
  }
}

}  // namespace

std::vector<TestStop> stops(const MachineTest& test) {
  if (test.standard == TestStandard::circles) return stops_of_circles(test);
  std::vector<TestStop> out;
  for (std::size_t line = 0; line < test.lines.size(); ++line) {
    const TestLine& along = test.lines[line];
    for (const standards::CycleStop& stop : standards::stops(test.cycle)) {
      out.push_back({along.from + stop.position * along.direction, line, stop});
    }
  }
  return out;
}

std::vector<TestLine> diagonals(const Vector3d& from, const Vector3d& to,
                                const std::vector<Axis>& axes) {
  std::vector<TestLine> out;
  // none, or one but not two axes downwards: others are these in the other direction
  for (std::size_t down = 0; down <= (axes.size() == 3 ? 3U : 1U); ++down) {
    Vector3d begin = from, end = from;
    std::string name;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(index_of(axes[k]));
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
    append_tool(test->tool, tool, out);
    append_test(*test, layout, out);
    tool = test->tool;
  }
  return out + "M2\n";
}

}  // namespace servomill::sim::model
