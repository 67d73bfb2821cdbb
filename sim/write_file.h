/// Text files, written whole.
#pragma once

#include <string>
#include <string_view>

namespace servomill::sim {

/// Writes a text where no file is, or in place of one with `force`; the file is there with all of
/// its text or not at all.
/// @throws InputError if it exists, SystemError if it cannot be written
void write_text_file(const std::string& path, std::string_view text, bool force);

}  // namespace servomill::sim
