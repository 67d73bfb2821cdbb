/// Words of a Siemens block, sorted by their effect.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/siemens/scanner.h"
#include "controllers/siemens/variables.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers::siemens {

/// X=..., AC(...), IC(...); DC, ACP, ACN of rotary axes: directly, in positive, in negative
/// direction.
enum class Measure { modal, absolute, incremental, shortest, positive, negative };

struct Number {
  double value = 0.0;
  Measure measure = Measure::modal;
  Place place;
};

/// A G function or a word without a value: G1, TRANS, SUPA, SOFT.
struct Code {
  std::string name;
  Place place;
  std::string arguments = {};  // in parentheses: SETMS(2)
};

/// A value in parentheses; the name of the variable that holds it, for parameters VAR of PROC.
struct Argument {
  std::optional<Value> value;
  std::optional<Reference> variable;
};

/// NAME, NAME(1, ,3): a cycle, a function of the control or a subprogram.
struct Call {
  std::string name;
  std::vector<Argument> arguments;
  bool has_parentheses = false;
  Place place;
};

/// M3, M2=3: the number of the function, and that of the spindle.
struct Function {
  int number = 0;
  int spindle = -1;
  Place place;
};

struct Block {
  std::vector<Code> codes;
  std::array<std::optional<Number>, kAxisWords> axes;
  std::array<std::optional<Number>, 3> centre;   // I J K
  std::array<std::optional<Number>, 3> through;  // I1= J1= K1=
  std::optional<Number> F, S, D, CR, AR, TURN, AP, RP, RPL, RND, RNDM, CHF, CHR, FRC, FRCM, P;
  std::optional<Number> L;  // a subprogram, L=R1
  std::optional<Number> OVR, SPOS, DISC;
  std::array<std::optional<Number>, 3> direction;  // A3= B3= C3=
  std::optional<Value> tool;                       // T
  Place tool_place;
  std::vector<Function> functions;
  std::vector<Call> calls;
  std::vector<Code> settings;  // ACC[X]=50, H5=3: words that are passed over with a warning
  bool is_modal_call = false;  // MCALL
  Place place;

  bool has(std::string_view code) const { return find(code) != nullptr; }
  const Code* find(std::string_view code) const;
  bool has_axes() const;
  bool has_linear_axes() const;
  bool has_centre() const;
  bool is_polar() const { return AP || RP; }
};

/// Sorts the words of the rest of a block; variables that it assigns are set at once.
/// @throws InputError
Block read_block(Scanner& scanner, Variables& variables);

/// Values in parentheses that have been opened.
std::vector<Argument> read_arguments(Scanner& scanner, const Variables& variables);

/// Takes "R1=5", "DEPTH[2]=SET(1,2)" if the scanner is at a variable that is assigned.
bool read_assignment(Scanner& scanner, Variables& variables);
/// Takes the values behind the '=' of an assignment.
void assign(const Reference& reference, Scanner& scanner, Variables& variables);

}  // namespace servomill::controllers::siemens
