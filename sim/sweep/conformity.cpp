#include "sim/sweep/conformity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/model/scenario.h"
#include "sim/sweep/statistics.h"

namespace servomill::sim::sweep {
namespace {

constexpr double kWanted = 0.95;  // probability
constexpr double kWilson = 1.959963984540054;

}  // namespace

std::string_view name_of(Statement statement) {
  switch (statement) {
    case Statement::conforms:
      return "conforms";
    case Statement::does_not_conform:
      return "does not";
    case Statement::neither:
      return "unproven";
  }
  return "";
}

Conformity conformity_of(std::span<const double> values, const model::Tolerance& tolerance) {
  const Distribution distribution = distribution_of(values);
  Conformity out;
  out.guard_band = kGuardFactor * distribution.deviation;
  out.probability = kNoNumber;
  if (distribution.count == 0) return out;
  const auto n = static_cast<double>(distribution.count);
  const auto k = static_cast<double>(std::count_if(
      values.begin(), values.end(), [&](double value) { return tolerance.contains(value); }));
  const double z2 = kWilson * kWilson;
  const double half = kWilson * std::sqrt(k * (n - k) / n + z2 / 4.0);
  out.probability = k / n;
  out.low = (k + z2 / 2.0 - half) / (n + z2);
  out.high = (k + z2 / 2.0 + half) / (n + z2);
  if (out.low >= kWanted) out.statement = Statement::conforms;
  if (out.high <= 1.0 - kWanted) out.statement = Statement::does_not_conform;
  return out;
}

}  // namespace servomill::sim::sweep
