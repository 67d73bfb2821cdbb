/// Scenarios that have every section and every form of every key, for the list of keys. They are
/// read, never run.
#pragma once

#include <array>
#include <string_view>

namespace servomill::sim::input {

/// Complete documents. Together they make the readers ask for every key; defaults that follow from
/// other keys differ between them.
std::array<std::string_view, 4> key_specimens();

/// The last of them: a machine with one axis.
std::string_view third_specimen();

/// The one with tests of a machine; in a source of its own.
std::string_view test_specimen();

/// Keys that only machine files have, in a table `machine`.
std::string_view identified_specimen();

}  // namespace servomill::sim::input
