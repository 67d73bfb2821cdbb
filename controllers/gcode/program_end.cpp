// The end of a program: a '%', or that of its text.
#include <fmt/format.h>

#include <string_view>

#include "controllers/gcode/interpreter_machine.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kMisplacedPercent =
    "'%' ends a program only if its first line is also '%'";
constexpr std::string_view kPercentInside =
    "Fanuc ends the program at this '%', other controls continue after it; choose with --reader "
    "fanuc, haas or linuxcnc";
constexpr std::string_view kBlocksBehind =
    "Fanuc, Haas and LinuxCNC end the program at this '%', but blocks follow it; remove the '%', "
    "or choose with --reader fanuc, haas or linuxcnc";
constexpr std::string_view kUnread = "the program ends here: lines after this '%' are not read";
constexpr std::string_view kBlankAtEnd = " \t\r%\x1a";  // 1a: the end of files of CP/M
constexpr std::string_view kEmpty = "the program is empty: it has no block";
constexpr std::string_view kNoEnd = "the program ends without M2, M30 or a closing '%'";

// Anything but blanks and comments. A comment ends at the first ')', or with the line: where some
// control reads a block, there is one.
bool has_words(std::string_view line) {
  bool in_comment = false;
  for (const char c : line) {
    if (in_comment) {
      in_comment = c != ')';
    } else if (c == ';') {
      return false;
    } else if (c == '(') {
      in_comment = true;
    } else if (kBlankAtEnd.find(c) == kBlankAtEnd.npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

void Interpreter::Machine::saw_percent() {
  const Percent meaning = texts_[text_].percent.saw_percent();
  if (meaning == Percent::start && texts_[text_].has_title &&
      !tolerates(ReaderRule::percent_title, 1)) {
    fail(1, std::string(kMisplacedPercent));
  }
  if (meaning == Percent::misplaced) {
    if (!has_rule(setup_.reader, ReaderRule::percent_at_end) || flow_.skip_to || text_ != 0) {
      fail(1, std::string(kMisplacedPercent));
    }
    if (has_more_words()) {
      if (setup_.reader == Reader::any) fail(1, std::string(kPercentInside));
      leave_unread();
    }
    return run_end(ReaderRule::percent_at_end);
  }
  if (meaning != Percent::end) return;
  if (flow_.skip_to || text_ != 0) fail_at_end();
  if (has_more_words()) {
    if (setup_.reader == Reader::any) fail(1, std::string(kBlocksBehind));
    leave_unread();
  }
  ended_ = true;
}

void Interpreter::Machine::leave_unread() {
  warn(1, std::string(kUnread));
  unread_behind_ = line();
}

// The text ends although the program does not.
void Interpreter::Machine::end_of_text() {
  const bool is_empty = texts_[0].percent.saw_nothing();
  const bool is_main = !is_empty && !flow_.skip_to && flow_.calls.empty() && text_ == 0;
  if (!is_main || !has_rule(setup_.reader, ReaderRule::end_of_text)) fail_at_end();
  run_end(ReaderRule::end_of_text);
}

// M2 in place of a line, so that writers of programs see it.
void Interpreter::Machine::run_end(ReaderRule rule) {
  tolerates(rule, 0);
  line_ = "M2";
  reader_.parse(line_, file(), line(), block_);
  execute();
}

// The subprogram may follow the closing '%' in this file.
bool Interpreter::Machine::goes_on_behind_end() {
  const bool may_go_on = flow_.skips_to_sub && text_ == 0 && has_more_words();
  return may_go_on && tolerates(ReaderRule::subprogram_behind_end, 1);
}

// Comments are no words.
bool Interpreter::Machine::has_more_words() {
  if (text().is_generated()) return false;
  const ProgramText::Mark here = text().mark();
  std::string_view next;
  bool found = false;
  while (!found && text().next(next)) {
    found = has_words(next);
  }
  text().go_to(here);
  return found;
}

void Interpreter::Machine::fail_at_end() {
  ended_ = true;
  std::string message(texts_[0].percent.saw_nothing() ? kEmpty : kNoEnd);
  if (flow_.skips_to_sub) {
    message = fmt::format(
        "subroutine O<{0}>, called in line {1}, not found up to the end of the program{2}",
        *flow_.skip_to, flow_.skip_from,
        text_ == flow_.calls.back().return_to.text
            ? fmt::format(", nor a file {}.ngc (set its folder with --subs)", *flow_.skip_to)
            : "");
    flow_.calls.pop_back();  // it has not begun
  } else if (flow_.skip_to) {
    const std::string label = flow_.skip_to->substr(flow_.skip_to->find('#') + 1);
    message =
        fmt::format("the program ends while skipping to O{} from line {}", label, flow_.skip_from);
  }
  fail(0, message + call_stack());
}

}  // namespace servomill::controllers
