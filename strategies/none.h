/// Leaves everything as it is: the machine as it was built.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

Entry none_entry();

}  // namespace servomill::strategies
