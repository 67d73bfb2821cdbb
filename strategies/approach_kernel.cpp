#include "strategies/approach_kernel.h"

#include "plant/vocabulary/pack.h"

namespace servomill::strategies {
namespace {

using Number = Pack<SERVOMILL_ARCH>;

Number limited(const Number& value, const Number& most) {
  const Number above = select(value < -most, -most, value);
  return select(most < above, most, above);
}

void approach(double most, double most_change, std::size_t count, LaneArray* values, LaneArray* d) {
  for (std::size_t j = 0; j < count; ++j) {
    const Number value(values[j]);
    const Number next =
        value + limited(limited(Number(d[j]), Number(most)) - value, Number(most_change));
    put(values[j], next);
    put(d[j], next);
  }
}

}  // namespace

template <>
Approach make_approach<SERVOMILL_LEVEL>() {
  return &approach;
}

}  // namespace servomill::strategies
