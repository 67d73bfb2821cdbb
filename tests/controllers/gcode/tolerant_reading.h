/// A program as a reader of tests takes it: its moves, or the first fault.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::program_reader_test {

/// Warnings but that of the unit, which programs of tests need not name.
inline std::vector<Fault> besides_unit(std::vector<Fault> warnings) {
  std::erase_if(warnings, [](const Fault& one) {
    return one.message.starts_with("a length before G20 or G21");
  });
  return warnings;
}

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
    out.warnings = besides_unit(interpreter.warnings());
  } catch (const InputError& error) {
    out.refusal = error.what();
  }
  return out;
}

inline std::string refusal(const std::string& text, Reader reader = Reader::any) {
  return read(text, reader).refusal;
}

inline std::string without_lines(std::string moves) {
  for (std::size_t at; (at = moves.find("\"line\":")) != std::string::npos;) {
    moves.erase(at, moves.find_first_of(",}", at) - at);
  }
  return moves;
}

/// Has the subprogram 7 in O0007.nc.
inline ProgramSetup with_subprogram_file() {
  ProgramSetup setup;
  setup.subroutine_file = [](const std::string& name) {
    return name == "7" ? std::optional(ProgramText::of_text("O0007\nG0 X1.\nM99\n", "O0007.nc"))
                       : std::nullopt;
  };
  return setup;
}

}  // namespace servomill::controllers::program_reader_test
