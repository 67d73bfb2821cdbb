/// Work tried in a process of its own first, for libraries that files can crash or hang.
#pragma once

#include <functional>
#include <string>

namespace servomill::sim::system {

/// Runs `work` in a copy of this process, whose processor time is limited and whose output is
/// dropped. What it throws counts as done: it will throw again where it is needed.
/// @param seconds  of processor time, >= 1
/// @return empty if it came to an end; else how it did not: "does not come to an end within 10 s",
///         "crashes (signal 11)"
std::string try_in_process(const std::function<void()>& work, int seconds);

}  // namespace servomill::sim::system
