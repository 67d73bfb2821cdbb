#include "sim/tables/unknown_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::tables {
namespace {

using plant::ErrorName;

// Squarenesses of XY, XZ and YZ, as turns of either axis.
constexpr std::array<std::array<ErrorName, 2>, 3> kSquarenesses = {{
    {{{Axis::C, Axis::Y, true}, {Axis::C, Axis::X, true}}},
    {{{Axis::B, Axis::Z, true}, {Axis::B, Axis::X, true}}},
    {{{Axis::A, Axis::Z, true}, {Axis::A, Axis::Y, true}}},
}};

std::string list(const std::vector<ErrorName>& names) {
  std::vector<std::string> out;
  for (const ErrorName& name : names) out.push_back(to_string(name));
  return fmt::format("{}", fmt::join(out, ", "));
}

// Meaningful component errors over the position of an axis.
std::vector<ErrorName> components_of(const JointLayout& layout, Axis axis) {
  std::vector<ErrorName> out;
  for (const Axis direction : kAllAxes) {
    const ErrorName name{direction, axis, false};
    if (!plant::why_meaningless(name, layout)) out.push_back(name);
  }
  return out;
}

bool all_unknown(const TableExport& e, const std::vector<ErrorName>& names) {
  const std::vector<ErrorName>& unknown = e.request.unknown;
  return std::all_of(names.begin(), names.end(), [&](const ErrorName& name) {
    return std::find(unknown.begin(), unknown.end(), name) != unknown.end();
  });
}

}  // namespace

std::vector<ErrorName> unknown_errors(const plant::ErrorModel& errors,
                                      const model::UncertainErrors& identified,
                                      const JointLayout& layout) {
  const auto is_identified = [&](const ErrorName& name) {
    return std::any_of(identified.parts.begin(), identified.parts.end(), [&](const auto& number) {
      return std::any_of(number.begin(), number.end(),
                         [&](const model::UncertainPart& part) { return part.name == name; });
    });
  };
  std::vector<ErrorName> out;
  for (const auto& [usual, other] : kSquarenesses) {
    const bool is_there = layout.joint_of(usual.axis) && layout.joint_of(other.axis);
    const bool is_known = is_identified(usual) || is_identified(other) ||
                          errors.location(usual) != 0.0 || errors.location(other) != 0.0;
    if (is_there && !is_known) out.push_back(usual);
  }
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    for (const ErrorName& name : components_of(layout, axis)) {
      const bool is_zero = errors.component(name) == plant::ErrorFunction();
      if (is_zero && !is_identified(name)) out.push_back(name);
    }
  }
  return out;
}

void refuse_unknown(const TableExport& e) {
  const JointLayout& layout = e.source.chain.layout;
  constexpr std::string_view kWhy =
      "not determined by the calibration ([identified]), unknown is "
      "not 0";
  if (e.rules().skew) {
    if (all_unknown(e, {kSquarenesses[0][0], kSquarenesses[1][0], kSquarenesses[2][0]})) {
      throw InputError(
          {},
          fmt::format("no squareness for a skew correction: {} are {}",
                      list({kSquarenesses[0][0], kSquarenesses[1][0], kSquarenesses[2][0]}), kWhy));
    }
    const std::vector<ErrorName> heights = {{Axis::Z, Axis::X, false}, {Axis::Z, Axis::Y, false}};
    if (e.request.mesh && all_unknown(e, heights)) {
      throw InputError({}, fmt::format("no heights for a bed mesh: {} are {}; leave out --bed-mesh "
                                       "or measure these straightnesses",
                                       list(heights), kWhy));
    }
    return;
  }
  for (const TableLine& line : e.lines) {
    const Axis axis = *layout.axis[static_cast<std::size_t>(line.joint)];
    const std::vector<ErrorName> names = components_of(layout, axis);
    if (!line.wanted || !all_unknown(e, names)) continue;
    throw InputError({}, fmt::format("no errors for a table over {}: {} are {}; choose the other "
                                     "axes with --axis",
                                     letter(axis), list(names), kWhy));
  }
}

std::vector<std::string> with_unknown(std::vector<std::string> lines, const TableExport& e) {
  if (!e.request.unknown.empty()) {
    lines.push_back("note: not determined by the calibration, taken as 0: " +
                    list(e.request.unknown));
  }
  return lines;
}

}  // namespace servomill::sim::tables
