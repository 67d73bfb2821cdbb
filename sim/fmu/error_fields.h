/// The fields of geometric errors by key, as AxisFields has those of an axis.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "plant/geometry/error_function.h"
#include "plant/vocabulary/input_error.h"
#include "sim/fmu/constants_text.h"

namespace servomill::sim::fmu {

template <class Visit>
class ErrorFields {
 public:
  explicit ErrorFields(Visit& visit) : visit_(visit) {}

  /// Everything but grids and reversals.
  void function(const std::string& name, plant::ErrorFunction& f) {
    list(name + ".polynomial", f.polynomial);
    each(name + ".harmonics", f.harmonics, [&](const std::string& one, plant::Harmonic& wave) {
      visit_(one + ".amplitude", wave.amplitude);
      visit_(one + ".period", wave.period);
      visit_(one + ".phase", wave.phase);
    });
    each(name + ".tables", f.tables, [&](const std::string& one, plant::LinearTable& table) {
      list(one + ".s", table.s);
      list(one + ".error", table.error);
    });
  }

  void grids(const std::string& name, plant::ErrorFunction& f) {
    std::vector<plant::GridPoints> all;
    for (const plant::GridFunction& grid : f.grids) all.push_back(grid.points());
    each(name, all, [&](const std::string& one, plant::GridPoints& points) {
      axes(one + ".axes", points.axes);
      each(one + ".at", points.at,
           [&](const std::string& axis, std::vector<double>& at) { list(axis, at); });
      list(one + ".error", points.error);
      visit_(one + ".interpolation", points.interpolation);
      std::vector<std::uint8_t> repeats(points.repeats.begin(), points.repeats.end());
      each(one + ".repeats", repeats, visit_);
      points.repeats.assign(repeats.begin(), repeats.end());
    });
    f.grids.clear();
    for (plant::GridPoints& points : all) {
      if (const auto fault = plant::grid_fault(points, kSI)) {
        throw InputError({name}, fmt::format("'{}' {}", name, *fault));
      }
      f.grids.emplace_back(std::move(points));
    }
  }

 private:
  static constexpr std::array<double, kAxisWords> kSI = {1, 1, 1, 1, 1, 1};

  // Their letters.
  void axes(const std::string& name, std::vector<Axis>& axes) {
    std::string letters;
    for (const Axis axis : axes) letters += letter(axis);
    visit_(name, letters);
    axes.clear();
    for (const char one : letters) {
      const auto axis = axis_of(one);
      if (!axis) throw InputError({name}, fmt::format("'{}' is no axis", one));
      axes.push_back(*axis);
    }
  }

  void list(const std::string& name, std::vector<double>& values) { each(name, values, visit_); }

  template <class T, class Each>
  void each(const std::string& name, std::vector<T>& values, Each&& visit) {
    Count size{values.size()};
    visit_(name, size);
    values.resize(size.value);
    for (std::size_t n = 0; n < values.size(); ++n)
      visit(name + "." + std::to_string(n), values[n]);
  }

  Visit& visit_;
};

}  // namespace servomill::sim::fmu
