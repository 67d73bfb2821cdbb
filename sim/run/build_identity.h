/// Identity of the program that computed a result.
#pragma once

#include <string_view>

namespace servomill::sim {

/// "0.1.0+3f9a2c41d07b": version and a checksum of all sources that results depend on (rooms plant,
/// controllers, strategies, sim). Two builds that share it give the same bits on the same
/// instructions; two that do not may differ, even where the version stayed.
std::string_view build_identity();

}  // namespace servomill::sim
