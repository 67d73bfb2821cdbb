/// The example of strategies/README.md, "Add a feedback strategy".
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry smoothed_entry();

}  // namespace servomill::strategies
