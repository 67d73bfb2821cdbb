/// Arrays of doubles as measurements of Sinumerik controls hold them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::recordings {

/// Big-endian doubles of a text in base 85: five digits for four bytes, the most significant first,
/// "." for four bytes of zeros; blanks and line ends in between. The digits are 0-9, a-z, A-Z and
/// !#$`()*+-/:;=?@[]^_{|}~ in this order.
/// @param why  set if the text is none: nothing is returned
std::vector<double> base85_doubles(std::string_view text, std::string& why);

}  // namespace servomill::sim::recordings
