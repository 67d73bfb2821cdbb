/// A program as a reader of tests takes it: its moves, or the first fault.
#pragma once

#include <string>
#include <vector>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::program_reader_test {

struct Read {
  std::string moves, refusal;
  std::vector<Fault> warnings;
};

inline Read read(const std::string& text, Reader reader, ProgramSetup setup = {}) {
  Read out;
  setup.reader = reader;
  if (reader != Reader::linuxcnc && setup.decimal_point == DecimalPoint::unset) {
    setup.decimal_point = DecimalPoint::calculator;
  }
  try {
    Interpreter interpreter(text, "p.nc", setup);
    while (const Move* move = interpreter.next()) out.moves += canon_json(*move) + "\n";
    out.warnings = interpreter.warnings();
  } catch (const InputError& error) {
    out.refusal = error.what();
  }
  return out;
}

inline std::string refusal(const std::string& text, Reader reader = Reader::any) {
  return read(text, reader).refusal;
}

}  // namespace servomill::controllers::program_reader_test
