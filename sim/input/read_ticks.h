/// Reads periods and delays, which are whole multiples of the base period.
#pragma once

#include <string_view>

#include "sim/config/reader.h"
#include "sim/model/schedule.h"

namespace servomill::sim::input {

/// A time of a key that ends with _us or _ms.
/// @param fallback     s, where the key is absent
/// @param base_period  s, of the machine
/// @param least        allowed; returned where the time is at fault, but at least 1
Tick read_ticks(config::Reader& table, std::string_view key, double fallback, double base_period,
                Tick least);

}  // namespace servomill::sim::input
