/// Flow control of a program: labels, calls that are under way, what is skipped.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/block.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers {

/// A line to which a program can go: of a subroutine or a loop.
struct LinePlace {
  std::size_t text = 0;    // index into the texts of a program
  ProgramText::Mark mark;  // before the line
  bool operator==(const LinePlace& o) const {
    return text == o.text && mark.offset == o.mark.offset;
  }
};

struct Label {
  Flow flow = Flow::none;
  LinePlace place;
  std::optional<long> repeats_left;  // of a `repeat` that is under way
};

inline constexpr int kArguments = 30;  // #1 ... #30
inline constexpr int kMaxCalls = 9;    // in each other, as LinuxCNC

/// One call that is under way.
struct Call {
  std::string name;
  Flow flow = Flow::call;  // or m98
  LinePlace return_to;
  int line = 0;  // of the call
  std::array<double, kArguments> saved{};
};

/// The place at which a program goes on. The flags are LinuxCNC's, with what they leave standing: a
/// `break` out of a `while` lets the next `do` run once only, a `continue` in a `do` turns the next
/// `break` out of a `while` into a `continue`.
struct FlowState {
  std::map<std::string, Label> labels;
  std::vector<Call> calls;
  std::vector<long> turns_left{0};      // of M98 L, of the program and of each call; 0: none
  std::optional<std::string> skip_to;   // label that ends the skipping
  bool skips_to_sub = false;            // only `sub` or a bare O-word ends it
  int skip_from = 0;                    // line where the skipping began
  std::optional<std::string> defining;  // the subroutine whose definition is passed over
  bool has_taken_branch = false;
  bool breaks = false;
  bool continues = false;
  double value = 0.0;  // of the last return or endsub
  bool has_value = false;
  long jumps = 0;
  long lines = 0;  // run since the first jump
};

}  // namespace servomill::controllers
