#include "sim/recordings/delimited_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <utility>

#include "sim/system/utf8.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

Field field_at(std::string_view line, std::size_t first, std::size_t end) {
  const std::string_view raw = line.substr(first, end - first);
  std::string_view text = trimmed(raw);
  std::size_t at = first + (text.empty() ? 0 : static_cast<std::size_t>(text.data() - raw.data()));
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
    ++at;
  }
  return {text, static_cast<int>(at) + 1};
}

std::vector<Field> split_at_blanks(std::string_view line) {
  std::vector<Field> out;
  std::size_t end = 0;
  for (;;) {
    const std::size_t first = line.find_first_not_of(kBlanks, end);
    if (first == std::string_view::npos) return out;
    end = std::min(line.find_first_of(kBlanks, first), line.size());
    out.push_back(field_at(line, first, end));
  }
}

bool is_word(std::string_view text, std::string_view word) {
  return text.size() == word.size() &&
         std::equal(text.begin(), text.end(), word.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

struct NamedUnit {
  std::string_view suffix, symbol;
};

const NamedUnit* suffix_of(std::string_view name) {
  static constexpr std::array<NamedUnit, 17> kSuffixes = {{{"_mm", "mm"},
                                                           {"_um", "um"},
                                                           {"_nm", "nm"},
                                                           {"_inch", "inch"},
                                                           {"_deg", "deg"},
                                                           {"_rad", "rad"},
                                                           {"_urad", "urad"},
                                                           {"_m_per_s", "m/s"},
                                                           {"_mm_per_s", "mm/s"},
                                                           {"_m_per_min", "m/min"},
                                                           {"_mm_per_min", "mm/min"},
                                                           {"_deg_per_s", "deg/s"},
                                                           {"_rad_per_s", "rad/s"},
                                                           {"_m_per_s2", "m/s^2"},
                                                           {"_mm_per_s2", "mm/s^2"},
                                                           {"_deg_per_s2", "deg/s^2"},
                                                           {"_rad_per_s2", "rad/s^2"}}};
  const auto* const found =
      std::find_if(kSuffixes.begin(), kSuffixes.end(), [&](const NamedUnit& one) {
        return name.size() > one.suffix.size() && name.ends_with(one.suffix);
      });
  return found == kSuffixes.end() ? nullptr : found;
}

}  // namespace

std::vector<TextLine> text_lines(std::string_view text) {
  std::vector<TextLine> out;
  int number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!trimmed(line).empty()) out.push_back({line, number});
    begin = end + 1;
  }
  return out;
}

std::vector<Field> split_fields(std::string_view line, char separator) {
  if (separator == ' ') return split_at_blanks(line);
  std::vector<Field> out;
  std::size_t first = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (quoted || line[i] != separator) continue;
    out.push_back(field_at(line, first, i));
    first = i + 1;
  }
  out.push_back(field_at(line, first, line.size()));
  return out;
}

std::optional<double> parse_number(std::string_view text, char decimal) {
  constexpr std::size_t kLongest = 64;  // characters; longer ones are no numbers of a control
  if (text.empty() || is_word(text, "nan")) return std::numeric_limits<double>::quiet_NaN();
  if (text.size() > kLongest || text.starts_with("+-")) return {};
  if (text.front() == '+') text.remove_prefix(1);
  std::array<char, kLongest> copy{};
  std::copy(text.begin(), text.end(), copy.begin());
  const char* const end = copy.data() + text.size();
  if (decimal != '.') {
    if (text.find('.') != std::string_view::npos) return {};
    std::replace(copy.data(), copy.data() + text.size(), decimal, '.');
  }
  double value = 0.0;
  const auto [stopped, fault] = std::from_chars(copy.data(), end, value);
  if (stopped != end || stopped == copy.data()) return {};
  // the library leaves what is out of range untouched: too small or too large
  if (fault == std::errc::result_out_of_range) {
    const bool small = std::string_view(copy.data(), text.size()).find("e-") != std::string::npos ||
                       std::string_view(copy.data(), text.size()).find("E-") != std::string::npos;
    return small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (fault != std::errc()) return {};
  return value;
}

std::string as_utf8(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = system::utf8_length(text.substr(at));
    if (length == 0) break;
    at += length;
  }
  if (at == text.size()) return std::string(text);
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (code >> 6));
      out += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return out;
}

Heading parse_heading(std::string_view text) {
  const std::string all = as_utf8(trimmed(text));
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    if (all.empty() || all.back() != close) continue;
    const auto at = all.rfind(open);
    if (at == std::string::npos || at == 0) continue;
    return {std::string(trimmed(std::string_view(all).substr(0, at))),
            std::string(trimmed(std::string_view(all).substr(at + 1, all.size() - at - 2)))};
  }
  return {all, ""};
}

Heading heading_with_suffix(Heading heading) {
  if (!heading.unit.empty()) return heading;
  const auto end = heading.name.rfind('_');
  if (end != std::string::npos && is_time_name(heading.name.substr(0, end)) &&
      seconds_of(heading.name.substr(end + 1))) {
    return {heading.name.substr(0, end), heading.name.substr(end + 1)};
  }
  if (const NamedUnit* unit = suffix_of(heading.name)) heading.unit = unit->symbol;
  return heading;
}

std::string_view name_without_unit(std::string_view name) {
  if (const NamedUnit* unit = suffix_of(name)) name.remove_suffix(unit->suffix.size());
  return name;
}

bool is_time_name(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames = {"time", "t", "zeit", "timestamp",
                                                      "elapsed time"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](std::string_view one) { return is_word(name, one); });
}

std::optional<double> seconds_of(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 10> kUnits = {{{"s", 1.0},
                                                                           {"sec", 1.0},
                                                                           {"ms", 1e-3},
                                                                           {"us", 1e-6},
                                                                           {"\u00B5s", 1e-6},
                                                                           {"\u03BCs", 1e-6},
                                                                           {"ns", 1e-9},
                                                                           {"nsec", 1e-9},
                                                                           {"min", 60.0},
                                                                           {"h", 3600.0}}};
  for (const auto& [name, seconds] : kUnits) {
    if (unit == name) return seconds;
  }
  return {};
}

}  // namespace servomill::sim::recordings
