/// Lines and numbers of table files.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/tables/control_table.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

/// Lines without their ends; line n is at n - 1.
std::vector<std::string_view> lines_of(std::string_view text);

/// Words between blanks.
std::vector<std::string_view> words_of(std::string_view line);

/// Cells between commas.
std::vector<std::string_view> cells_of(std::string_view line);

std::string_view trimmed(std::string_view text);

/// The number that a whole word is, or nullopt.
std::optional<double> number_in(std::string_view word);

/// The same. @throws InputError at the line if it is none
double number_at(std::string_view word, const std::string& file, int line);

/// The whole number from 0 to 9999 that a word is. @throws InputError at the line if it is none
int index_at(std::string_view word, const std::string& file, int line);

[[noreturn]] void refuse(const std::string& file, int line, std::string message);

/// The file of a name. @throws InputError at `from`, which names it, if it is missing
const TableText& file_of(std::span<const TableText> files, std::string_view name,
                         const std::string& from, int line);

/// Refuses a table of fewer than two points, of more than a control takes, and positions that do
/// not increase.
void check_points(const ControlTable& table, std::size_t max_points);

}  // namespace servomill::controllers
