// Loops and conditions of O-words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/interpreter_machine.h"

namespace servomill::controllers {
namespace {

std::string_view name_of(Flow flow) {
  switch (flow) {
    case Flow::sub:
      return "sub";
    case Flow::do_:
      return "do";
    case Flow::while_:
      return "while";
    case Flow::if_:
      return "if";
    case Flow::repeat:
      return "repeat";
    default:
      return "a subprogram of M98";
  }
}

}  // namespace

// The label of a loop or condition that begins here. It may be known from an earlier turn.
Label& Interpreter::Machine::same_label(const std::string& name, Flow flow) {
  const auto found = flow_.labels.find(name);
  if (found == flow_.labels.end()) return new_label(name, flow);
  if (found->second.place == here_) return found->second;
  fail(block_.o_word.column,
       fmt::format("label already used in line {} for {}", found->second.place.mark.line + 1,
                   name_of(found->second.flow)));
}

Label& Interpreter::Machine::known_label(const std::string& name, const OWord& o) {
  const auto found = flow_.labels.find(name);
  if (found != flow_.labels.end()) return found->second;
  fail(o.column, fmt::format("O{} has no matching start before this line", label_text(o)));
}

void Interpreter::Machine::repeat(const std::string& name, const OWord& o) {
  const double count = flow_value(o);
  Label& label = same_label(name, Flow::repeat);
  flow_.skip_to.reset();
  if (label.flow != Flow::repeat) return;
  if (!label.repeats_left) label.repeats_left = std::lround(std::clamp(count, -1.0, 1e15));
  if (*label.repeats_left > 0) {
    --*label.repeats_left;
    return;
  }
  label.repeats_left.reset();
  skip_to(name);
}

// Begins a loop, or ends one that `do` began.
void Interpreter::Machine::while_line(const std::string& name, const OWord& o) {
  const bool holds = flow_value(o) != 0.0;
  const auto known = flow_.labels.find(name);
  const bool ends_do = known != flow_.labels.end() && known->second.flow == Flow::do_;
  if (!ends_do) same_label(name, Flow::while_);
  flow_.skip_to.reset();
  if (!ends_do) {
    if (!holds) skip_to(name);
    return;
  }
  if (holds && !flow_.breaks) {
    count_jump();
    return go_to(known->second.place);
  }
  flow_.breaks = false;
}

void Interpreter::Machine::branch(const std::string& name, const OWord& o) {
  const bool holds = flow_value(o) != 0.0;
  if (o.flow == Flow::if_) {
    same_label(name, Flow::if_);
    flow_.skip_to.reset();
    flow_.has_taken_branch = holds;
    if (!holds) skip_to(name);
    return;
  }
  const Label& label = known_label(name, o);
  if (label.flow != Flow::if_) {
    fail(o.column, fmt::format("O{} is not an IF but {}, in line {}", label_text(o),
                               name_of(label.flow), label.place.mark.line + 1));
  }
  // behind ENDIF an IF around this one was taken
  const bool goes_on =
      o.flow == Flow::endif || (!flow_.has_taken_branch && (o.flow == Flow::else_ || holds));
  if (goes_on) {
    flow_.skip_to.reset();
    flow_.has_taken_branch = true;
  } else if (flow_.has_taken_branch) {
    skip_to(name);
  }
}

void Interpreter::Machine::leave_loop(const std::string& name, const OWord& o) {
  const Label& label = known_label(name, o);
  if (label.flow != Flow::while_ && label.flow != Flow::do_) {
    fail(o.column, fmt::format("O{} is neither a WHILE nor a DO but {}, in line {}", label_text(o),
                               name_of(label.flow), label.place.mark.line + 1));
  }
  if (flow_.skip_to && o.flow == Flow::continue_) return;
  skip_to(name);
  (o.flow == Flow::break_ ? flow_.breaks : flow_.continues) = true;
}

void Interpreter::Machine::end_loop(const std::string& name, const OWord& o) {
  const Label& label = known_label(name, o);
  const Flow wanted = o.flow == Flow::endwhile ? Flow::while_ : Flow::repeat;
  if (label.flow != wanted) {
    fail(o.column, fmt::format("O{} is not {} but {}, in line {}", label_text(o),
                               wanted == Flow::while_ ? "WHILE" : "REPEAT", name_of(label.flow),
                               label.place.mark.line + 1));
  }
  if (flow_.skip_to) {
    flow_.skip_to.reset();
    if (!flow_.continues) return;
    flow_.continues = false;
  }
  count_jump();
  go_to(label.place);
}

}  // namespace servomill::controllers
