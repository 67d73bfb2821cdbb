/// Leaves everything as it is: the machine as it was built.
#pragma once

#include "strategies/registry.h"

namespace servomill::strategies {

Entry none_entry();

}  // namespace servomill::strategies
