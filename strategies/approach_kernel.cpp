#include "strategies/approach_kernel.h"

#include "plant/vocabulary/pack.h"

namespace servomill::strategies {
namespace {

using Number = Pack<SERVOMILL_ARCH>;

Number within(const Number& value, const Number& least, const Number& most) {
  const Number above = select(value < least, least, value);
  return select(most < above, most, above);
}

void approach(const double* most, const double* most_change, std::size_t count,
              const LaneArray* wanted, LaneArray* values) {
  for (std::size_t j = 0; j < count; ++j) {
    const Number value(values[j]), limit(most[j]), change(most_change[j]);
    put(values[j],
        within(within(Number(wanted[j]), -limit, limit), value - change, value + change));
  }
}

}  // namespace

template <>
Approach make_approach<SERVOMILL_LEVEL>() {
  return &approach;
}

}  // namespace servomill::strategies
