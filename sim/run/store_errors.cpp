#include "sim/run/store_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/geometry/error_function.h"
#include "plant/geometry/error_model.h"
#include "plant/geometry/grid_function.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"

namespace servomill::sim::run {
namespace {

constexpr std::size_t kMinSamples = 1601, kMaxSamples = 8001;
constexpr double kApart = 0.5 * mm;    // places on a longer axis; of a rotary one mm read as deg
constexpr double kEndless = 500 * mm;  // of a linear axis without travel, to either side of zero
constexpr double kTurn = 360 * deg;

// Places at which the errors of an axis are written.
struct Range {
  double lower = 0.0, upper = 0.0;  // m, rad
};

// All of the travel, one turn of a rotary axis: that around zero where it has it.
Range range_of(const model::NcSettings& nc, int joint) {
  const double lower = nc.lower[joint], upper = nc.upper[joint];
  if (joint >= kLinearJoints) {
    const double begin = std::clamp(-0.5 * kTurn, lower, std::max(lower, upper - kTurn));
    return {begin, std::min(upper, begin + kTurn)};
  }
  if (std::isfinite(lower)) return {lower, std::isfinite(upper) ? upper : lower + 2.0 * kEndless};
  return {std::isfinite(upper) ? upper - 2.0 * kEndless : -kEndless,
          std::isfinite(upper) ? upper : kEndless};
}

std::vector<double> places_in(const Range& range, bool linear) {
  const double apart = linear ? kApart : kApart / mm * deg;
  const auto steps = static_cast<std::size_t>(
      std::ceil(std::min((range.upper - range.lower) / apart, double{kMaxSamples})));
  std::vector<double> out(std::clamp(steps + 1, kMinSamples, kMaxSamples));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(out.size() - 1);
    out[i] = range.lower + (range.upper - range.lower) * share;
  }
  return out;
}

// Points of the errors over several axes, which are part of the error over its own axis, too.
void write_grids(records::Hdf5Group& group, const std::string& error, const plant::ErrorFunction& f,
                 const char* unit) {
  for (std::size_t n = 0; n < f.grids.size(); ++n) {
    const plant::GridPoints& points = f.grids[n].points();
    records::Hdf5Group grid = group.group(fmt::format("{}_grid_{}", error, n + 1));
    records::make_nexus_group(grid, "NXcollection");
    std::string axes;
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
      const Axis axis = points.axes[k];
      const bool linear = is_linear(axis);
      axes += letter(axis);
      std::vector<double> at = points.at[k];
      for (double& q : at) q /= linear ? mm : deg;
      grid.list(std::string(1, letter(axis)), at,
                {linear ? "mm" : "deg", fmt::format("positions of {}", letter(axis))});
    }
    std::vector<double> values = points.error;
    for (double& e : values) e /= um;
    const bool is_cubic = points.interpolation == plant::GridInterpolation::cubic;
    grid.list("value", values,
              {unit, fmt::format("{} at each combination of {}, the last the fastest; {}", error,
                                 axes, is_cubic ? "cubic spline" : "linear in between")});
  }
}

void write_components(records::Hdf5Group& root, const std::string& path,
                      const plant::ErrorModel& model, Axis axis, const model::NcSettings& nc,
                      int joint) {
  const auto& components = model.components[static_cast<std::size_t>(index_of(axis))];
  if (std::all_of(components.begin(), components.end(),
                  [](const auto& f) { return f.is_zero(); })) {
    return;
  }
  records::Hdf5Group group = root.group(fmt::format("{}/{}", path, letter(axis)));
  const std::vector<double> q = places_in(range_of(nc, joint), is_linear(axis));
  const auto over_axis = [&](auto value_at, double unit) {
    std::vector<double> values(q.size());
    std::transform(q.begin(), q.end(), values.begin(),
                   [&](double at) { return value_at(at) / unit; });
    return values;
  };
  group.list("position", over_axis([](double at) { return at; }, is_linear(axis) ? mm : deg),
             {is_linear(axis) ? "mm" : "deg", fmt::format("position of {}", letter(axis))});
  records::Plot plot{"", {"position"}, {}};
  const char* plotted_unit = "";
  for (const Axis direction : kAllAxes) {
    const auto& f = components[static_cast<std::size_t>(index_of(direction))];
    if (f.is_zero()) continue;
    const char* unit = is_linear(direction) ? "um" : "urad";  // um is urad
    const std::string error = plant::to_string({direction, axis, false});
    const auto value = [&](double at) {  // the other axes at 0
      AxisWords words = AxisWords::Zero();
      words[index_of(axis)] = at;
      return f.value(at, words);
    };
    group.list(error, over_axis(value, um), {unit, "error " + error}, "position");
    if (plot.signal.empty()) {
      plot.signal = error;
      plotted_unit = unit;
    } else if (plotted_unit == unit) {
      plot.others.push_back(error);
    }
    write_grids(group, error, f, unit);
    if (f.reversals.empty()) continue;
    group.list(error + "_width", over_axis([&](double at) { return f.width(at); }, um),
               {unit, error + " travelling up minus travelling down"}, "position");
  }
  records::make_nexus_data(group, plot);
}

void write_locations(records::Hdf5Group& root, const std::string& path,
                     const plant::ErrorModel& model) {
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, true};
      const double value = model.location(name);
      if (value == 0.0) continue;
      records::Hdf5Group locations = root.group(path + "/locations");
      records::make_nexus_group(locations, "NXcollection");
      locations.scalar(plant::to_string(name), value / um,
                       {is_linear(direction) ? "um" : "urad", "location error " + to_string(name)});
    }
  }
}

}  // namespace

void write_errors(records::Hdf5Group& root, const model::Scenario& scenario) {
  const JointLayout& layout = scenario.machine.chain.layout;
  for (const auto& [name, model] : scenario.errors) {
    const std::string path = "errors/" + name;
    records::Hdf5Group all = root.group("errors"), of_model = root.group(path);
    records::make_nexus_group(all, "NXcollection");
    records::make_nexus_group(of_model, "NXcollection");
    for (const Axis axis : kAllAxes) {
      const auto joint = layout.joint_of(axis);
      if (joint) write_components(root, path, model, axis, scenario.machine.nc, *joint);
    }
    write_locations(root, path, model);
  }
}

}  // namespace servomill::sim::run
