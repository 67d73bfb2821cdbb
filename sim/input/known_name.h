/// Names in a document that refer to something named elsewhere: a case, an error model, a probe.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Tells if `name`, the value of `key`, is one of `names`; otherwise notes a fault with the nearest
/// name or, where none is near, with all of them.
/// @param what  the kind of thing, for the message: "error model"
bool must_be_known(config::Reader& table, std::string_view key, const std::string& name,
                   std::string_view what, std::span<const std::string> names);

}  // namespace servomill::sim::input
