#include "controllers/tables/skew_table.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "controllers/tables/table_text.h"

namespace servomill::controllers {
namespace {

// Letters of one line "M852 I.. J.. K..", of which each must be there once.
std::map<char, double> words_of_command(std::string_view command, std::string_view letters,
                                        std::string_view text, const TableText& file, int line) {
  const auto words = words_of(text);
  if (words.empty() || words.front() != command) {
    refuse(file.name, line, fmt::format("'{}' is not supported; only {}", text, command));
  }
  std::map<char, double> values;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const char letter = words[i].front();
    if (letters.find(letter) == std::string_view::npos) {
      refuse(file.name, line, fmt::format("'{}' is not supported in {}", words[i], command));
    }
    if (values.contains(letter)) refuse(file.name, line, fmt::format("{} appears twice", letter));
    values[letter] = number_at(words[i].substr(1), file.name, line);
  }
  for (const char letter : letters) {
    if (values.contains(letter)) continue;
    refuse(file.name, line, fmt::format("{} is missing in {}", letter, command));
  }
  return values;
}

SkewSetting read_marlin(const TableText& file, std::string_view text, int line) {
  const auto values = words_of_command("M852", "IJK", text, file, line);
  for (const auto& [letter, value] : values) {
    if (std::abs(value) <= 1.0) continue;
    refuse(file.name, line, fmt::format("{} = {:g}; must be from -1 to 1", letter, value));
  }
  return {SkewFirmware::marlin, values.at('I'), values.at('J'), values.at('K'), line};
}

SkewSetting read_reprapfirmware(const TableText& file, std::string_view text, int line) {
  const auto values = words_of_command("M556", "SXYZ", text, file, line);
  constexpr double kMin = 10.0;  // mm
  const double length = values.at('S');
  if (length < kMin) refuse(file.name, line, fmt::format("S = {:g}; must be >= 10", length));
  return {SkewFirmware::reprapfirmware, values.at('X') / length, values.at('Z') / length,
          values.at('Y') / length, line};
}

// Lines without comments, with their numbers.
struct Line {
  int number;
  std::string_view text;
};

std::vector<Line> lines_without(char comment, const TableText& file) {
  std::vector<Line> out;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const std::string_view text = trimmed(line.substr(0, line.find(comment)));
    if (!text.empty()) out.push_back({number, text});
  }
  return out;
}

SkewSetting read_command(const TableText& file, SkewFirmware firmware) {
  const auto lines = lines_without(';', file);
  if (lines.empty()) refuse(file.name, 0, "contains no skew setting");
  if (lines.size() > 1)
    refuse(file.name, lines[1].number, "a second command; only one is supported");
  const auto& [number, text] = lines.front();
  return firmware == SkewFirmware::marlin ? read_marlin(file, text, number)
                                          : read_reprapfirmware(file, text, number);
}

SkewSetting read_klipper(const TableText& file) {
  std::map<std::string, double, std::less<>> values;
  int profile = 0, switched_on = 0;
  for (const auto& [number, text] : lines_without('#', file)) {
    const std::size_t equals = text.find('=');
    if (text == "[skew_correction]") {
      switched_on = number;
    } else if (text.starts_with("[skew_correction ") && text.back() == ']') {
      if (profile != 0) refuse(file.name, number, "a second profile; only one is supported");
      profile = number;
    } else if (equals != std::string_view::npos && profile != 0) {
      const std::string key(trimmed(text.substr(0, equals)));
      if (values.contains(key)) refuse(file.name, number, fmt::format("{} appears twice", key));
      if (key != "xy_skew" && key != "xz_skew" && key != "yz_skew") {
        refuse(file.name, number, fmt::format("'{}' is not supported", key));
      }
      values[key] = number_at(trimmed(text.substr(equals + 1)), file.name, number);
    } else {
      refuse(file.name, number, fmt::format("'{}' is not supported", text));
    }
  }
  if (switched_on == 0) refuse(file.name, 0, "[skew_correction] is missing");
  if (profile == 0) refuse(file.name, 0, "contains no profile [skew_correction NAME]");
  for (const char* key : {"xy_skew", "xz_skew", "yz_skew"}) {
    if (!values.contains(key)) refuse(file.name, profile, fmt::format("{} is missing", key));
  }
  return {SkewFirmware::klipper, values["xy_skew"], values["xz_skew"], values["yz_skew"], profile};
}

}  // namespace

Eigen::Vector3d SkewSetting::commanded(const Eigen::Vector3d& p) const {
  if (firmware == SkewFirmware::reprapfirmware) {
    return {p.x() + (xy * p.y() + xz * p.z()), p.y() + yz * p.z(), p.z()};
  }
  return {p.x() - p.y() * xy - p.z() * (xz - (xy * yz)), p.y() - p.z() * yz, p.z()};
}

SkewSetting read_skew_table(const TableText& file, SkewFirmware firmware) {
  return firmware == SkewFirmware::klipper ? read_klipper(file) : read_command(file, firmware);
}

}  // namespace servomill::controllers
