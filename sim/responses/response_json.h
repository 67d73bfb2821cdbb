/// A measured frequency response as JSON.
#pragma once

#include <string>

#include "sim/responses/store_response.h"

namespace servomill::sim::responses {

/// One object: all lines with their uncertainty, resonances and antiresonances, the fit. null where
/// nothing was fitted, and for intervals of what was not fitted.
std::string to_json(const ResponseRecord& record);

}  // namespace servomill::sim::responses
