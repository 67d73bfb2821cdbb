#include "controllers/siemens/siemens.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "controllers/siemens/program_file.h"
#include "controllers/siemens/scanner.h"
#include "controllers/siemens/translator.h"
#include "controllers/translation/translated_source.h"

namespace servomill::controllers::siemens {
namespace {

std::string all_of(ProgramText& text) {
  std::string all;
  for (std::string_view line; text.next(line);) all.append(line).append("\n");
  return all;
}

bool is_named_by_siemens(const std::string& file) {
  constexpr std::size_t kEnding = 4;
  const std::string ending =
      capitals(std::string_view(file).substr(file.size() - std::min(kEnding, file.size())));
  return ending == ".MPF" || ending == ".SPF";
}

std::string_view behind_number(std::string_view line) {
  std::size_t at = line.find_first_not_of(" \t/");
  if (at == line.npos) return {};
  if (line[at] == 'N') at = std::min(line.find_first_not_of("0123456789", at + 1), line.size());
  at = std::min(line.find_first_not_of(" \t", at), line.size());
  return line.substr(at);
}

// Words that stand at the begin of a block in Siemens programs only.
bool begins_with_siemens_word(std::string_view line) {
  constexpr auto kWords = std::to_array<std::string_view>(
      {"SUPA", "TRAORI", "TRAFOOF", "MCALL", "MSG(", "MSG (", "WORKPIECE(", "DEF REAL", "DEF INT",
       "DEF BOOL", "DEF STRING", "CYCLE800(", "CYCLE832(", "T=\"", "PROC "});
  const std::string_view text = behind_number(line);
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return text.starts_with(word); });
}

bool is_written_by_siemens(ProgramText& text) {
  constexpr int kMaxLines = 1000;
  bool found = false;
  int lines = 0;
  for (std::string_view line; !found && lines < kMaxLines && text.next(line); ++lines) {
    found = line.starts_with("%_N_") || begins_with_siemens_word(line);
  }
  text.rewind();
  return found;
}

using Source = translation::TranslatedSource<Translator>;

}  // namespace

bool is_siemens(ProgramText& text, Reader reader) {
  if (text.is_generated()) return false;
  if (reader == Reader::siemens) return true;
  if (reader != Reader::any) return false;
  return is_named_by_siemens(text.file()) || is_written_by_siemens(text);
}

ProgramText as_gcode(ProgramText text, ProgramSetup& setup) {
  const std::string file = text.file();
  auto source = std::make_unique<Source>(all_of(text), file, setup);
  std::erase_if(setup.parameters, [](const auto& one) { return is_parameter_name(one.first); });
  setup.reader = Reader::any;
  setup.block_delete = false;
  return ProgramText::of_source(std::move(source), file);
}

bool is_parameter_name(std::string_view name) {
  if (name.starts_with('$')) return name.size() > 1;
  const bool is_R = !name.empty() && (name.front() == 'R' || name.front() == 'r');
  constexpr std::size_t kLongest = 6;
  return is_R && name.size() > 1 && name.size() <= kLongest &&
         name.find_first_not_of("0123456789", 1) == name.npos;
}

std::set<std::string> called_programs(ProgramText text) {
  const std::string file = text.file();
  return ProgramFile(all_of(text), file).called_names();
}

}  // namespace servomill::controllers::siemens
