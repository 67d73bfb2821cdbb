// config.g of RepRapFirmware 3 (documentation: docs.duet3d.com, "Gcodes").
//
// | code | meaning | unit |
// |---|---|---|
// | M203 X Y Z ... | largest speed of each axis | mm/min, deg/min |
// | M201 X Y Z ... | largest acceleration of each axis | mm/s^2, deg/s^2 |
// | M204 P T | largest acceleration along the path of printing and of travel moves | mm/s^2 |
// | M566, M205 X Y Z ... | allowed instantaneous change of speed ("jerk") | mm/min; M205: mm/s |
// | M208 X0:200, or with S1 minima and S0 maxima | travel | mm, deg |
// | M550 P"name" | name of the machine | |
//
// The last of codes that come twice counts. M201.1 and conditions are not read: lines with an
// expression in braces are reported.
#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/units.h"
#include "sim/input/controls/read_controls.h"
#include "sim/input/controls/settings_lines.h"

namespace servomill::sim::input {
namespace {

// The movement task sets the speed of each step from a parabola: no period is documented.
constexpr double kRrfPeriod = 1 * ms;

struct Word {
  char letter = 0;
  std::string_view value;
  int column = 0;  // of the letter, counted in the line
};

// "M203 X6000 Y6000" without its comment; texts in quotes are one value.
std::vector<Word> words_of(std::string_view line) {
  std::vector<Word> out;
  for (std::size_t at = 0; at < line.size() && line[at] != ';';) {
    const char c = line[at];
    if (c == ' ' || c == '\t') {
      ++at;
      continue;
    }
    if (c == '(') {
      at = std::min(line.find(')', at), line.size() - 1) + 1;
      continue;
    }
    const std::size_t from = at + 1;
    std::size_t end = std::min(line.find_first_of(" \t;(", from), line.size());
    if (from < line.size() && line[from] == '"') {
      end = std::min(line.find('"', from + 1), line.size() - 1) + 1;
    }
    const char upper = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    out.push_back({upper, line.substr(from, end - from), static_cast<int>(at)});
    at = end;
  }
  return out;
}

class Rrf {
 public:
  explicit Rrf(ControlSettings& out) : out_(out) {}

  void take(const SettingsLine& line) {
    const std::vector<Word> words = words_of(line.text);
    if (words.empty()) return;
    const std::string code = fmt::format("{}{}", words[0].letter, words[0].value);
    if (code == "G20") {
      faults_.add(line.place, "G20: settings in inches are not supported; use mm");
    } else if (code == "M203") {
      take_axes(words, line, code, 1.0 / minute, &ControlAxis::v_max);
    } else if (code == "M201") {
      take_axes(words, line, code, 1.0, &ControlAxis::a_max);
    } else if (code == "M208") {
      take_travel(words, line);
    } else if (code == "M204") {
      take_path_acceleration(words, line);
    } else if (code == "M566" || code == "M205") {
      out_.notes.push_back(fmt::format(
          "{} ({}): instantaneous changes of speed at corners, for which machine files have no key",
          without_comment(line.text), to_string(line.place)));
    } else if (code == "M550") {
      take_name(words);
    }
  }

  // An axis is as fast as its own limit and that of travel moves along the path allow.
  void finish() {
    for (auto& [axis, limits] : out_.axes) {
      if (!path_acceleration_ || !is_linear(axis) || !limits.a_max) continue;
      if (path_acceleration_->value < limits.a_max->value) limits.a_max = path_acceleration_;
    }
    faults_.finish();
  }

 private:
  static std::string without_comment(std::string_view line) {
    return std::string(without_blanks(line.substr(0, line.find(';'))));
  }

  static Place place_of(const SettingsLine& line, const Word& word) {
    Place out = line.place;
    out.column += word.column;
    return out;
  }

  void take_axes(const std::vector<Word>& words, const SettingsLine& line, const std::string& code,
                 double factor, std::optional<CitedValue> ControlAxis::*into) {
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto axis = axis_of(words[i].letter);
      if (!axis) continue;
      const Place place = place_of(line, words[i]);
      const std::string key = fmt::format("{} {}", code, words[i].letter);
      if (const auto value = faults_.positive(place, key, words[i].value)) {
        out_.axes[*axis].*into = CitedValue{*value * usual_unit(*axis) * factor, place, key};
      }
    }
  }

  // "X0:200", or the minimum with S1 and the maximum without.
  void take_travel(const std::vector<Word>& words, const SettingsLine& line) {
    const auto is_S1 = [](const Word& word) { return word.letter == 'S' && word.value == "1"; };
    const bool is_minimum = std::any_of(words.begin(), words.end(), is_S1);
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto axis = axis_of(words[i].letter);
      if (!axis) continue;
      const Place place = place_of(line, words[i]);
      const std::string key = fmt::format("M208 {}", words[i].letter);
      const std::size_t colon = words[i].value.find(':');
      const auto take = [&](std::string_view text, std::optional<CitedValue>& into) {
        if (const auto value = faults_.number(place, key, text)) {
          into = CitedValue{*value * usual_unit(*axis), place, key};
        }
      };
      ControlAxis& limits = out_.axes[*axis];
      if (colon != std::string_view::npos) {
        take(words[i].value.substr(0, colon), limits.lower);
        take(words[i].value.substr(colon + 1), limits.upper);
      } else {
        take(words[i].value, is_minimum ? limits.lower : limits.upper);
      }
    }
  }

  void take_path_acceleration(const std::vector<Word>& words, const SettingsLine& line) {
    for (const Word& word : words) {
      if (word.letter != 'T') continue;
      const Place place = place_of(line, word);
      if (const auto value = faults_.positive(place, "M204 T", word.value)) {
        path_acceleration_ = CitedValue{*value * mm, place, "M204 T, along the path"};
      }
    }
    out_.notes.push_back(
        fmt::format("{} ({}): accelerations along the path; that of travel moves "
                    "(T) is taken for each linear axis where it is the lower one",
                    without_comment(line.text), to_string(line.place)));
  }

  void take_name(const std::vector<Word>& words) {
    for (const Word& word : words) {
      if (word.letter != 'P' || word.value.size() < 3 || word.value.front() != '"') continue;
      out_.name = word.value.substr(1, word.value.size() - 2);
    }
  }

  ControlSettings& out_;
  SettingsFaults faults_;
  std::optional<CitedValue> path_acceleration_;
};

}  // namespace

ControlSettings read_rrf(std::string_view text, const std::string& file) {
  ControlSettings out;
  out.kind = ControlKind::rrf;
  out.file = file;
  out.name = "RepRapFirmware machine";
  out.acceleration_time = kRrfPeriod;
  out.acceleration_reason = "RepRapFirmware plans with constant acceleration";
  Rrf reader(out);
  for (const SettingsLine& line : settings_lines(text, file)) reader.take(line);
  reader.finish();
  return out;
}

}  // namespace servomill::sim::input
