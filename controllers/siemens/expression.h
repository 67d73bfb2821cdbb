/// Expressions of Siemens programs: `R1+SIN(30)`, `(R1<10) AND (DEPTH==5)`. Angles in degrees.
#pragma once

#include "controllers/siemens/scanner.h"
#include "controllers/siemens/variables.h"

namespace servomill::controllers::siemens {

/// Takes an expression from a block and returns its value.
/// @throws InputError
Value evaluate(Scanner& scanner, const Variables& variables);

/// The same of an expression that must be a number.
double evaluate_number(Scanner& scanner, const Variables& variables);

/// Takes a variable with its indices: "R5", "R[R1+1]", "DEPTH[2]", "$P_TOOLR".
/// @pre the scanner is at its name
Reference read_reference(Scanner& scanner, const Variables& variables);

}  // namespace servomill::controllers::siemens
