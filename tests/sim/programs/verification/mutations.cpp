#include "tests/sim/programs/verification/mutations.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace servomill::sim::programs {
namespace {

// A line's begin: behind its number.
std::size_t begin_of(const std::string& line) {
  std::size_t i = line.starts_with('N') ? 1 : 0;
  while (i < line.size() && line[i] >= '0' && line[i] <= '9') ++i;
  while (i < line.size() && line[i] == ' ') ++i;
  return i;
}

}  // namespace

// Block numbers of Heidenhain programs count, those of others are only names.
std::string text_of(const Lines& lines, Dialect dialect) {
  std::string out;
  int number = 0;
  for (const std::string& line : lines) {
    const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
    const bool counts = dialect == Dialect::heidenhain && digits > 0;
    out += counts ? fmt::format("{}{}\n", number++, line.substr(digits)) : line + "\n";
  }
  return out;
}

bool is_comment(const std::string& line) {
  const std::size_t i = begin_of(line);
  return i >= line.size() || line[i] == '(' || line[i] == ';' || line[i] == '%' || line[i] == 'O' ||
         line.find("PGM") != std::string::npos || line.find("Q339") != std::string::npos;
}

namespace {

// Start of the number of a word whose letter is one of these; npos: there is none.
std::size_t number_at(const std::string& line, std::string_view letters) {
  for (std::size_t i = begin_of(line); i + 1 < line.size(); ++i) {
    const char next = line[i + 1];
    const bool is_number =
        (next >= '0' && next <= '9') || next == '-' || next == '+' || next == '.';
    const bool is_begin = i == 0 || line[i - 1] == ' ' || i == begin_of(line);
    if (is_begin && is_number && letters.find(line[i]) != std::string_view::npos) return i + 1;
  }
  return std::string::npos;
}

bool drop(Lines& lines, std::size_t i) {
  lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
  return true;
}

bool replace(std::string& line, std::string_view from, std::string_view to) {
  const std::size_t at = line.find(from, begin_of(line));
  if (at == std::string::npos) return false;
  line.replace(at, from.size(), to);
  return true;
}

bool lose_sign(Lines& lines, std::size_t i) {
  const std::size_t at = lines[i].find('-', begin_of(lines[i]));
  if (at == std::string::npos) return false;
  lines[i].erase(at, 1);
  return true;
}

bool turn_sign(Lines& lines, std::size_t i) {
  const std::size_t at = number_at(lines[i], "XYIJ");
  if (at == std::string::npos) return false;
  if (lines[i][at] == '-') return lines[i][at] = '+', true;
  if (lines[i][at] == '+') return lines[i][at] = '-', true;
  lines[i].insert(at, 1, '-');
  return true;
}

// A digit before the point goes.
bool shift_point(Lines& lines, std::size_t i) {
  const std::size_t at = number_at(lines[i], "XYZ");
  const std::size_t point = at == std::string::npos ? at : lines[i].find('.', at);
  if (point == std::string::npos || point + 1 >= lines[i].size()) return false;
  std::swap(lines[i][point], lines[i][point - 1]);
  return true;
}

bool change_digit(Lines& lines, std::size_t i) {
  std::size_t at = number_at(lines[i], "XYZ");
  if (at == std::string::npos) return false;
  while (lines[i][at] == '-' || lines[i][at] == '+' || lines[i][at] == '.') ++at;
  lines[i][at] = lines[i][at] == '9' ? '8' : static_cast<char>(lines[i][at] + 1);
  return true;
}

bool change_feed(Lines& lines, std::size_t i) {
  const std::size_t at = number_at(lines[i], "F");
  if (at == std::string::npos) return false;
  lines[i][at] = lines[i][at] == '9' ? '8' : static_cast<char>(lines[i][at] + 1);
  return true;
}

bool swap_lines(Lines& lines, std::size_t i) {
  if (i + 1 >= lines.size() || is_comment(lines[i + 1])) return false;
  std::swap(lines[i], lines[i + 1]);
  return true;
}

bool wrong_unit(Lines& lines, std::size_t i) {
  return replace(lines[i], "G21", "G20") || replace(lines[i], "G710", "G700") ||
         replace(lines[i], "G94", "G95") || replace(lines[i], "G90", "G91") ||
         replace(lines[i], "M137", "M136") || replace(lines[i], "L X", "L IX") ||
         replace(lines[i], "L Z", "L IZ");
}

bool other_number(Lines& lines, std::size_t i) {
  return replace(lines[i], "H1", "H2") || replace(lines[i], "H2", "H1") ||
         replace(lines[i], "D1", "D0") || replace(lines[i], "T1", "T2") ||
         replace(lines[i], "CALL 1", "CALL 2") || replace(lines[i], "CALL 2", "CALL 1") ||
         replace(lines[i], "G54", "G55");
}

// The length in a block before or after the one that it belongs to.
bool move_length(Lines& lines, std::size_t i) {
  for (const std::string word : {"G43 H1 ", "G43 H2 ", "D1 "}) {
    if (!replace(lines[i], word, "")) continue;
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(i + 1),
                 word.substr(0, word.size() - 1));
    return true;
  }
  // Heidenhain: the length changes with the tool
  const bool calls = lines[i].find("TOOL CALL 1 Z") != std::string::npos ||
                     lines[i].find("TOOL CALL 2 Z") != std::string::npos;
  if (calls && i + 1 < lines.size()) std::swap(lines[i], lines[i + 1]);
  return calls;
}

bool rapid_for_feed(Lines& lines, std::size_t i) {
  if (lines[i].find("FMAX") != std::string::npos) return replace(lines[i], "FMAX", "F500");
  if (replace(lines[i], "G1 ", "G0 ")) return true;
  return replace(lines[i], "G0 ", "G1 ");
}

// Tells if a rapid is in force in a line of ISO codes, or of the line itself.
bool is_rapid_line(const Lines& lines, std::size_t i) {
  if (lines[i].find(" L ") != std::string::npos) return lines[i].find("FMAX") != std::string::npos;
  for (std::size_t k = i + 1; k > 0; --k) {
    for (const char* word : {"G1 ", "G2 ", "G3 "}) {
      if (lines[k - 1].find(word) != std::string::npos) return false;
    }
    if (lines[k - 1].find("G0") != std::string::npos) return true;
  }
  return false;
}

// Two blocks of a rapid as one: the path between is another.
bool join_rapids(Lines& lines, std::size_t i) {
  if (i + 1 >= lines.size() || !is_rapid_line(lines, i) || !is_rapid_line(lines, i + 1)) {
    return false;
  }
  const std::string next = lines[i + 1].substr(begin_of(lines[i + 1]));
  const std::size_t Z = number_at(lines[i + 1], "Z");
  if (Z == std::string::npos || next.find("G53") != std::string::npos ||
      next.find("SUPA") != std::string::npos || next.find("M91") != std::string::npos ||
      number_at(lines[i], "XY") == std::string::npos ||
      number_at(lines[i], "Z") != std::string::npos) {
    return false;
  }
  const std::size_t end = lines[i + 1].find(' ', Z);
  lines[i].insert(lines[i].find_last_of("XY"), lines[i + 1].substr(Z - 1, end - Z + 1) + " ");
  return drop(lines, i + 1);
}

bool lose_machine_frame(Lines& lines, std::size_t i) {
  return replace(lines[i], "G53 ", "") || replace(lines[i], "SUPA ", "") ||
         replace(lines[i], " M91", "");
}

bool turn_arc(Lines& lines, std::size_t i) {
  return replace(lines[i], "G2 ", "G3 ") || replace(lines[i], "G3 ", "G2 ") ||
         replace(lines[i], "DR+", "DR-") || replace(lines[i], "DR-", "DR+");
}

bool change_auxiliary(Lines& lines, std::size_t i) {
  return replace(lines[i], "M3", "M4") || replace(lines[i], "M8", "M9") ||
         replace(lines[i], "M0", "M1") || replace(lines[i], "S1000", "S1100");
}

bool repeat_line(Lines& lines, std::size_t i) {
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(i), lines[i]);
  return true;
}

// Keeps the modes in force before a tool change over it: the restated ones go.
bool keep_state_over_M6(Lines& lines, std::size_t i) {
  const bool is_retract = lines[i].find("M91") != std::string::npos;
  if (!is_retract && replace(lines[i], " R0", "")) return true;
  const bool restates =
      lines[i].find("G90") != std::string::npos && lines[i].find("G54") != std::string::npos;
  return restates && drop(lines, i);
}

constexpr MutationKind kKinds[] = {
    {"dropped block", drop},
    {"lost sign", lose_sign},
    {"turned sign", turn_sign},
    {"shifted point", shift_point},
    {"changed digit", change_digit},
    {"changed feed", change_feed},
    {"swapped blocks", swap_lines},
    {"wrong unit or mode", wrong_unit},
    {"another H, D, T or G54", other_number},
    {"moved G43 or D", move_length},
    {"rapid for feed", rapid_for_feed},
    {"rapid swept another way", join_rapids},
    {"machine position in the work", lose_machine_frame},
    {"arc turned", turn_arc},
    {"M or S changed", change_auxiliary},
    {"repeated block", repeat_line},
    {"state kept over M6", keep_state_over_M6},
};

}  // namespace

std::span<const MutationKind> mutation_kinds() { return kKinds; }

}  // namespace servomill::sim::programs
