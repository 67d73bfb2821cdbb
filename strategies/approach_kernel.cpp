#include "strategies/approach_kernel.h"

#include "plant/vocabulary/pack.h"

namespace servomill::strategies {
namespace {

using Number = Pack<SERVOMILL_ARCH>;

Number limited(const Number& value, const Number& most) {
  const Number above = select(value < -most, -most, value);
  return select(most < above, most, above);
}

void approach(const double* most, const double* most_change, std::size_t count,
              const LaneArray* wanted, LaneArray* values) {
  for (std::size_t j = 0; j < count; ++j) {
    const Number value(values[j]);
    put(values[j], value + limited(limited(Number(wanted[j]), Number(most[j])) - value,
                                   Number(most_change[j])));
  }
}

}  // namespace

template <>
Approach make_approach<SERVOMILL_LEVEL>() {
  return &approach;
}

}  // namespace servomill::strategies
