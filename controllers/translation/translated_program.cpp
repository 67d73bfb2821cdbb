#include "controllers/translation/translated_program.h"

#include <utility>

#include "controllers/conversational/conversational.h"
#include "controllers/siemens/siemens.h"

namespace servomill::controllers::translation {

Language language_of(ProgramText& text, Reader reader) {
  if (conversational::is_conversational(text, reader)) return Language::conversational;
  return siemens::is_siemens(text, reader) ? Language::siemens : Language::gcode;
}

void translate(ProgramText& text, ProgramSetup& setup) {
  switch (language_of(text, setup.reader)) {
    case Language::conversational:
      text = conversational::as_gcode(std::move(text), setup);
      return;
    case Language::siemens:
      text = siemens::as_gcode(std::move(text), setup);
      return;
    default:
      return;
  }
}

ProgramSetup gcode_setup(ProgramText text, ProgramSetup setup) {
  translate(text, setup);
  return setup;
}

std::set<std::string> called_programs(ProgramText text, Language language) {
  switch (language) {
    case Language::conversational:
      return conversational::called_programs(std::move(text));
    case Language::siemens:
      return siemens::called_programs(std::move(text));
    default:
      return {};
  }
}

}  // namespace servomill::controllers::translation
