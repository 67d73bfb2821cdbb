#include "sim/input/read_machine_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

using model::MachineTest;

constexpr double kMaxSeed = 9007199254740992.0;  // 2^53: whole numbers are exact up to there
constexpr std::array<std::string_view, 1> kStandards = {"iso230-2"};

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

void read_axis(config::Reader& table, const JointLayout& layout, MachineTest& out) {
  const std::size_t before = table.faults();
  const std::string text = table.text("axis");
  if (table.faults() > before) return;
  const auto axis = text.size() == 1 ? axis_of(text.front()) : std::nullopt;
  if (!axis || !is_linear(*axis)) {
    table.fault("axis", "must be X, Y or Z: tests of rotary axes are not simulated");
  } else if (layout != JointLayout{} && !layout.joint_of(*axis)) {
    table.fault("axis", fmt::format("the machine has no axis {}", text));
  } else {
    out.axis = *axis;
  }
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

void read_cycle(config::Reader& table, MachineTest& out) {
  out.cycle.targets = read_targets(table);
  out.cycle.runs =
      static_cast<int>(table.integer_or("runs", 5, {config::at_least(1), config::at_most(100)}));
  out.cycle.overrun = table.real_or("overrun_mm", 1.0 * mm, config::kLength, {config::above(0.0)});
  out.feed = table.real("feed", config::kVelocity, {config::above(0.0)});
  out.dwell = table.real_or("dwell_s", 1.0, config::kTime, {config::at_least(0.1)});
}

MachineTest read_test(config::Reader& table, const JointLayout& layout,
                      std::set<std::string>& names) {
  MachineTest out;
  out.name = read_name(table, names);
  table.choice("standard", kStandards);
  read_axis(table, layout, out);
  read_cycle(table, out);
  if (table.has("at")) {
    config::Reader words = table.table("at");
    out.at = read_words(words, layout);
    const std::string own = fmt::format("{}_mm", letter(out.axis));
    if (words.has(own)) words.fault(own, "is the axis under test");
  }
  out.tool =
      static_cast<int>(table.integer_or("tool", 0, {config::at_least(0), config::at_most(99999)}));
  out.seed = static_cast<std::uint64_t>(
      table.integer_or("seed", 1, {config::at_least(0), config::at_most(kMaxSeed)}));
  if (table.has("device")) {
    config::Reader device = table.table("device");
    out.device = standards::contributions_of(device, false);
  }
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

std::vector<Fault> faults_of_travel(const model::MachineTests& tests,
                                    const model::MachineSettings& machine,
                                    const AxisWords& work_offset) {
  std::vector<Fault> out;
  for (const auto& one : tests) {
    const MachineTest& test = *one;
    const auto joint = machine.chain.layout.joint_of(test.axis);
    if (!joint || test.cycle.targets.empty()) continue;
    const double offset = work_offset[index_of(test.axis)];
    const double from = test.cycle.targets.front() - test.cycle.overrun + offset;
    const double to = test.cycle.targets.back() + test.cycle.overrun + offset;
    const double lower = machine.nc.lower[*joint], upper = machine.nc.upper[*joint];
    if (from >= lower && to <= upper) continue;
    out.push_back(
        {test.place,
         fmt::format("test {} moves {} from {:g} to {:g} mm with its overrun, in machine "
                     "coordinates; the travel is {:g} to {:g} mm",
                     test.name, letter(test.axis), from / mm, to / mm, lower / mm, upper / mm)});
  }
  return out;
}

}  // namespace servomill::sim::input
