#include "controllers/gcode/called_subroutines.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "controllers/gcode/macro/macro_program.h"
#include "controllers/gcode/parser.h"
#include "controllers/translation/translated_program.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

std::set<std::string> called_subroutines(ProgramText text) {
  const translation::Language language = translation::language_of(text, Reader::any);
  if (language != translation::Language::gcode) {
    return translation::called_programs(std::move(text), language);
  }
  if (macro::is_macro_program(text, Reader::any)) return macro::called_programs(std::move(text));
  std::set<std::string> names;
  Parser parser;
  Block block;
  for (std::string_view line; text.next(line);) {
    try {
      parser.parse(line, text.file(), text.number(), block);
    } catch (const InputError&) {
      continue;
    }
    const OWord& o = block.o_word;
    if (o.flow != Flow::call && o.flow != Flow::m98) continue;
    if (o.name >= 0) {
      names.insert(block.names[static_cast<std::size_t>(o.name)]);
    } else if (o.number.is_constant()) {
      names.insert(fmt::format("{:.0f}", std::round(o.number.number)));
    }
  }
  return names;
}

}  // namespace servomill::controllers
