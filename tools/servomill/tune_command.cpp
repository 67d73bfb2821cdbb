#include "tools/servomill/axis_options.h"

namespace servomill::tools {

int tune_command(const Arguments&) { return kDone; }

}  // namespace servomill::tools
