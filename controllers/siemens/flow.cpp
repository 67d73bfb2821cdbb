// Structures, jumps and repetitions. [J] "Program jumps and branches", "Repeat program section",
// "Check structures"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/expression.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

bool is_jump(std::string_view word) {
  return word == "GOTO" || word == "GOTOF" || word == "GOTOB" || word == "GOTOC";
}

constexpr long kMaxRepeats = 9999;  // P: [J] "Repeat program section"

}  // namespace

void Translator::count_jump() {
  if (++jumps_ <= setup_.most_jumps) return;
  fail(fmt::format("{} jumps: the program looks endless; raise --max-jumps if intended",
                   setup_.most_jumps));
}

// A jump out of a part that is repeated ends its repetition.
void Translator::go_to(const BlockMark& mark) {
  count_jump();
  while (!returns_.empty() && returns_.back().is_repetition &&
         (mark.offset < returns_.back().begin.offset || mark.offset >= returns_.back().end)) {
    returns_.pop_back();
  }
  program_->go_to(mark);
}

double Translator::condition(Scanner& scanner) {
  const double value = evaluate_number(scanner, variables_);
  return value != 0.0 ? 1.0 : 0.0;
}

// True if the block belongs to the flow of the program or defines something.
bool Translator::flow(Scanner& scanner, const std::string& word, const Line& line) {
  const bool is_taken = word == "IF" || word == "ELSE" || word == "ENDIF" || word == "WHILE" ||
                        word == "ENDWHILE" || word == "FOR" || word == "ENDFOR" || word == "LOOP" ||
                        word == "ENDLOOP" || word == "REPEAT" || word == "REPEATB" ||
                        word == "UNTIL" || word == "ENDLABEL" || is_jump(word) || word == "DEF" ||
                        word == "PROC" || word == "EXTERN" || word == "RET" || word == "CALL" ||
                        word == "EXTCALL" || word == "CASE" || word == "REDEF";
  if (!is_taken) return false;
  scanner.take_word(word);
  if (word == "IF" || word == "ELSE" || word == "ENDIF") {
    if (word == "IF") branch(scanner, line);
    if (word == "ELSE") go_behind(line);
  } else if (word == "FOR") {
    count_loop(scanner, line);
  } else if (word == "ENDFOR") {
    end_count_loop(line);
  } else if (is_jump(word)) {
    jump(scanner, word);
  } else if (word == "REPEAT" || word == "REPEATB") {
    repeat(scanner, word, line);
  } else if (word == "DEF") {
    define(scanner);
  } else if (word == "PROC") {
    begin_procedure(scanner);
  } else if (word == "CASE") {
    choose(scanner);
  } else if (word == "CALL" || word == "EXTCALL") {
    call_by_text(scanner);
  } else if (word == "RET") {
    if (!scanner.at_end()) fail("RET with values is not supported");
    returns_.empty() ? end_program(30) : leave_subprogram();
  } else if (word == "EXTERN" || word == "ENDLABEL") {
    return true;
  } else if (word == "REDEF") {
    fail("REDEF is not supported");
  } else {
    loop(scanner, word, line);
  }
  return true;
}

void Translator::go_behind(const Line& line) {
  if (const BlockMark* partner = program_->partner(line.mark)) program_->go_to(*partner);
}

// IF ... GOTOF LABEL in one block; else a structure.
void Translator::branch(Scanner& scanner, const Line& line) {
  const bool is_true = condition(scanner) != 0.0;
  const std::string word = scanner.peek_name();
  if (is_jump(word)) {
    scanner.read_name();
    if (is_true) jump(scanner, word);
    return;
  }
  if (!scanner.at_end()) scanner.fail("IF: unexpected words behind the condition");
  if (!is_true) go_behind(line);
}

void Translator::loop(Scanner& scanner, const std::string& word, const Line& line) {
  const BlockMark* partner = program_->partner(line.mark);
  if (word == "WHILE") {
    if (condition(scanner) == 0.0) go_to(*partner);
  } else if (word == "UNTIL") {
    if (condition(scanner) == 0.0) go_to(*partner);
  } else if (word == "ENDWHILE" || word == "ENDLOOP") {
    go_to(*partner);
  }
}

// FOR variable = first TO last: the variable counts up by 1 and is compared before each run.
void Translator::count_loop(Scanner& scanner, const Line& line) {
  scanner.skip_blanks();
  if (scanner.peek_name().empty()) scanner.fail("FOR without a variable");
  const Reference counter = read_reference(scanner, variables_);
  scanner.expect('=', "the variable of FOR");
  const double first = evaluate_number(scanner, variables_);
  if (!scanner.take_word("TO")) scanner.fail("FOR without TO");
  const double last = evaluate_number(scanner, variables_);
  variables_.set(counter, {first});
  if (first <= last) return;
  if (const BlockMark* partner = program_->partner(line.mark)) go_to(*partner);
}

void Translator::end_count_loop(const Line& line) {
  const BlockMark behind = program_->mark();
  const BlockMark* begin = program_->partner(line.mark);
  program_->go_to(*begin);
  const Line head = *program_->next();
  Scanner scanner(head.text, program_->file(), head.number, head.column);
  if (!scanner.take_word("FOR")) {  // behind a label
    scanner.read_name();
    scanner.take(':');
    scanner.take_word("FOR");
  }
  const Reference counter = read_reference(scanner, variables_);
  scanner.expect('=', "the variable of FOR");
  evaluate_number(scanner, variables_);
  scanner.take_word("TO");
  const double last = evaluate_number(scanner, variables_);
  const double next = variables_.number(counter) + 1.0;
  if (next <= last) {
    variables_.set(counter, {next});
    count_jump();
  } else {
    program_->go_to(behind);
  }
}

// GOTOF searches towards the end, GOTOB towards the begin, GOTO towards the end and then from the
// begin; GOTOC goes on without an alarm.
void Translator::jump(Scanner& scanner, const std::string& word) {
  scanner.skip_blanks();
  std::string name = scanner.now() == '"' ? capitals(scanner.read_text()) : scanner.read_name();
  if (variables_.is_known(name) && !name.starts_with('$') && name != "R") {
    const Value target = variables_.get({name, {}, scanner.place()});
    name = target.text ? capitals(*target.text) : fmt::format("N{:g}", target.number);
  }
  if (name.empty()) scanner.fail(fmt::format("{} without a label", word));
  const Label* label = nullptr;
  const BlockMark here = program_->mark();
  if (word != "GOTOB") label = program_->label_behind(name, here);
  if (word != "GOTOF" && label == nullptr) label = program_->label_before(name, here);
  if (label == nullptr && word == "GOTOC") return;
  if (label == nullptr) {
    fail(fmt::format("{} {}: there is no such label {}", word, name,
                     word == "GOTOF"   ? "behind it"
                     : word == "GOTOB" ? "before it"
                                       : "in the program"));
  }
  go_to(label->mark);
}

// CASE R1 OF 1 GOTOF ONE 2 GOTOF TWO DEFAULT GOTOF OTHERS
void Translator::choose(Scanner& scanner) {
  const double value = evaluate_number(scanner, variables_);
  if (!scanner.take_word("OF")) scanner.fail("CASE without OF");
  while (!scanner.at_end()) {
    const bool is_chosen =
        scanner.take_word("DEFAULT") || evaluate_number(scanner, variables_) == value;
    const std::string word = scanner.read_name();
    if (!is_jump(word)) scanner.fail("CASE: expected GOTOF, GOTOB or GOTO behind a value");
    if (is_chosen) return jump(scanner, word);
    if (scanner.read_name().empty()) scanner.fail(fmt::format("{} without a label", word));
  }
}

// REPEAT LABEL P=n: from the label up to here; REPEAT LABEL LABEL P=n: between labels, the second
// of them ENDLABEL if it is not named; REPEATB LABEL P=n: the block of the label.
void Translator::repeat(Scanner& scanner, const std::string& word, const Line& line) {
  if (scanner.at_end()) return;  // REPEAT ... UNTIL
  std::vector<std::string> names;
  long times = 1;
  while (!scanner.at_end()) {
    const std::string name = scanner.read_name();
    if (name == "P" || (name.size() > 1 && name[0] == 'P' && is_digit(name[1]))) {
      const double P = name == "P" ? (scanner.take('='), evaluate_number(scanner, variables_))
                                   : std::stod(name.substr(1));
      if (!(P >= 0.0 && P <= kMaxRepeats)) fail("REPEAT: P must be from 1 to 9999");
      times = static_cast<long>(P);
      break;
    }
    if (name.empty()) scanner.fail("REPEAT: expected a label or P=");
    names.push_back(name);
  }
  if (names.empty()) fail("REPEAT with P and without a label");
  const BlockMark behind = program_->mark();
  const auto find = [&](const std::string& name) {
    const Label* label = program_->label_before(name, line.mark);
    if (label == nullptr) label = program_->label_behind(name, behind);
    if (label == nullptr) fail(fmt::format("{} {}: there is no such label", word, name));
    return label->mark;
  };
  const BlockMark begin = find(names.front());
  BlockMark end = line.mark;
  if (names.size() > 1 || word == "REPEATB") {
    program_->go_to(names.size() > 1 ? find(names[1]) : begin);
    program_->next();
    end = program_->mark();
    program_->go_to(behind);
  } else if (const Label* closing = program_->label_behind("ENDLABEL", begin); closing != nullptr) {
    end = closing->mark;
  }
  if (end.offset <= begin.offset)
    fail(fmt::format("{}: the second label is before the first", word));
  if (times == 0) return;
  constexpr std::size_t kMaxNested = 32;
  if (returns_.size() >= kMaxNested) fail("REPEAT and calls nested too deep");
  Return one;
  one.program = program_;
  one.mark = behind;
  one.left = times - 1;
  one.is_repetition = true;
  one.begin = begin;
  one.end = end.offset;
  returns_.push_back(one);
  count_jump();
  program_->go_to(begin);
}

// Behind the last block of a part that is repeated: once more, or on behind REPEAT.
bool Translator::end_repetition() {
  if (returns_.empty() || !returns_.back().is_repetition) return false;
  Return& one = returns_.back();
  if (one.program != program_ || program_->mark().offset < one.end) return false;
  if (one.left > 0) {
    --one.left;
    count_jump();
    program_->go_to(one.begin);
  } else {
    program_->go_to(one.mark);
    returns_.pop_back();
  }
  return true;
}

}  // namespace servomill::controllers::siemens
