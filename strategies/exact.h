/// Straightens lines with rotary axes without a model: tip on the chord, tool axis on the great
/// circle, the inverse kinematics at every point, as many points as the tolerance needs.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry exact_entry();

}  // namespace servomill::strategies
