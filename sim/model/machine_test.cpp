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

void append_test(const MachineTest& test, const JointLayout& layout, std::string& out) {
  out += fmt::format("(MSG, {})\n", test.name);
  if (test.tool > 0) out += fmt::format("T{0} M6\nG43 H{0}\n", test.tool);
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
  for (const auto& test : tests) append_test(*test, layout, out);
  return out + "M2\n";
}

}  // namespace servomill::sim::model
