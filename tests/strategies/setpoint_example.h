/// The example of strategies/README.md, "Add a strategy".
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry setpoint_entry();

}  // namespace servomill::strategies
