/// Arguments of G65 and G66, and the calls of programs.
#pragma once

#include <optional>
#include <vector>

#include "controllers/gcode/macro/words.h"

namespace servomill::controllers::macro {

/// A program to be called.
struct MacroCall {
  long number = 0;               // of the program, or of the block (M97)
  long turns = 1;                // L
  bool is_block = false;         // M97
  std::optional<Locals> locals;  // of G65 and G66; M97 and M98 leave the level as it is
  int column = 0;                // of the word that names it
};

/// The call that the words of a block with G65 or G66 are.
/// Source: Fanuc B-63684EN/01 p. 278 (argument specifications I and II, mixture, decimal points).
MacroCall macro_call(const std::vector<MacroWord>& words, const MacroWord& code,
                     const Expression::Context& context, const WordUnits& units);

/// The call of M97 or M98, whose words are erased.
MacroCall subprogram_call(std::vector<MacroWord>& words, MacroWord& code,
                          const Expression::Context& context);

}  // namespace servomill::controllers::macro
