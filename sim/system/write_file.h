/// Text files, written whole.
#pragma once

#include <string>
#include <string_view>

namespace servomill::sim::system {

/// @throws InputError if no text may be written there: to be asked before the work
void refuse_unwritable_text(const std::string& path, bool force);

/// Writes a text where no file is, or in place of one with `force`; the file is there with all of
/// its text or not at all.
/// @throws InputError if it may not be there (sim/system/output_name.h), SystemError if it cannot
/// be written
void write_text_file(const std::string& path, std::string_view text, bool force);

}  // namespace servomill::sim::system
