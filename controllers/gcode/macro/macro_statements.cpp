// Statements of custom macro B: assignments, branches and loops.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "controllers/gcode/macro/macro_source.h"
#include "controllers/gcode/number_text.h"

namespace servomill::controllers::macro {

void MacroSource::run_statement(Statement statement, std::size_t begin) {
  switch (statement) {
    case Statement::blank:
      return emit_as_written();
    case Statement::percent:
      return percent();
    case Statement::program_number:
      return program_number();
    case Statement::words:
      return read_words_of_line();
    case Statement::output:
      return reading_.apply(ReaderRule::macro_output, here(static_cast<int>(begin) + 1));
    default:
      break;
  }
  reading_.apply(ReaderRule::macro_statement, here(static_cast<int>(begin) + 1));
  if (line_.is_optional) {
    reading_.warn(
        here(1),
        "an optional macro statement runs as if block delete is off; --block-delete skips it");
  }
  switch (statement) {
    case Statement::assignment:
      return assignment(begin);
    case Statement::if_:
      return condition(begin);
    case Statement::while_:
      return while_line(begin);
    case Statement::do_:
      loop_of_line();
      return;
    case Statement::end:
      return end_of_loop();
    case Statement::conditional_return:
      return conditional_return(begin);
    default:
      return go_to(begin);
  }
}

void MacroSource::nothing_behind(const Cursor& cursor) {
  if (cursor.at_end()) return;
  refuse(cursor.column(),
         fmt::format("unexpected '{}' after a macro statement, which must be in a separate block",
                     cursor.peek()));
}

// #1=2 #3=4, and WHILE[...]DO1 #1=#1+1: an assignment or IF in the same block. Behind THEN it is
// open whether the condition counts for it.
bool MacroSource::has_next_statement(const Cursor& cursor) {
  if (cursor.at_end()) return false;
  const Statement next = statement_at(line_.body, cursor.at());
  const bool may_follow = next == Statement::assignment || next == Statement::if_;
  const bool is_read =
      !is_behind_then_ && has_rule(reading_.reader(), ReaderRule::several_statements);
  if (!may_follow || !is_read) {
    nothing_behind(cursor);
    return false;
  }
  reading_.apply(ReaderRule::several_statements, here(cursor.column()));
  return true;
}

void MacroSource::assignment(std::size_t begin) {
  Expression expression(line_.body, begin, context());
  Cursor& cursor = expression.cursor();
  cursor.accept("#");
  const long number = expression.variable_number();
  if (!cursor.accept("=")) refuse(cursor.column(), "expected '=' after a variable");
  const MacroValue value = expression.assigned_value();
  const bool has_next = has_next_statement(cursor);
  const Place place = here(static_cast<int>(begin) + 1);
  if (variables_.is_of_system(number)) {
    write_system_variable(number, value, place);
  } else {
    variables_.write(number, value, place);
  }
  if (has_next) run_statement(statement_at(line_.body, cursor.at()), cursor.at());
}

void MacroSource::write_system_variable(long number, MacroValue value, const Place& place) {
  if (number == 3000) {
    reading_.fail(place,
                  fmt::format("the program raises an alarm (#3000={}){}{}", value.value_or(0.0),
                              line_.comment.empty() ? "" : ": ", line_.comment));
  }
  if (number == 3006) return stop_with_message();
  const bool is_without_effect =
      (number >= 3001 && number <= 3004) || (number >= 1100 && number <= 1139);
  if (is_without_effect) return reading_.apply(ReaderRule::macro_output, place);
  const std::string_view name = system_variable_name(number);
  std::string_view remedy = "its effect is not simulated";
  if (name == "a work offset") remedy = "set it with G10 L2";
  if (name == "a tool offset") remedy = "enter it in the tool table (--tools), and remove the line";
  reading_.fail(place, fmt::format("#{} is {} and cannot be set here: {}", number,
                                   name.empty() ? "a control variable" : name, remedy));
}

void MacroSource::stop_with_message() {
  more_.push_back("M0");
  if (!line_.comment.empty()) return emit("(MSG," + comment_text(line_.comment) + ")");
}

void MacroSource::condition(std::size_t begin) {
  Expression expression(line_.body, begin, context());
  Cursor& cursor = expression.cursor();
  cursor.accept("IF");
  const bool holds = expression.condition();
  const std::size_t at = cursor.at();
  const Statement then = statement_at(line_.body, at);
  if (then == Statement::go_to) {
    if (holds) go_to(at);
    return;
  }
  if (!cursor.accept("THEN")) refuse(cursor.column(), "expected GOTO or THEN after IF[...]");
  const Statement statement = statement_at(line_.body, cursor.at());
  const bool is_macro = statement == Statement::assignment || statement == Statement::go_to ||
                        statement == Statement::output || statement == Statement::if_;
  if (!is_macro) refuse(cursor.column(), "expected a macro statement after THEN");
  if (!holds) return check_left_out(statement, cursor.at());
  is_behind_then_ = true;
  run_statement(statement, cursor.at());
  is_behind_then_ = false;
}

// The form of a statement that does not run, since its values are not known: the control would stop
// at it in another run.
void MacroSource::check_left_out(Statement statement, std::size_t begin) {
  const std::string& body = line_.body;
  std::vector<std::size_t> open;
  for (std::size_t i = begin; i < body.size(); ++i) {
    if (body[i] == '[') open.push_back(i);
    if (body[i] != ']') continue;
    if (open.empty()) refuse(static_cast<int>(i) + 1, "']' without a '[' before it");
    open.pop_back();
  }
  if (!open.empty()) {
    refuse(static_cast<int>(open.back()) + 1, "'[' is not closed; ']' is missing");
  }
  const std::size_t last = body.find_last_not_of(" \t\r");
  if (statement == Statement::assignment) {
    const std::size_t equals = body.find('=', begin);
    if (equals == std::string::npos) {
      refuse(static_cast<int>(begin) + 1, "expected '=' after a variable");
    }
    constexpr std::string_view kOpenEnds = "=+-*/#";
    if (kOpenEnds.find(body[last]) != std::string_view::npos) {
      refuse(static_cast<int>(last) + 1, "expected a value after it");
    }
  }
}

// [#1 LT 10] M99 P10. Source: Haas 96-8000, June 1999, p. 376.
void MacroSource::conditional_return(std::size_t begin) {
  Expression expression(line_.body, begin, context());
  Cursor& cursor = expression.cursor();
  const int column = cursor.column();
  if (reading_.reader() == Reader::fanuc) {
    refuse(column, "a condition before M99 is Haas syntax; use IF[...]GOTO");
  }
  const bool holds = expression.condition();
  const auto words = read_words(line_.body, cursor.at(), context(), {});
  const bool is_return = !words.empty() && words[0].letter == 'M' && words[0].tenths() == 990;
  const bool has_block = words.size() == 2 && words[1].letter == 'P' && words[1].value;
  if (!is_return || (words.size() > 1 && !has_block)) {
    refuse(column, "expected M99, or M99 P with a block number, after a condition");
  }
  if (!holds) return;
  std::optional<long> block;
  if (has_block) block = std::lround(std::clamp(*words[1].value, -1.0, 1e8));
  if (calls_.empty() && !block) return emit("M99");
  end_call(block, words[0].column());
}

const Loop& MacroSource::loop_of_line() {
  const Loop* loop = places().loop_from(text().number());
  if (loop == nullptr) refuse(static_cast<int>(line_.begin) + 1, "DO does not start a loop here");
  if (!loop->fault.empty()) refuse(static_cast<int>(line_.begin) + 1, loop->fault);
  return *loop;
}

void MacroSource::while_line(std::size_t begin) {
  Expression expression(line_.body, begin, context());
  Cursor& cursor = expression.cursor();
  cursor.accept("WHILE");
  const bool holds = expression.condition();
  if (!cursor.accept("DO")) refuse(cursor.column(), "expected DO with its number after WHILE[...]");
  std::uint64_t number = 0;
  cursor.take_digits(number);
  const bool has_next = has_next_statement(cursor);
  const Loop& loop = loop_of_line();
  if (!holds) return text().go_to(loop.behind);
  if (has_next) run_statement(statement_at(line_.body, cursor.at()), cursor.at());
}

void MacroSource::end_of_loop() {
  const Loop* loop = places().loop_to(text().number());
  if (loop == nullptr) {
    refuse(static_cast<int>(line_.begin) + 1, "END without a matching DO before it");
  }
  if (!loop->fault.empty()) refuse(static_cast<int>(line_.begin) + 1, loop->fault);
  count_jump();
  text().go_to(loop->begin);
}

void MacroSource::go_to(std::size_t begin) {
  Expression expression(line_.body, begin, context());
  Cursor& cursor = expression.cursor();
  cursor.accept("GOTO");
  const int column = cursor.column();
  const MacroValue number = expression.word_value();
  nothing_behind(cursor);
  if (!number || *number < 0.0 || *number > 99'999'999.0) {
    refuse(column, "GOTO requires a block number");
  }
  jump(std::lround(*number), here(column), "this program");
}

void MacroSource::jump(long number, const Place& place, std::string_view program) {
  const int from = text().number();
  const auto mark = places().block(number);
  if (!mark) {
    reading_.refuse(place, fmt::format("block N{} not found in {}", number, program));
  }
  if (const Loop* loop = places().loop_entered(from, mark->line + 1)) {
    reading_.refuse(
        place,
        fmt::format("N{} is inside the loop DO{} of line {}: jumps into a loop are not allowed",
                    number, loop->number, loop->begin_line));
  }
  count_jump();
  text().go_to(*mark);
}

// Called where the program turns back or calls. Long bodies count for more, so that an endless
// program is stopped in seconds, whatever it does.
void MacroSource::count_jump() {
  constexpr long kLinesOfATurn = 10;
  if (++jumps_ <= most_jumps_ && lines_ <= kLinesOfATurn * most_jumps_) return;
  has_ended_ = true;
  refuse(static_cast<int>(line_.begin) + 1,
         fmt::format(
             "{} jumps, loop iterations and calls, {} lines; the program appears to loop endlessly",
             jumps_, lines_));
}

}  // namespace servomill::controllers::macro
