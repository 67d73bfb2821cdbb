/// Rows of numbers in text files of any separator and decimal sign.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::recordings {

/// A line of a text, without its end.
struct TextLine {
  std::string_view text;
  int number = 0;  // from 1
};

/// Lines that are not blank; a line ends with LF or CR LF.
std::vector<TextLine> text_lines(std::string_view text);

/// A field of a line, without blanks and quotes around it.
struct Field {
  std::string_view text;
  int column = 0;  // from 1
};

/// @param separator  ' ' stands for any number of blanks and tabs
std::vector<Field> split_fields(std::string_view line, char separator);

/// A number; NaN for an empty field and for "NaN"; nothing if it is none. An infinite or too large
/// one is an infinity.
std::optional<double> parse_number(std::string_view text, char decimal);

/// A text in UTF-8, of one in UTF-8 or else Latin-1.
std::string as_utf8(std::string_view text);

/// Name and unit of a heading such as "s actual X [mm]" or "current (A)".
struct Heading {
  std::string name, unit;
};
Heading parse_heading(std::string_view text);

/// The heading of a name that ends with its unit, as keys do: "time_s", "X_mm", "v_mm_per_s". Times
/// lose the ending, other channels keep their name. Units of one letter count for times alone:
/// "joint_A" may be an axis.
Heading heading_with_suffix(Heading heading);

/// The name without such an ending.
std::string_view name_without_unit(std::string_view name);

/// True for the names of a column or variable that holds the time: "time", "t", "Zeit", ...
bool is_time_name(std::string_view name);

/// Units of time in messages.
inline constexpr std::string_view kTimeUnits = "s, ms, us, ns, min and h";

/// Seconds of a unit of time ("ms", "us", "min"); nothing for another one.
std::optional<double> seconds_of(std::string_view unit);

}  // namespace servomill::sim::recordings
