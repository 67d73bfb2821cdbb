#include "sim/input/controls/settings_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/config/option_value.h"

namespace servomill::sim::input {

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<SettingsLine> settings_lines(std::string_view text, const std::string& file) {
  std::vector<SettingsLine> out;
  int number = 1;
  for (std::size_t from = 0; from < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string_view line = text.substr(from, end - from);
    const std::string_view trimmed = without_blanks(line);
    const auto column = trimmed.empty() ? 0 : trimmed.data() - line.data();
    out.push_back({trimmed, {file, number, static_cast<int>(column) + 1}});
    from = end + 1;
  }
  return out;
}

std::optional<double> SettingsFaults::number(const Place& place, const std::string& key,
                                             std::string_view text) {
  const std::optional<double> value = config::plain_number(text);
  if (!value) add(place, fmt::format("{} = {}; must be a number", key, text));
  return value;
}

std::optional<double> SettingsFaults::positive(const Place& place, const std::string& key,
                                               std::string_view text) {
  const std::optional<double> value = number(place, key, text);
  if (!value || *value > 0.0) return value;
  add(place, fmt::format("{} = {}; must be > 0", key, text));
  return std::nullopt;
}

void SettingsFaults::finish() {
  if (!faults_.empty()) throw InputError(std::move(faults_));
}

}  // namespace servomill::sim::input
