#include "sim/tables/unknown_errors.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "sim/model/undetermined_errors.h"

namespace servomill::sim::tables {
namespace {

using model::kSquarenesses;
using plant::ErrorName;

bool all_unknown(const TableExport& e, const std::vector<ErrorName>& names) {
  const std::vector<ErrorName>& unknown = e.request.unknown;
  return std::all_of(names.begin(), names.end(), [&](const ErrorName& name) {
    return std::find(unknown.begin(), unknown.end(), name) != unknown.end();
  });
}

}  // namespace

void refuse_unknown(const TableExport& e) {
  const JointLayout& layout = e.source.chain.layout;
  constexpr std::string_view kWhy =
      "not determined by the calibration ([identified]), unknown is "
      "not 0";
  if (e.rules().skew) {
    if (all_unknown(e, {kSquarenesses[0][0], kSquarenesses[1][0], kSquarenesses[2][0]})) {
      throw InputError({}, fmt::format("no squareness for a skew correction: {} are {}",
                                       model::list_of({kSquarenesses[0][0], kSquarenesses[1][0],
                                                       kSquarenesses[2][0]}),
                                       kWhy));
    }
    const std::vector<ErrorName> heights = {{Axis::Z, Axis::X, false}, {Axis::Z, Axis::Y, false}};
    if (e.request.mesh && all_unknown(e, heights)) {
      throw InputError({}, fmt::format("no heights for a bed mesh: {} are {}; leave out --bed-mesh "
                                       "or measure these straightnesses",
                                       model::list_of(heights), kWhy));
    }
    return;
  }
  for (const TableLine& line : e.lines) {
    const Axis axis = *layout.axis[static_cast<std::size_t>(line.joint)];
    const std::vector<ErrorName> names = model::components_of(layout, axis);
    if (!line.wanted || !all_unknown(e, names)) continue;
    throw InputError({}, fmt::format("no errors for a table over {}: {} are {}; choose the other "
                                     "axes with --axis",
                                     letter(axis), model::list_of(names), kWhy));
  }
}

std::vector<std::string> with_unknown(std::vector<std::string> lines, const TableExport& e) {
  if (!e.request.unknown.empty()) {
    lines.push_back("note: not determined by the calibration, assumed to be 0: " +
                    model::list_of(e.request.unknown));
  }
  return lines;
}

}  // namespace servomill::sim::tables
