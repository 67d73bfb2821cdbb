/// Tables of text as commands print them.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace servomill::sim::system {

/// Lines of equally many cells in columns, the first line underlined as their heading.
/// @param grouped  so many first columns are said once where they stay the same
/// @param right    columns that are aligned to the right
std::string text_table(std::vector<std::vector<std::string>> lines, std::size_t grouped,
                       const std::set<std::size_t>& right);

}  // namespace servomill::sim::system
