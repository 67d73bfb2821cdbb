/// Quantisation of a position by a measuring step.
#pragma once

#include "plant/vocabulary/numbers.h"

namespace servomill::plant {

/// The next whole multiple of `step`; step 0: the position itself.
/// @param per_step  1 / step, any number with step 0
template <class Number>
Number quantised(const Number& step, const Number& per_step, const Number& position) {
  return select(step > Number(0.0), step * nearbyint(position * per_step), position);
}

}  // namespace servomill::plant
