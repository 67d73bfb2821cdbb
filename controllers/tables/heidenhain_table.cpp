#include "controllers/tables/heidenhain_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMaxPoints = 256;
constexpr std::string_view kBacklash = "BACKLASH";

Axis axis_at(std::string_view word, const std::string& file, int line) {
  if (word.size() == 1) {
    if (const auto axis = axis_of(word.front())) return *axis;
  }
  refuse(file, line, fmt::format("'{}' is not an axis", word));
}

// The tables of one listing, one for each column.
void read_listing(const TableText& file, Axis base, std::vector<ControlTable>& out) {
  const auto lines = lines_of(file.text);
  const auto columns = lines.empty() ? std::vector<std::string_view>{} : words_of(lines[0]);
  if (columns.size() < 2 || columns[0] != "AXISPOS") {
    refuse(file.name, 1, "must begin with AXISPOS and the columns of axes");
  }
  const auto backlash = static_cast<std::size_t>(
      std::find(columns.begin(), columns.end(), kBacklash) - columns.begin());
  bool holds_base = false;
  for (std::size_t n = 1; n < columns.size(); ++n) {
    if (n == backlash) continue;
    const Axis axis = axis_at(columns[n], file.name, 1);
    const bool is_own = axis == base && backlash < columns.size();
    holds_base |= is_own;
    ControlTable table{.file = file.name, .base_axis = base, .compensated_axis = axis};
    table.is_one_turn = !is_linear(base);
    const double place_unit = is_linear(base) ? mm : deg, unit = is_linear(axis) ? mm : deg;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const int number = static_cast<int>(i) + 1;
      const auto words = words_of(lines[i]);
      if (words.size() != columns.size()) {
        refuse(file.name, number,
               fmt::format("{} values for {} columns", words.size(), columns.size()));
      }
      const double error = number_at(words[n], file.name, number);
      const double error_down = is_own ? number_at(words[backlash], file.name, number) : error;
      table.points.push_back({number_at(words[0], file.name, number) * place_unit, -error * unit,
                              -error_down * unit, number});
    }
    check_points(table, kMaxPoints);
    out.push_back(std::move(table));
  }
  if (backlash < columns.size() && !holds_base) {
    refuse(file.name, 1, fmt::format("BACKLASH without a column {}", letter(base)));
  }
}

}  // namespace

std::vector<ControlTable> read_heidenhain_tables(std::span<const TableText> files) {
  std::vector<ControlTable> out;
  for (const TableText& cma : files) {
    if (!std::string_view(cma.name).ends_with(".CMA.txt")) continue;
    const auto lines = lines_of(cma.text);
    const auto columns = lines.empty() ? std::vector<std::string_view>{} : words_of(lines[0]);
    if (columns.empty() || columns[0] != "ACTIVE") refuse(cma.name, 1, "must begin with ACTIVE");
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const int number = static_cast<int>(i) + 1;
      const auto names = words_of(lines[i]);
      if (names.empty() || names[0] != "*") continue;
      if (names.size() != columns.size()) {
        refuse(cma.name, number,
               fmt::format("{} names for {} columns", names.size(), columns.size()));
      }
      for (std::size_t n = 1; n < names.size(); ++n) {
        const Axis base = axis_at(columns[n], cma.name, 1);
        read_listing(file_of(files, std::string(names[n]) + ".txt", cma.name, number), base, out);
      }
    }
  }
  return out;
}

}  // namespace servomill::controllers
