/// Report of a positioning test (ISO 230-2) or of a diagonal (ISO 230-6).
#pragma once

#include "sim/standards/positioning_readings.h"
#include "sim/standards/report.h"

namespace servomill::sim::standards {

Report positioning_report(const PositioningFile& file);

}  // namespace servomill::sim::standards
