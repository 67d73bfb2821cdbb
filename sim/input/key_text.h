/// The list of keys, printed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/input/key_list.h"

namespace servomill::sim::input {

/// "[record]" and one line a key: name, sentence, and in brackets type, unit, range, presence.
std::string as_text(std::span<const KeyEntry> keys);

/// A page: a heading and a table a section.
std::string as_markdown(std::span<const KeyEntry> keys);

/// A JSON object each with section, key, help, type, unit, range, presence and default; null
/// where there is none.
std::vector<std::string> keys_json(std::span<const KeyEntry> keys);

}  // namespace servomill::sim::input
