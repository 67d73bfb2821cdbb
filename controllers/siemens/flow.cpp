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
  constexpr auto kStandAlone =
      std::to_array<std::string_view>({"ELSE", "ENDIF", "ENDWHILE", "ENDFOR", "LOOP", "ENDLOOP"});
  constexpr auto kOthers = std::to_array<std::string_view>(
      {"IF", "WHILE", "FOR", "REPEAT", "REPEATB", "UNTIL", "ENDLABEL", "DEF", "PROC", "EXTERN",
       "RET", "CALL", "EXTCALL", "CASE", "REDEF"});
  const auto is_in = [&](const auto& all) {
    return std::find(all.begin(), all.end(), word) != all.end();
  };
  const bool stands_alone = is_in(kStandAlone);
  if (!stands_alone && !is_in(kOthers) && !is_jump(word)) return false;
  scanner.take_word(word);
  if (stands_alone) require_end(scanner, word);
  if (!define_or_call(scanner, word)) go_on(scanner, word, line);
  return true;
}

// True for a word that defines, calls or returns.
bool Translator::define_or_call(Scanner& scanner, const std::string& word) {
  if (word == "EXTERN") return true;
  if (word == "REDEF") fail("REDEF is not supported");
  if (word == "DEF") {
    define(scanner);
  } else if (word == "PROC") {
    begin_procedure(scanner);
  } else if (word == "CALL" || word == "EXTCALL") {
    call_by_text(scanner);
  } else if (word == "RET") {
    if (!scanner.at_end()) fail("RET with parameters is not supported");
    returns_.empty() ? end_program(30) : leave_subprogram();
  } else {
    return false;
  }
  return true;
}

// Words that decide which block comes next.
void Translator::go_on(Scanner& scanner, const std::string& word, const Line& line) {
  if (word == "IF") {
    branch(scanner, line);
  } else if (word == "ELSE") {
    go_behind(line);
  } else if (word == "ENDIF") {
    return;
  } else if (word == "FOR") {
    count_loop(scanner, line);
  } else if (word == "ENDFOR") {
    end_count_loop(line);
  } else if (is_jump(word)) {
    const std::string target = read_target(scanner, word);
    require_end(scanner, target);
    jump(word, target);
  } else if (word == "REPEAT" || word == "REPEATB") {
    repeat(scanner, word, line);
  } else if (word == "CASE") {
    choose(scanner);
  } else if (word == "ENDLABEL") {
    fail("ENDLABEL is a label; write ENDLABEL:");
  } else {
    loop(scanner, word, line);
  }
}

void Translator::go_behind(const Line& line) {
  if (const BlockMark* partner = program_->partner(line.mark)) program_->go_to(*partner);
}

// Words that nothing would read.
void Translator::require_end(Scanner& scanner, std::string_view what) {
  if (!scanner.at_end()) scanner.fail(fmt::format("unexpected text after {}", what));
}

// IF ... GOTOF LABEL in one block, several of them one after the other; else a structure.
void Translator::branch(Scanner& scanner, const Line& line) {
  const bool is_true = condition(scanner) != 0.0;
  const std::string word = scanner.peek_name();
  if (is_jump(word)) {
    scanner.read_name();
    const std::string target = read_target(scanner, word);
    if (scanner.peek_name() != "IF") require_end(scanner, target);
    if (is_true) return jump(word, target);
    if (scanner.take_word("IF")) branch(scanner, line);
    return;
  }
  require_end(scanner, "the condition of IF");
  if (!is_true) go_behind(line);
}

void Translator::loop(Scanner& scanner, const std::string& word, const Line& line) {
  const BlockMark* partner = program_->partner(line.mark);
  if (word == "WHILE" || word == "UNTIL") {
    const bool is_true = condition(scanner) != 0.0;
    require_end(scanner, fmt::format("the condition of {}", word));
    if (!is_true) go_to(*partner);
  } else if (word == "ENDWHILE" || word == "ENDLOOP") {
    go_to(*partner);
  }
}

// FOR variable = first TO last: the variable counts up by 1 and is compared before each run.
void Translator::count_loop(Scanner& scanner, const Line& line) {
  scanner.skip_blanks();
  if (scanner.peek_name().empty()) scanner.fail("FOR requires a variable");
  const Reference counter = read_reference(scanner, variables_);
  scanner.expect('=', "the variable of FOR");
  const double first = evaluate_number(scanner, variables_);
  if (!scanner.take_word("TO")) scanner.fail("FOR requires TO");
  const double last = evaluate_number(scanner, variables_);
  require_end(scanner, "FOR");
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
    variables_.forget(counter,
                      "is the counter of a finished FOR loop: it holds the last value or the next "
                      "one, depending on the control");
    program_->go_to(behind);
  }
}

std::string Translator::read_target(Scanner& scanner, const std::string& word) {
  scanner.skip_blanks();
  std::string name = scanner.now() == '"' ? capitals(scanner.read_text()) : scanner.read_name();
  if (name.empty()) scanner.fail(fmt::format("{} requires a label", word));
  return name;
}

// GOTOF searches towards the end, GOTOB towards the begin, GOTO towards the end and then from the
// begin; GOTOC goes on without an alarm.
void Translator::jump(const std::string& word, std::string name) {
  if (variables_.is_known(name) && !name.starts_with('$') && name != "R") {
    const Value target = variables_.get({name, {}, place_});
    name = target.text ? capitals(*target.text) : fmt::format("N{:g}", target.number);
  }
  const Label* label = nullptr;
  const BlockMark here = program_->mark();
  if (word != "GOTOB") label = program_->label_behind(name, here);
  if (word != "GOTOF" && label == nullptr) label = program_->label_before(name, here);
  if (label == nullptr && word == "GOTOC") return;
  if (label == nullptr) {
    fail(fmt::format("{} {}: label not found {}", word, name,
                     word == "GOTOF"   ? "after it"
                     : word == "GOTOB" ? "before it"
                                       : "in the program"));
  }
  go_to(label->mark);
}

// CASE R1 OF 1 GOTOF ONE 2 GOTOF TWO DEFAULT GOTOF OTHERS
void Translator::choose(Scanner& scanner) {
  const double value = evaluate_number(scanner, variables_);
  if (!scanner.take_word("OF")) scanner.fail("CASE requires OF");
  while (!scanner.at_end()) {
    const bool is_chosen =
        scanner.take_word("DEFAULT") || evaluate_number(scanner, variables_) == value;
    const std::string word = scanner.read_name();
    if (!is_jump(word)) scanner.fail("CASE: expected GOTOF, GOTOB or GOTO after a value");
    const std::string target = read_target(scanner, word);
    if (is_chosen) return jump(word, target);
  }
}

// REPEAT LABEL LABEL P=n
Translator::Repetition Translator::read_repetition(Scanner& scanner) {
  Repetition out;
  while (!scanner.at_end()) {
    const std::string name = scanner.read_name();
    if (name == "P" || (name.size() > 1 && name[0] == 'P' && is_digit(name[1]))) {
      const double P = name == "P" ? (scanner.take('='), evaluate_number(scanner, variables_))
                                   : std::stod(name.substr(1));
      if (!(P >= 0.0 && P <= kMaxRepeats) || P != std::floor(P)) {
        fail("REPEAT: P must be an integer from 0 to 9999");
      }
      out.times = static_cast<long>(P);
      require_end(scanner, "P");
      return out;
    }
    if (name.empty()) scanner.fail("REPEAT: expected a label or P=");
    out.labels.push_back(name);
  }
  return out;
}

// The block behind ENDLABEL.
BlockMark Translator::behind_end_label(const BlockMark& mark) {
  program_->go_to(mark);
  const Line line = *program_->next();
  Scanner scanner(line.text, program_->file(), line.number, line.column);
  scanner.read_name();
  scanner.take(':');
  if (!scanner.at_end()) {
    scanner.fail(
        "text after ENDLABEL: it is undocumented whether REPEAT repeats it; program it in the next "
        "block");
  }
  return program_->mark();
}

// The part of REPEAT LABEL ends at ENDLABEL, or at the block of REPEAT where none stands before it;
// that of REPEAT LABEL LABEL behind the block of the second, that of REPEATB behind its own block.
BlockMark Translator::end_of_part(const std::vector<BlockMark>& labels, bool is_block,
                                  const BlockMark& repeat) {
  if (is_block || labels.size() > 1) {
    program_->go_to(labels.back());
    program_->next();
    return program_->mark();
  }
  const Label* closing = program_->label_behind("ENDLABEL", labels.front());
  const bool is_ahead = labels.front().offset > repeat.offset;
  if (closing != nullptr && (is_ahead || closing->mark.offset < repeat.offset)) {
    return behind_end_label(closing->mark);
  }
  if (is_ahead) fail("REPEAT of a section after it requires ENDLABEL: at the end of the section");
  return repeat;
}

void Translator::repeat(Scanner& scanner, const std::string& word, const Line& line) {
  if (scanner.at_end()) return;  // REPEAT ... UNTIL
  const Repetition repetition = read_repetition(scanner);
  const std::size_t most = word == "REPEATB" ? 1 : 2;
  if (repetition.labels.empty() || repetition.labels.size() > most) {
    fail(fmt::format("{} requires {}", word, most == 1 ? "one label" : "one or two labels"));
  }
  const BlockMark behind = program_->mark();
  std::vector<BlockMark> labels;
  for (const std::string& name : repetition.labels) {
    const Label* label = program_->label_before(name, line.mark);
    if (label == nullptr) label = program_->label_behind(name, behind);
    if (label == nullptr) fail(fmt::format("{} {}: label not found", word, name));
    labels.push_back(label->mark);
  }
  const BlockMark begin = labels.front();
  const BlockMark end = end_of_part(labels, word == "REPEATB", line.mark);
  program_->go_to(behind);
  if (end.offset <= begin.offset)
    fail(fmt::format("{}: the second label must be after the first", word));
  if (begin.offset <= line.mark.offset && line.mark.offset < end.offset) {
    fail(fmt::format(
        "{}: the repeated section contains this block; repeat a section before or after it", word));
  }
  if (repetition.times == 0) return;
  constexpr std::size_t kMaxNested = 32;
  if (returns_.size() >= kMaxNested) fail("REPEAT and calls are nested too deeply");
  Return one;
  one.program = program_;
  one.mark = behind;
  one.left = repetition.times - 1;
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
