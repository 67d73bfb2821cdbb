/// The example of strategies/README.md, "Act in the position loop".
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry integral_entry();

}  // namespace servomill::strategies
