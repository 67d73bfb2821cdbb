/// SystemError by the name that the rooms of sim use.
#pragma once

#include "plant/vocabulary/system_error.h"

namespace servomill::sim::system {

using servomill::SystemError;

}  // namespace servomill::sim::system
