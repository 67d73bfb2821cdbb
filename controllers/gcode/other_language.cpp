#include "controllers/gcode/other_language.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace servomill::controllers {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }
bool is_name(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

// The name before the first '=', as in T="MILL", CR=4 and F=AC(100), or an empty text. Parameters
// of LinuxCNC begin with '#'.
std::string_view assigned_name(std::string_view line) {
  line = line.substr(0, line.find_first_of(";("));
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return {};
  const std::size_t last = line.find_last_not_of(" \t", equals - 1);
  if (equals == 0 || last == std::string_view::npos) return {};
  std::size_t first = last + 1;
  while (first > 0 && is_name(line[first - 1])) --first;
  const bool is_parameter = first > 0 && (line[first - 1] == '#' || line[first - 1] == '<');
  const std::string_view name = line.substr(first, last + 1 - first);
  const bool is_generator = !name.empty() && name.front() == 'E';  // of wire EDM: E001=...
  const bool is_other = name.empty() || !is_letter(name.front()) || is_parameter || is_generator;
  return is_other ? std::string_view() : name;
}

// The name at the begin of GROUP_BEGIN(0, ...), or an empty text.
std::string_view called_name(std::string_view line) {
  const std::size_t first = line.find_first_not_of("N0123456789 \t");
  if (first == std::string_view::npos || !is_letter(line[first])) return {};
  std::size_t end = first;
  while (end < line.size() && is_name(line[end])) ++end;
  constexpr std::size_t kShortest = 3;
  const bool is_call = end < line.size() && line[end] == '(' && end - first >= kShortest;
  return is_call && !is_digit(line[first + 1]) ? line.substr(first, end - first)
                                               : std::string_view();
}

// ",R5." or ",C2." outside of comments: its column, from 0, or npos.
std::size_t corner_word(std::string_view line) {
  line = line.substr(0, line.find_first_of(";("));
  const std::size_t comma = line.find(',');
  const bool is_corner = comma != std::string_view::npos && comma + 1 < line.size() &&
                         (upper(line[comma + 1]) == 'R' || upper(line[comma + 1]) == 'C');
  return is_corner ? comma : std::string_view::npos;
}

std::string corner_refusal(std::string_view line) {
  const std::size_t comma = corner_word(line);
  if (comma == std::string_view::npos) return {};
  const bool is_round = upper(line[comma + 1]) == 'R';
  const std::size_t value = std::min(line.find_first_not_of(" \t", comma + 2), line.size());
  if (line.substr(value).starts_with('#') || line.substr(value).starts_with('[')) {
    return fmt::format("',{}' with a variable (Fanuc, Haas) is not supported; write the number",
                       is_round ? 'R' : 'C');
  }
  return fmt::format(
      "',{}' {} the corner to the next move (Fanuc, Haas), which is not supported; program the {}",
      is_round ? 'R' : 'C', is_round ? "rounds" : "chamfers", is_round ? "arc" : "line");
}

std::string siemens_word(std::string_view line) {
  for (const std::string_view word : {"TRAORI", "TRAFOOF", "SUPA", "MCALL", "CYCLE", "POCKET",
                                      "SLOT", "HOLES", "MSG", "DEF", "WORKPIECE", "EXTERN"}) {
    const std::size_t at = line.find(word);
    const bool is_first =
        at != std::string_view::npos &&
        line.substr(0, at).find_first_not_of("N0123456789 \t") == std::string_view::npos;
    if (is_first) return std::string(word);
  }
  const std::string_view name = assigned_name(line);
  return name.empty() ? "" : std::string(name) + "=";
}

// M117 Roughing: a text without brackets behind a code that shows it. V"0.3": a text in quotes.
std::string text_refusal(std::string_view line) {
  line = line.substr(0, line.find_first_of(";("));
  for (const std::string_view code : {"M117", "M118"}) {
    const std::size_t begin = line.find_first_not_of("N0123456789 \t");
    if (begin == std::string_view::npos || line.substr(begin, code.size()) != code) continue;
    const std::size_t text = line.find_first_not_of(" \t", begin + code.size());
    if (text == std::string_view::npos || !is_letter(line[text])) continue;
    if (text + 1 < line.size() && !is_letter(line[text + 1]) && line[text + 1] != ' ') continue;
    return fmt::format(
        "{} displays a text (Marlin, Duet, Carvera), which needs brackets here; remove the line, "
        "or use (MSG, ...)",
        code);
  }
  if (line.find('"') == std::string_view::npos) return {};
  return "a string in quotes is RepRapFirmware or Siemens syntax; only G-code is supported: remove "
         "the line if it causes no motion";
}

// G47 P0 (TEXT) X1. Y1. ... E10.
bool is_engraving(std::string_view line) {
  for (std::size_t at = 0; at + 2 < line.size(); ++at) {
    if (upper(line[at]) != 'G' || line.substr(at + 1, 2) != "47") continue;
    if (at + 3 == line.size() || (!is_digit(line[at + 3]) && line[at + 3] != '.')) return true;
  }
  return false;
}

// A line of a control whose programs have blocks of their own kind: its refusal, or nothing.
std::string other_blocks(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t\r");
  if (last == std::string_view::npos) return {};
  line = line.substr(0, last + 1);
  if (line.front() == '$' && line.back() == '%') {
    return fmt::format(
        "'{}' starts an Okuma program, which is not supported; post-process for Fanuc or LinuxCNC",
        line);
  }
  const bool has_word = line.size() > 2 && line.find_first_of("GXYZMTN%") != line.npos;
  if (line.back() == '*' && has_word && line.find_first_of("[(;#") == line.npos) {
    return "a '*' ends blocks of Heidenhain DIN/ISO programs, which are not supported; use "
           "Heidenhain conversational or G-code of other controls";
  }
  constexpr std::array<std::string_view, 13> kShopBot = {"SA", "SR", "CN", "MS", "MX", "MY", "MZ",
                                                         "M2", "M3", "JX", "JY", "JZ", "J2"};
  const bool is_command =
      std::find(kShopBot.begin(), kShopBot.end(), line.substr(0, 2)) != kShopBot.end() &&
      (line.size() == 2 || line[2] == ',');
  const bool is_ambiguous = line.size() == 2 && line.front() == 'M';  // M2 and M3 of G-code
  if (line.front() == '\'' || (is_command && !is_ambiguous)) {
    return "this is a ShopBot program (OpenSBP), which is not supported; use G-code";
  }
  return {};
}

// Lines that no control reads but that stand in programs: marks of editors, headers to be filled
// in.
std::string unfinished_line(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  for (const std::string_view mark : {"#region", "#endregion"}) {
    if (!line.starts_with(mark)) continue;
    return fmt::format("'{}' is a fold mark of an editor; remove the line", mark);
  }
  if (line.size() < 3 || upper(line.front()) != 'O' || line[1] != ' ') return {};
  const std::size_t first = std::min(line.find_first_not_of(' ', 1), line.size());
  const bool is_text =
      first + 1 < line.size() && is_letter(line[first]) && is_letter(line[first + 1]);
  return is_text ? "O requires a program number; write one (O1000), or remove the line" : "";
}

// VC1=10 of Okuma, among names of Siemens.
bool is_okuma_variable(std::string_view name) {
  return name.size() > 2 && name.substr(0, 2) == "VC" &&
         name.find_first_not_of("0123456789", 2) == name.npos;
}

bool contains_word(std::string_view line, std::string_view word) {
  const std::size_t at = line.find(word);
  if (at == std::string_view::npos) return false;
  const bool begins = at == 0 || !is_letter(line[at - 1]);
  const std::size_t end = at + word.size();
  return begins && (end == line.size() || !is_letter(line[end]));
}

}  // namespace

int column_of_second_block(std::string_view line) {
  std::size_t end = 0;
  bool in_comment = false, has_words = false;
  for (; end < line.size() && (in_comment || line[end] != ';'); ++end) {
    in_comment = in_comment ? line[end] != ')' : line[end] == '(';
    has_words = has_words || (!in_comment && is_letter(line[end]));
  }
  if (end == line.size() || !has_words) return 0;
  const std::size_t first = line.find_first_not_of(" \t", end + 1);
  bool has_word = false;
  for (std::size_t at = first; at < line.size(); has_word = true) {
    if (line.find_first_not_of("; \t\r", at) == line.npos) break;
    if (std::string_view("GMTXYZABCIJKRFSHD").find(upper(line[at])) == std::string_view::npos)
      return 0;
    const std::size_t number = line.find_first_not_of("+-", at + 1);
    const std::size_t next = std::min(line.find_first_not_of("0123456789.", number), line.size());
    if (number > at + 2 || next == number) return 0;
    at = std::min(line.find_first_not_of(" \t", next), line.size());
  }
  return has_word ? static_cast<int>(first) + 1 : 0;
}

bool is_report_request(std::string_view line) {
  constexpr std::array<std::string_view, 6> kRequests = {"$$", "$G", "$I", "$N", "$#", "?"};
  const std::string_view request = line.substr(0, line.find_first_of(" \t;\r"));
  return std::find(kRequests.begin(), kRequests.end(), request) != kRequests.end();
}

namespace {

// "%PART G71 *": programs of Heidenhain in DIN/ISO begin so, from memory.
bool is_din_iso(std::string_view first) {
  std::size_t end = first.find_last_not_of(" \t\r*");
  if (!first.starts_with('%') || end == first.npos || end < 3) return false;
  const std::string_view unit = first.substr(end - 2, 3);
  return (unit == "G70" || unit == "G71") && (first[end - 3] == ' ' || first[end - 3] == '\t');
}

}  // namespace

std::string refused_program(ProgramText& text) {
  if (text.is_generated()) return {};
  std::string_view line;
  const std::string first(text.next(line) ? line : std::string_view());
  text.rewind();
  if (!is_din_iso(first)) return {};
  return "this is a Heidenhain DIN/ISO program (G70 or G71 after its name), whose I, J and K are "
         "absolute; only conversational is supported: convert it on the control or its programming "
         "station, or post-process for Fanuc or LinuxCNC";
}

namespace {

// An E word at the column where the line was not understood; empty: there is none.
std::string e_word_refusal(std::string_view line, int column) {
  const auto at = static_cast<std::size_t>(column - 1);
  const bool is_smoothness = line.find("G187") != line.npos || line.find("g187") != line.npos;
  if (column > 0 && !is_smoothness && at + 1 < line.size() && upper(line[at]) == 'E' &&
      (is_digit(line[at + 1]) || line[at + 1] == '-' || line[at + 1] == '.')) {
    if (is_engraving(line)) {
      return "G47 engraves text (Haas), whose moves are not in the program; have the CAM system "
             "output the moves";
    }
    return "an E word feeds the extruder of a 3D printer, sets the generator of wire EDM, or "
           "selects a work offset (Fadal, format 1); only milling programs with G54 ... G59 are "
           "supported";
  }
  return {};
}

}  // namespace

std::string other_language(std::string_view line, int column) {
  if (line.starts_with("//")) return {};  // a comment, or a block that may be skipped
  if (std::string unfinished = unfinished_line(line); !unfinished.empty()) return unfinished;
  if (std::string blocks = other_blocks(line); !blocks.empty()) return blocks;
  if (line.starts_with('$') && !is_report_request(line)) {
    return fmt::format(
        "'{}' is a sender command for grbl or TinyG, or an NCPlot directive, not a block; remove "
        "the line",
        line.front());
  }
  for (const std::string_view word : {"BEGIN PGM", "TOOL CALL", "CYCL DEF", "BLK FORM"}) {
    if (contains_word(line, word)) {
      return fmt::format("'{}' is Heidenhain conversational; use --reader heidenhain", word);
    }
  }
  // %x0=posx assigns, [x0] reads: cncjs, release notes of v1.9.4, "New macro variables"
  if (const std::string_view name = assigned_name(line); line.starts_with('%') && !name.empty()) {
    return fmt::format(
        "'%{}=' is a variable of the sender cncjs, which substitutes it while streaming; write its "
        "value",
        name);
  }
  if (is_okuma_variable(assigned_name(line))) {
    return fmt::format(
        "'{}=' is an Okuma variable, which is not supported; post-process for another control",
        assigned_name(line));
  }
  if (const std::string word = siemens_word(line); !word.empty()) {
    return fmt::format("'{}' is a Siemens word; use --reader siemens", word);
  }
  for (const std::string_view word : {"GOTO", "IF", "WHILE", "END", "THEN"}) {
    const std::size_t first = line.find_first_not_of("/N0123456789 \t");
    if (first == std::string_view::npos || line.find(word) != first) continue;
    if (is_letter(line[std::min(first + word.size(), line.size() - 1)])) continue;
    return fmt::format("'{}' is a Fanuc macro statement; only LinuxCNC O-words are supported here",
                       word);
  }
  if (const std::string_view name = called_name(line); !name.empty()) {
    return fmt::format(
        "'{}(...)' is a word of Siemens or the machine builder; for Siemens programs use --reader "
        "siemens",
        name);
  }
  if (const std::string corner = corner_refusal(line); !corner.empty()) return corner;
  if (std::string text = text_refusal(line); !text.empty()) return text;
  return e_word_refusal(line, column);
}

}  // namespace servomill::controllers
