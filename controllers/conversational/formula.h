/// Arithmetic of Q parameters: `Q1 = ...` and the functions FN 0 to FN 13.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "controllers/conversational/q_parameters.h"
#include "controllers/dialects/heidenhain_block.h"

namespace servomill::controllers::conversational {

/// A block that assigns: "Q1 = Q5 + SIN 30", "FN 4: Q4 = +4 DIV +Q2".
struct Assignment {
  QName name;
  double value = 0.0;
};

/// A jump: "FN 9: IF +Q1 EQU +Q3 GOTO LBL 5".
struct Jump {
  bool is_taken = false;
  std::string label;  // number, or name in quotation marks
};

/// Evaluates the words after the head of a formula or of a function. Angles are in degrees.
/// @param words  of a formula: all of the block; of a function: those after "FN 4:"
/// @throws InputError
Assignment evaluate_formula(std::span<const HeidenhainWord> words, const QParameters& parameters);
/// @param number  0 ... 8, 13
Assignment evaluate_function(int number, std::span<const HeidenhainWord> words,
                             const QParameters& parameters);
/// @param number  9 ... 12
Jump evaluate_jump(int number, std::span<const HeidenhainWord> words,
                   const QParameters& parameters);

}  // namespace servomill::controllers::conversational
