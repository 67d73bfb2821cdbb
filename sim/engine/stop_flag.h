/// How a run is ended from outside.
#pragma once

#include <atomic>

namespace servomill::sim::engine {

/// Set from outside to end a run early; a case that sees it stops as "interrupted".
using StopFlag = std::atomic<bool>;

}  // namespace servomill::sim::engine
