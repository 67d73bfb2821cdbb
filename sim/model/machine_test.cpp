#include "sim/model/machine_test.h"

#include <fmt/format.h>

#include "plant/vocabulary/units.h"

namespace servomill::sim::model {
namespace {

void append_approach(const MachineTest& test, const JointLayout& layout, std::string& out) {
  std::string words;
  for (const Axis axis : kAllAxes) {
    if (axis == test.axis || !layout.joint_of(axis)) continue;
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

void append_test(const MachineTest& test, const JointLayout& layout, std::string& out) {
  append_approach(test, layout, out);
  const char* motion = "G0";
  for (const standards::CycleStop& stop : standards::stops(test.cycle)) {
    out += fmt::format("{} {}{:.9f}\n", motion, letter(test.axis), stop.position / mm);
    if (stop.direction != 0) out += fmt::format("G4 P{:.6f}\n", test.dwell);
    if (motion[1] == '0') out += fmt::format("F{:.6f}\n", test.feed / mm_per_min);
    motion = "G1";
  }
}

}  // namespace

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
