#include "controllers/gcode/tool_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

struct Reader {
  std::string_view line;
  const std::string& file;
  int number;
  std::size_t at = 0;

  [[noreturn]] void fail(std::size_t where, std::string message) const {
    throw InputError({file, number, static_cast<int>(where) + 1}, std::move(message));
  }
  void skip_blanks() {
    while (at < line.size() && is_blank(line[at])) ++at;
  }
  double value(std::size_t start) {
    skip_blanks();
    if (at < line.size() && line[at] == '+') ++at;
    double x = 0.0;
    const auto [end, status] =
        std::from_chars(line.data() + at, line.data() + line.size(), x, std::chars_format::fixed);
    if (status != std::errc() || !std::isfinite(x)) {
      fail(start, fmt::format("{} must be followed by a number", line[start]));
    }
    at = static_cast<std::size_t>(end - line.data());
    return x;
  }
  int integer(std::size_t start) {
    const double x = value(start);
    if (x != std::floor(x) || x < 0.0 || x > 1e6) {
      fail(start, fmt::format("{}{}; must be an integer >= 0", line[start], x));
    }
    return static_cast<int>(x);
  }
};

void read_word(Reader& reader, ToolEntry& tool, bool& has_number) {
  const std::size_t start = reader.at++;
  const char c = reader.line[start];
  const char letter = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  if (const auto axis = axis_of(letter)) {
    tool.offset[index_of(*axis)] = reader.value(start) * (is_linear(*axis) ? mm : deg);
    return;
  }
  switch (letter) {
    case 'T':
      tool.number = reader.integer(start);
      has_number = true;
      return;
    case 'P':
      tool.pocket = reader.integer(start);
      return;
    case 'D':
      tool.diameter = reader.value(start) * mm;
      return;
    case 'I':
    case 'J':
      reader.value(start);
      return;
    case 'Q':
      tool.orientation = reader.integer(start);
      return;
    default:
      reader.fail(start, fmt::format("unknown word '{}'; a tool has T P X Y Z A B C D I J Q", c));
  }
}

void read_tool(Reader reader, ToolTable& table) {
  ToolEntry tool;
  bool has_number = false;
  for (reader.skip_blanks(); reader.at < reader.line.size(); reader.skip_blanks()) {
    read_word(reader, tool, has_number);
  }
  if (!has_number) reader.fail(0, "tool without a number (T word)");
  if (table.find(tool.number) != nullptr) {
    reader.fail(0, fmt::format("second tool with number T{}", tool.number));
  }
  table.add(tool);
}

}  // namespace

ToolTable ToolTable::parse(std::string_view text, const std::string& file) {
  ToolTable table;
  std::vector<Fault> faults;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    line = line.substr(0, line.find(';'));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    try {
      read_tool({line, file, number}, table);
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return table;
}

void ToolTable::add(const ToolEntry& tool) {
  if (!tools_.emplace(tool.number, tool).second) {
    throw InputError({}, fmt::format("second tool with number T{}", tool.number));
  }
}

const ToolEntry* ToolTable::find(int number) const {
  const auto found = tools_.find(number);
  return found == tools_.end() ? nullptr : &found->second;
}

}  // namespace servomill::controllers
