#include "sim/evaluation/day_quantities.h"

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/model/quantity_spec.h"

namespace servomill::sim::evaluation {
namespace {

template <double DayFigures::*kFigure>
QuantityValue of_day(const model::QuantitySpec&, CaseEvaluation& one, const CaseData*) {
  constexpr double kUnit = kFigure == &DayFigures::measuring ? 60.0 : um;
  if (!one.data.day) return {.note = "no day with parts"};
  return {(*one.data.day).*kFigure / kUnit};
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "thermal_deviation_rms",
     .unit = "um",
     .help = "displacement of the tip by heat along the path of all parts of the day, rms",
     .needs_day = true,
     .evaluate = of_day<&DayFigures::rms>},
    {.name = "thermal_deviation_max",
     .unit = "um",
     .help = "displacement of the tip by heat along the path of all parts of the day, maximum",
     .needs_day = true,
     .evaluate = of_day<&DayFigures::largest>},
    {.name = "measuring_time",
     .unit = "min",
     .help = "total time of the datums taken between the parts of the day",
     .needs_day = true,
     .evaluate = of_day<&DayFigures::measuring>},
};

}  // namespace

std::span<const QuantityEntry> day_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
