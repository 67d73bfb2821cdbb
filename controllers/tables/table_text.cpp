#include "controllers/tables/table_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace servomill::controllers {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t end = text.find(separator);
    out.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return out;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines = split(text, '\n');
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (const std::string_view word : split(line, ' ')) {
    if (!word.empty()) out.push_back(word);
  }
  return out;
}

std::vector<std::string_view> cells_of(std::string_view line) { return split(line, ','); }

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

std::optional<double> number_in(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_whole = error == std::errc() && end == word.data() + word.size();
  return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

double number_at(std::string_view word, const std::string& file, int line) {
  if (const auto value = number_in(word)) return *value;
  refuse(file, line, fmt::format("'{}' must be a number", word));
}

int index_at(std::string_view word, const std::string& file, int line) {
  constexpr int kMax = 9999;
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_whole = error == std::errc() && end == word.data() + word.size();
  if (is_whole && value >= 0 && value <= kMax) return value;
  refuse(file, line, fmt::format("'{}' must be a number from 0 to {}", word, kMax));
}

void refuse(const std::string& file, int line, std::string message) {
  throw InputError({file, line, 0}, std::move(message));
}

const TableText& file_of(std::span<const TableText> files, std::string_view name,
                         const std::string& from, int line) {
  for (const TableText& file : files) {
    if (file.name == name) return file;
  }
  refuse(from, line, fmt::format("file {} does not exist", name));
}

void check_points(const ControlTable& table, std::size_t max_points) {
  if (table.points.size() < 2) {
    refuse(table.file, 0, fmt::format("{} points; must be >= 2", table.points.size()));
  }
  if (table.points.size() > max_points) {
    refuse(table.file, table.points[max_points].line,
           fmt::format("{} points; the control accepts {}", table.points.size(), max_points));
  }
  for (std::size_t i = 1; i < table.points.size(); ++i) {
    if (table.points[i].position > table.points[i - 1].position) continue;
    refuse(table.file, table.points[i].line, "the positions must increase");
  }
}

}  // namespace servomill::controllers
