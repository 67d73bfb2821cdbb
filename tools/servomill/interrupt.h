/// SIGINT (and SIGTERM) end a run cleanly instead of the process.
#pragma once

#include <atomic>

namespace servomill::tools {

/// Installs the handlers and returns the flag that they set. A second signal ends the process.
const std::atomic<bool>& stop_on_interrupt();

}  // namespace servomill::tools
