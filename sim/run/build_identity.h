/// Identity of the program that computed a result.
#pragma once

#include <string>
#include <string_view>

namespace servomill::sim::run {

/// "0.1.0+3f9a2c41d07b": version and a checksum of all sources that results depend on (rooms plant,
/// controllers, strategies, sim). Two builds that share it give the same bits on the same
/// instructions; two that do not may differ, even where the version stayed.
std::string_view build_identity();

/// The same for results: "0.1.0+3f9a2c41d07b with springback 1.2 (995dc9bbdf1939fa)" where plug-ins
/// are loaded (strategies/plugin_file.h).
std::string result_identity();

}  // namespace servomill::sim::run
