#include "siemens_examples.h"

#include <algorithm>

#include "controllers/gcode/interpreter.h"

namespace servomill::controllers::siemens {

std::string with_frame(const std::string& lines) {
  return "G17 G71 G90 G94 G54 G64\nT1 M6 D1 S1000\nG0 X0 Y0 Z0\n" + lines + "M30\n";
}

std::string all_moves(const std::string& program, const ProgramSetup& setup) {
  return conversational::text_of(interpret(program, "t.mpf", setup));
}

std::string framed_moves(const std::string& lines, const ProgramSetup& setup) {
  const auto count = static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
  return conversational::text_of(interpret(with_frame(lines), "t.mpf", setup), kFrameLines,
                                 kFrameLines + count);
}

std::string warnings_of(const std::string& program, const ProgramSetup& setup) {
  Interpreter interpreter(program, "t.mpf", setup);
  interpreter.rest();
  std::string out;
  for (const Fault& one : interpreter.warnings()) {
    out += to_string(one.place) + ": " + one.message + "\n";
  }
  return out;
}

std::string fault_of(const std::string& lines, const ProgramSetup& setup) {
  try {
    interpret(with_frame(lines), "t.mpf", setup);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace servomill::controllers::siemens
