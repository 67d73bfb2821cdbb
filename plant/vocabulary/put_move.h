/// Receivers of moves that come one after the other.
#pragma once

#include <functional>

#include "plant/vocabulary/move.h"

namespace servomill {

/// Takes one move after the other; each is valid during the call.
using PutMove = std::function<void(const Move&)>;

}  // namespace servomill
