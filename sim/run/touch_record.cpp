#include "sim/run/touch_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"

namespace servomill::sim::run {
namespace {

std::vector<Axis> axes_of(const JointLayout& layout) {
  std::vector<Axis> out;
  for (const Axis axis : kAllAxes) {
    if (layout.joint_of(axis)) out.push_back(axis);
  }
  return out;
}

double in_unit(const preparation::Touch& touch, Axis axis, const JointLayout& layout) {
  return touch.latched[*layout.joint_of(axis)] / (is_linear(axis) ? mm : deg);
}

std::string column(Axis axis) {
  return fmt::format("{}_{}", letter(axis), is_linear(axis) ? "mm" : "deg");
}

// A name that a column can hold.
std::string name_of(const preparation::Touch& touch) {
  std::string name = touch.section.empty() ? "sphere" : touch.section;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ',' || c == ';' || c == '"'; }, ' ');
  return name;
}

}  // namespace

std::string touches_csv(std::span<const preparation::Touch> touches, const JointLayout& layout) {
  const std::vector<Axis> axes = axes_of(layout);
  std::string out;
  for (const Axis axis : axes) out += column(axis) + ",";
  out += "sphere\n";
  for (const preparation::Touch& touch : touches) {
    if (!touch.has_switched) {
      out += fmt::format("# line {}: the probe did not switch\n", touch.line);
      continue;
    }
    for (const Axis axis : axes) out += fmt::format("{:.6f},", in_unit(touch, axis, layout));
    out += name_of(touch) + "\n";
  }
  return out;
}

void write_touches(records::Hdf5Group group, std::span<const preparation::Touch> touches,
                   const JointLayout& layout) {
  std::vector<double> numbers(touches.size()), values(touches.size());
  std::iota(numbers.begin(), numbers.end(), 0.0);
  group.counts("touch", numbers, {"1", "number of the probing move"});
  const auto count = [&](const std::string& name, const std::string& about, auto value) {
    std::transform(touches.begin(), touches.end(), values.begin(), value);
    group.counts(name, values, {"1", about}, "touch");
  };
  using preparation::Touch;
  count("line", "line of the program", [](const Touch& touch) { return touch.line; });
  count("switched", "1: the probe switched, 0: it did not",
        [](const Touch& touch) { return touch.has_switched; });
  records::Plot plot{"", {"touch"}, {}};
  for (const Axis axis : axes_of(layout)) {
    const std::string name(1, letter(axis));
    std::transform(touches.begin(), touches.end(), values.begin(),
                   [&](const Touch& touch) { return in_unit(touch, axis, layout); });
    group.list(name, values,
               {is_linear(axis) ? "mm" : "deg", "position latched, as the NC shows it"}, "touch");
    if (plot.signal.empty()) {
      plot.signal = name;
    } else if (is_linear(axis)) {
      plot.others.push_back(name);
    }
  }
  records::make_nexus_data(group, plot);
  std::string sections;
  for (const Touch& touch : touches) sections += touch.section + "\n";
  group.attribute("sections", sections);
}

}  // namespace servomill::sim::run
