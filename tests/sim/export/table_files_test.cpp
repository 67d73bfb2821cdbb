// The texts themselves, to the letter.
#include <gtest/gtest.h>

#include "tests/sim/export/small_machine.h"

namespace servomill::sim {
namespace {}  // namespace
}  // namespace servomill::sim
