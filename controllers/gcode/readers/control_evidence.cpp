#include "controllers/gcode/readers/control_evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "controllers/gcode/reader.h"

namespace servomill::controllers {
namespace {

constexpr std::uint8_t bit(Reader reader) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reader));
}

struct ControlName {
  std::string_view word;  // in comments, in capitals
  Reader reader;
  std::string_view name;
};
constexpr auto kNames = std::to_array<ControlName>({{"FANUC", Reader::fanuc, "Fanuc"},
                                                    {"HAAS", Reader::haas, "Haas"},
                                                    {"LINUXCNC", Reader::linuxcnc, "LinuxCNC"},
                                                    {"EMC2", Reader::linuxcnc, "LinuxCNC"},
                                                    {"MACH2", Reader::mach, "Mach"},
                                                    {"MACH3", Reader::mach, "Mach"},
                                                    {"MACH4", Reader::mach, "Mach"},
                                                    {"GRBL", Reader::grbl, "grbl"}});

constexpr int kHeadLines = 40;  // posts name their control in the first few lines

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// True if the text has the word, and no letter next to it.
bool has_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter(text[at - 1])) && (end == text.size() || !is_letter(text[end]))) {
      return true;
    }
  }
  return false;
}

// Comments of a line, in capitals.
std::string comments_of(std::string_view line) {
  const std::size_t begin = line.find_first_of("(;");
  std::string out(begin == line.npos ? std::string_view() : line.substr(begin));
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

// "O0994" or ":994" at the start, not followed by a keyword of LinuxCNC's O-words.
std::string program_number(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == line.npos || std::string_view("Oo:").find(line[first]) == std::string_view::npos) {
    return {};
  }
  std::size_t end = first + 1;
  while (end < line.size() && is_digit(line[end])) ++end;
  if (end == first + 1) return {};
  const std::size_t next = line.find_first_not_of(" \t\r", end);
  if (next != line.npos && line[next] != '(' && line[next] != ';') return {};
  return std::string(line.substr(first, end - first));
}

bool is_tape_mark(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first != line.npos && line[first] == '%';
}

bool has_words(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != line.npos && line[first] != '(' && line[first] != ';';
}

}  // namespace

ControlEvidence control_evidence(ProgramText text) {
  ControlEvidence named, numbered;
  bool is_first_block = true;
  std::string_view line;
  for (int i = 0; i < kHeadLines && text.next(line); ++i) {
    const std::string comments = comments_of(line);
    for (const ControlName& one : kNames) {
      if ((named.readers & bit(one.reader)) != 0 || !has_word(comments, one.word)) continue;
      named.readers |= bit(one.reader);
      named.text = fmt::format("line {} contains {}", text.number(), one.name);
    }
    if (!is_first_block || is_tape_mark(line) || !has_words(line)) continue;
    is_first_block = false;
    if (const std::string number = program_number(line); !number.empty()) {
      numbered.readers = bit(Reader::fanuc) | bit(Reader::haas);
      numbered.text = fmt::format("the program starts with {}, as on Fanuc and Haas", number);
    }
  }
  const bool names_one = named.readers != 0 && (named.readers & (named.readers - 1)) == 0;
  if (named.readers != 0) return names_one ? named : ControlEvidence();
  if (numbered.readers != 0) return numbered;
  if (!text.file().ends_with(".ngc")) return {};
  return {bit(Reader::linuxcnc), "the file is named *.ngc, as on LinuxCNC"};
}

}  // namespace servomill::controllers
