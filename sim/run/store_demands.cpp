#include "sim/run/store_demands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/records/nexus.h"

namespace servomill::sim::run {
namespace {

using evaluation::AxisDemand;
using evaluation::DemandedValue;

constexpr std::array<const char*, 3> kNames = {"velocity", "acceleration", "jerk"};
constexpr std::array<const char*, 3> kPer = {"/s", "/s2", "/s3"};

// Groups of axes with the same units.
struct Kind {
  const char* name;
  bool is_linear;
  const char *unit, *offset_unit;
  double length, offset;  // SI of these units
};
constexpr std::array<Kind, 2> kKinds = {
    {{"linear", true, "mm", "um", mm, um}, {"rotary", false, "deg", "urad", deg, urad}}};

void write_kind(records::Hdf5Group group, const Kind& kind, const std::vector<AxisDemand>& axes) {
  records::make_nexus_group(group, "NXcollection");
  std::string letters;
  for (const AxisDemand& axis : axes) letters += axis.axis;
  group.labels("axis", letters, "axis");
  group.attribute("axes", letters);
  const auto of_axes = [&](auto value) {
    std::vector<double> values;
    for (const AxisDemand& axis : axes) values.push_back(value(axis));
    return values;
  };
  const auto list = [&](const std::string& name, const records::Meaning& meaning, auto value) {
    group.list(name, of_axes(value), meaning, "axis");
  };
  list("offset", {kind.offset_unit, "largest offset that all strategies add to the path"},
       [&](const AxisDemand& axis) { return axis.offset / kind.offset; });
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const std::string name = kNames[k], unit = std::string(kind.unit) + kPer[k];
    const auto of = [&](auto value) {
      return [k, value](const AxisDemand& axis) { return value(axis.motion[k]); };
    };
    list(name, {unit, "largest " + name + " of path and offset together"},
         of([&](const DemandedValue& one) { return one.size / kind.length; }));
    list(name + "_limit", {unit, "limit of the axis"},
         of([&](const DemandedValue& one) { return one.limit / kind.length; }));
    list(name + "_time", {"s", "time of the largest " + name},
         of([](const DemandedValue& one) { return one.time; }));
    const auto lines = of([](const DemandedValue& one) { return static_cast<double>(one.line); });
    group.counts(name + "_line", of_axes(lines), {"1", "line of the program there"}, "axis");
  }
}

void read_kind(const records::InputFile& file, const std::string& group, const Kind& kind,
               std::vector<AxisDemand>& out) {
  const std::string letters = file.text(group, "axes");
  const std::size_t axes = letters.size();
  const auto list = [&](const std::string& name) {
    std::vector<double> values = file.values(group + "/" + name);
    if (values.size() == axes) return values;
    throw InputError({file.path()}, fmt::format("'{}/{}' has {} values in place of {}", group, name,
                                                values.size(), axes));
  };
  const std::size_t first = out.size();
  const std::vector<double> offset = list("offset");
  for (std::size_t n = 0; n < axes; ++n) {
    out.push_back({letters[n], kind.is_linear, offset[n] * kind.offset, {}});
  }
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const std::string name = kNames[k];
    const std::vector<double> size = list(name), limit = list(name + "_limit"),
                              time = list(name + "_time"), line = list(name + "_line");
    for (std::size_t n = 0; n < axes; ++n) {
      out[first + n].motion[k] = {size[n] * kind.length, limit[n] * kind.length, time[n],
                                  static_cast<int>(line[n])};
    }
  }
}

}  // namespace

void write_demands(records::Hdf5Group group, const std::vector<AxisDemand>& demands) {
  records::make_nexus_group(group, "NXcollection");
  for (const Kind& kind : kKinds) {
    std::vector<AxisDemand> axes;
    std::copy_if(demands.begin(), demands.end(), std::back_inserter(axes),
                 [&](const AxisDemand& axis) { return axis.is_linear == kind.is_linear; });
    if (!axes.empty()) write_kind(group.group(kind.name), kind, axes);
  }
}

std::vector<AxisDemand> read_demands(const records::InputFile& file, const std::string& group) {
  std::vector<AxisDemand> out;
  for (const Kind& kind : kKinds) {
    const std::string path = group + "/" + kind.name;
    if (file.has(path)) read_kind(file, path, kind, out);
  }
  return out;
}

}  // namespace servomill::sim::run
