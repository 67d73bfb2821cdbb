#include "sim/evaluation/demand_quantities.h"

#include <algorithm>
#include <cstddef>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

// Demand of the axis that a quantity names.
template <class Value>
QuantityValue of_axis(const model::QuantitySpec& spec, const CaseData& one, Value value) {
  const auto found = std::find_if(one.demands.begin(), one.demands.end(),
                                  [&](const AxisDemand& of) { return of.axis == spec.axis; });
  if (found == one.demands.end()) return {.note = "no such axis"};
  return {value(*found), one.finished ? "" : "until it stopped"};
}

QuantityValue axis_offset(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  return of_axis(spec, one.data, [](const AxisDemand& of) { return of.offset / um; });
}

template <std::size_t kOrder>
QuantityValue demand(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  return of_axis(spec, one.data,
                 [](const AxisDemand& of) { return 100.0 * of.motion[kOrder].share(); });
}

constexpr std::span<const std::string_view> kNoSignals = {};
constexpr std::string_view kLinearAxes = "XYZ", kAllAxes = "XYZABC";

constexpr QuantityEntry kQuantities[] = {
    {.name = "axis_offset",
     .unit = "um",
     .help = "largest offset that all strategies together add to the path of an axis, whole run",
     .axes = kLinearAxes,
     .evaluate = axis_offset,
     .is_of_program = true,
     .reads = kNoSignals,
     .reads_demands = true},
    {.name = "velocity_demand",
     .unit = "%",
     .help = "largest velocity of path and offset together, as a fraction of the limit of the "
             "axis, whole run",
     .axes = kAllAxes,
     .evaluate = demand<0>,
     .is_of_program = true,
     .reads = kNoSignals,
     .reads_demands = true},
    {.name = "acceleration_demand",
     .unit = "%",
     .help = "largest acceleration of path and offset together, as a fraction of the limit of the "
             "axis, whole run",
     .axes = kAllAxes,
     .evaluate = demand<1>,
     .is_of_program = true,
     .reads = kNoSignals,
     .reads_demands = true},
    {.name = "jerk_demand",
     .unit = "%",
     .help = "largest jerk of path and offset together, as a fraction of the limit of the axis, "
             "whole run",
     .axes = kAllAxes,
     .evaluate = demand<2>,
     .is_of_program = true,
     .reads = kNoSignals,
     .reads_demands = true},
};

}  // namespace

std::span<const QuantityEntry> demand_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
