#include "sim/input/read_machine_test.h"

#include <fmt/format.h>

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_test_motion.h"

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

// Contributions of a laser that do not change the readings of a test.
std::vector<const char*> without_effect(const MachineTest& test) {
  std::vector<const char*> out;
  const bool has_beam = test.has_lines() && !test.is_rotary();
  if (!has_beam) {
    out = {"scale_uncertainty_um_per_m",    "misalignment_mrad", "coefficient_per_K",
           "coefficient_uncertainty_per_K", "temperature_degC",  "temperature_uncertainty_K"};
  }
  if (!test.has_lines()) out.push_back("target_uncertainty_um");
  const bool is_of_ranges =
      test.standard == TestStandard::error_motion || test.standard == TestStandard::ball;
  if (is_of_ranges) out.push_back("set_up_um");
  return out;
}

void read_device(config::Reader& table, MachineTest& out) {
  config::Reader device = table.table("device");
  const char* const what = out.standard == TestStandard::circles ? "a circle"
                           : out.has_lines()                     ? "positions of a rotary axis"
                                                                 : "sensors about a rotary axis";
  for (const char* const key : without_effect(out)) {
    if (device.raw(key) != nullptr) device.fault(key, fmt::format("has no effect on {}", what));
  }
  out.device = standards::contributions_of(device, out.has_lines() && out.is_rotary());
}

std::string word_key(Axis axis) {
  return fmt::format("{}_{}", letter(axis), is_linear(axis) ? "mm" : "deg");
}

// Axes whose position no default can stand for: the centre of circles, the place of a ball.
std::vector<Axis> placed_axes(const MachineTest& test, const JointLayout& layout) {
  if (test.has_lines()) return {};
  if (test.standard == TestStandard::circles) return test.axes;
  std::vector<Axis> out;
  for (const Axis axis : kAllAxes) {
    if (is_linear(axis) && layout.joint_of(axis)) out.push_back(axis);
  }
  return out;
}

void read_others(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const std::vector<Axis> placed = placed_axes(out, layout);
  if (placed.empty() && !table.has("at")) return;
  const std::size_t before = table.faults();
  config::Reader words = table.table("at");
  out.at = read_words(words, layout);
  if (table.faults() > before) return;
  std::string missing;
  for (const Axis axis : placed) {
    if (!words.has(word_key(axis))) {
      missing += fmt::format("{}{}", missing.empty() ? "" : ", ", word_key(axis));
    }
  }
  if (!missing.empty()) {
    words.fault(fmt::format("{} {} missing: {}", missing,
                            missing.find(',') == std::string::npos ? "is" : "are",
                            out.standard == TestStandard::circles ? "the centre of the circles"
                                                                  : "the position of the ball"));
  }
  if (out.standard == TestStandard::circles) return;  // their centre
  for (const Axis axis : out.axes) {
    if (words.has(word_key(axis))) words.fault(word_key(axis), "is the axis under test");
  }
}

// The ball in the spindle is a tool, whose length TCP control needs.
void read_measured_tool(config::Reader& table, MachineTest& out) {
  constexpr double kMaxTool = 99999.0;
  out.tool = static_cast<int>(
      out.standard == TestStandard::ball
          ? table.integer("tool", {config::at_least(1), config::at_most(kMaxTool)})
          : table.integer_or("tool", 0, {config::at_least(0), config::at_most(kMaxTool)}));
}

MachineTest read_test(config::Reader& table, const JointLayout& layout,
                      std::set<std::string>& names) {
  MachineTest out;
  out.name = read_name(table, names);
  const std::size_t before = table.faults();
  out.standard = static_cast<TestStandard>(table.choice("standard", model::kTestStandards));
  if (table.faults() > before || !read_test_motion(table, layout, out)) {
    table.skip_rest();
    return out;
  }
  out.dwell = table.real_or("dwell_s", 1.0, config::kTime, {config::at_least(0.1)});
  read_others(table, layout, out);
  place_lines(table, layout, out);
  read_measured_tool(table, out);
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

}  // namespace servomill::sim::input
