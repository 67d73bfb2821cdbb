#include "tests/sim/evaluation/quantity_example.h"

#include <cmath>

#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/statistic.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

// Distance of the actual from the nominal tool centre point, seen along Z.
QuantityValue lateral_deviation(const model::QuantitySpec& spec, CaseEvaluation& one,
                                const CaseData*) {
  const records::Series& servo = *one.data.servo;
  const auto x = servo.column("tool_deviation", 'X'), y = servo.column("tool_deviation", 'Y');
  if (!x || !y) return {.note = "tool_deviation was not recorded"};
  Statistic statistic(spec.statistic);
  one.samples.rows(spec.sections).for_each([&](std::size_t row) {
    statistic.add(std::hypot(servo.at(row, *x), servo.at(row, *y)));
  });
  return {statistic.value()};
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "lateral_deviation",
     .unit = "um",
     .help = "distance of the actual from the nominal tool centre point in X and Y, at equal s",
     .has_statistic = true,
     .evaluate = lateral_deviation},
};

}  // namespace

std::span<const QuantityEntry> lateral_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
