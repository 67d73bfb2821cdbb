/// Records that no axis can have made.
#pragma once

#include <optional>
#include <string>

#include "sim/identification/record.h"

namespace servomill::sim::identification {

/// Reason why an axis cannot have made this record: nothing moves, or the feedback moves against
/// the command or much farther; as the end of a sentence on the file, with the instant. Nothing for
/// a record that is possible.
std::optional<std::string> impossible(const Record& record);

}  // namespace servomill::sim::identification
