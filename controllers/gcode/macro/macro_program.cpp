#include "controllers/gcode/macro/macro_program.h"

#include <fmt/format.h>

#include <cctype>
#include <utility>

#include "controllers/gcode/macro/macro_source.h"

namespace servomill::controllers::macro {
namespace {

// O100 IF, O<name> CALL: LinuxCNC's flow control, behind which IF[ ... has no other meaning.
bool has_o_keyword(std::string_view text) {
  std::size_t first = 0;
  while (first < text.size() && (text[first] == ' ' || text[first] == '\t')) ++first;
  if (first == text.size() || (text[first] != 'O' && text[first] != 'o')) return false;
  if (first + 1 < text.size() && text[first + 1] == '<') return true;
  const std::size_t behind = text.find_first_not_of(" \t0123456789", first + 1);
  if (behind == std::string_view::npos) return false;
  for (const std::string_view word : {"sub", "call", "if", "while", "do", "repeat"}) {
    std::size_t same = 0;
    while (same < word.size() && behind + same < text.size() &&
           std::tolower(static_cast<unsigned char>(text[behind + same])) == word[same]) {
      ++same;
    }
    if (same == word.size()) return true;
  }
  return false;
}

bool has_variable(std::string_view text, Line& line) {
  if (text.find_first_of("#[") == std::string_view::npos) return false;
  read_line(text, line);
  return line.body.find_first_of("#[") != std::string::npos;
}

}  // namespace

int first_macro_line(ProgramText& text) {
  Line line;
  int found = 0;
  text.rewind();
  for (std::string_view next; text.next(next);) {
    if (has_o_keyword(next)) {
      found = 0;
      break;
    }
    if (found == 0 && is_macro_only(next, line)) found = text.number();
  }
  text.rewind();
  return found;
}

bool is_macro_program(ProgramText& text, Reader reader) {
  if (text.is_generated()) return false;
  const bool has_macros = reader == Reader::fanuc || reader == Reader::haas;
  if (reader != Reader::any && !has_macros) return false;
  if (first_macro_line(text) > 0) return true;
  if (!has_macros) return false;
  Line line;
  bool found = false;
  for (std::string_view next; !found && text.next(next);) {
    if (has_o_keyword(next)) break;
    found = has_variable(next, line);
  }
  text.rewind();
  return found;
}

ProgramText as_gcode(ProgramText text, ProgramSetup& setup,
                     std::shared_ptr<const ControlState> control) {
  const std::string file = text.file();
  auto source = std::make_unique<MacroSource>(std::move(text), setup, std::move(control));
  std::erase_if(setup.parameters, [](const auto& one) { return one.first.size() > 5; });
  return ProgramText::of_source(std::move(source), file);
}

std::set<std::string> called_programs(ProgramText text) {
  constexpr long kNumbers = 10000;
  std::set<std::string> out;
  Line line;
  for (std::string_view next; text.next(next);) {
    read_line(next, line);
    if (line.statement != Statement::words || !has_call_code(line.body)) continue;
    for (std::size_t i = 0; i + 1 < line.body.size(); ++i) {
      const bool is_number = std::isdigit(static_cast<unsigned char>(line.body[i + 1])) != 0;
      if ((line.body[i] != 'P' && line.body[i] != 'p') || !is_number) continue;
      const long number = std::atol(line.body.c_str() + i + 1);
      out.insert(fmt::format("{}", number));
      if (number >= kNumbers) out.insert(fmt::format("{}", number % kNumbers));
    }
  }
  return out;
}

}  // namespace servomill::controllers::macro
