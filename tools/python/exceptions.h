/// Exceptions of the program as those of the Python package.
#pragma once

namespace servomill::python {

/// InputError becomes servomill.InputError with all faults, SystemError servomill.SystemFailed,
/// an interrupt KeyboardInterrupt.
void register_exceptions();

}  // namespace servomill::python
