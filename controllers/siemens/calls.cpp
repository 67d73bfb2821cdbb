// Subprograms, definitions of variables, modal calls. [J] "Subprogram technique", "User-defined
// variables"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/expression.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr std::size_t kMaxCalls = 16;  // in each other: [J] "Subprogram nesting depth"
constexpr long kMaxRuns = 9999;        // P: [J] "Number of program repetitions"

// Words between DEF and the type: where a variable holds, and what happens to it.
bool is_attribute(std::string_view word) {
  for (const std::string_view one :
       {"NCK", "CHAN", "SYNR", "SYNW", "SYNRW", "PHU", "INIPO", "INIRE", "INICF", "PRLOC"}) {
    if (word == one) return true;
  }
  return false;
}

std::vector<int> read_sizes(Scanner& scanner, const Variables& variables) {
  std::vector<int> sizes;
  if (!scanner.take('[')) return sizes;
  do {
    const double size = evaluate_number(scanner, variables);
    constexpr double kMax = 1e6;
    if (!(size >= 1.0 && size <= kMax)) scanner.fail("the array size must be from 1 to 1e6");
    sizes.push_back(static_cast<int>(size));
  } while (scanner.take(','));
  scanner.expect(']', "the array size");
  return sizes;
}

}  // namespace

// DEF REAL A=1, B[3], DEF STRING[20] TEXT.
void Translator::define(Scanner& scanner) {
  std::string word = scanner.read_name();
  while (is_attribute(word)) word = scanner.read_name();
  const auto type = type_named(word);
  if (!type) {
    fail(fmt::format("DEF {}: only REAL, INT, BOOL, CHAR, STRING and AXIS are supported", word));
  }
  if (*type == Type::text) read_sizes(scanner, variables_);
  do {
    scanner.skip_blanks();
    Reference reference;
    reference.place = scanner.place();
    reference.name = scanner.read_name();
    if (reference.name.empty()) scanner.fail("DEF requires a variable name");
    variables_.define(reference.name, *type, read_sizes(scanner, variables_), reference.place);
    if (scanner.take('=')) assign(reference, scanner, variables_);
  } while (scanner.take(','));
  if (!scanner.at_end()) scanner.fail("DEF: unexpected text after the variables");
}

// PROC NAME(REAL A, VAR INT B, REAL C=5) SAVE DISPLOF: parameters take the values of the call.
void Translator::begin_procedure(Scanner& scanner) {
  scanner.read_name();
  if (scanner.take('(')) define_parameters(scanner);
  while (!scanner.at_end()) {
    const std::string word = scanner.read_name();
    if (word.empty()) scanner.fail("PROC: unexpected characters");
    if (word == "SAVE" && !returns_.empty()) returns_.back().saved = modes_;
    if (scanner.take('(')) scanner.read_to_parenthesis();
  }
}

void Translator::define_parameters(Scanner& scanner) {
  Return* caller = returns_.empty() || returns_.back().is_repetition ? nullptr : &returns_.back();
  std::size_t count = 0;
  if (scanner.take(')')) return;
  do {
    const bool is_output = scanner.take_word("VAR");
    const std::string word = scanner.read_name();
    const auto type = type_named(word);
    if (!type) fail(fmt::format("PROC: '{}' is not a type", word));
    if (*type == Type::text) read_sizes(scanner, variables_);
    scanner.skip_blanks();
    Reference parameter{scanner.read_name(), {}, scanner.place()};
    variables_.define(parameter.name, *type, read_sizes(scanner, variables_), parameter.place);
    if (scanner.take('=')) assign(parameter, scanner, variables_);
    if (caller == nullptr || count >= caller->call.arguments.size()) {
      ++count;
      continue;
    }
    const Argument& argument = caller->call.arguments[count++];
    if (argument.value) variables_.set(parameter, *argument.value);
    if (is_output && argument.variable) caller->outputs.emplace_back(parameter, *argument.variable);
  } while (scanner.take(','));
  scanner.expect(')', "the parameters of PROC");
  if (caller != nullptr && caller->call.arguments.size() > count) {
    fail(fmt::format("{} is called with {} parameters; PROC defines {}", caller->call.name,
                     caller->call.arguments.size(), count));
  }
}

// CALL "NAME", CALL TEXT.
void Translator::call_by_text(Scanner& scanner) {
  scanner.skip_blanks();
  Call call;
  call.place = scanner.place();
  const Value name = evaluate(scanner, variables_);
  if (!name.text) fail("CALL requires a program name in quotes");
  if (!scanner.at_end())
    fail("CALL BLOCK and CALL with parameters are not supported; write the program name");
  call.name = program_name(*name.text);
  call_subprogram(call, 1);
}

void Translator::execute_calls(const Block& block) {
  long repeats = 1;
  if (block.P) {
    const double P = block.P->value;
    if (P != std::floor(P) || P < 1.0 || P > kMaxRuns) {
      fail(block.P->place, fmt::format("P{:g}: must be an integer from 1 to {}", P, kMaxRuns));
    }
    repeats = static_cast<long>(P);
  }
  std::vector<Call> calls;
  for (const Call& one : block.calls) {
    if (!has_text_only(one.name)) calls.push_back(one);
  }
  if (block.L) {
    Call call;
    call.name = fmt::format("L{:.0f}", block.L->value);
    call.place = block.L->place;
    calls.push_back(std::move(call));
  }
  if (block.is_modal_call) {
    modal_call_.reset();
    if (calls.empty() || calls.front().name == "CYCLE80") return;
    if (calls.size() > 1) fail(calls[1].place, "MCALL accepts one program only");
    const Call& modal = calls.front();
    if (modal.name.starts_with("HOLES") || modal.name == "CYCLE832" || modal.name == "CYCLE800") {
      fail(modal.place,
           fmt::format("MCALL {}: only drilling cycles and subprograms can be called modally",
                       modal.name));
    }
    modal_call_ = modal;
    return;
  }
  if (calls.size() > 1) fail(calls[1].place, "the block contains more than one call");
  if (!calls.empty()) call(calls.front(), repeats);
}

void Translator::call_modal() {
  is_in_modal_call_ = true;
  const Call one = *modal_call_;
  call(one, 1);
  if (returns_.empty() || returns_.back().is_repetition || !returns_.back().is_modal) {
    is_in_modal_call_ = false;
  }
}

void Translator::call(const Call& call, long repeats) {
  if (ProgramFile* program = find_program(call.name)) return enter(program, call, repeats);
  if (repeats != 1) {
    fail(call.place,
         fmt::format("{}: P is allowed for subprograms only; program a loop", call.name));
  }
  if (run_cycle(call)) return;
  const std::string why = refusal_of(call.name);
  if (!why.empty()) fail(call.place, fmt::format("{}: {}", call.name, why));
  fail(call.place,
       fmt::format("{0}: unknown word, cycle or subprogram: file {0}.SPF found neither next to the "
                   "program nor in the folders of --subs (an empty one skips the call){1}",
                   call.name, similar_word(call.name)));
}

void Translator::call_subprogram(const Call& call, long repeats) {
  ProgramFile* program = find_program(call.name);
  if (program == nullptr) {
    fail(call.place,
         fmt::format("file {}.SPF found neither next to the program nor in the folders of --subs",
                     call.name));
  }
  enter(program, call, repeats);
}

// In the same archive, else in a file of its own.
ProgramFile* Translator::find_program(const std::string& name) {
  for (const auto& file : files_) {
    if (ProgramFile* found = file->subprogram(name)) return found;
    if (file != files_.front() && file->name() == name) return file.get();
  }
  if (!setup_.subroutine_file || has_text_only(name)) return nullptr;
  std::optional<ProgramText> text = setup_.subroutine_file(name);
  if (!text) return nullptr;
  std::string all;
  for (std::string_view line; text->next(line);) all.append(line).append("\n");
  files_.push_back(std::make_unique<ProgramFile>(std::move(all), text->file()));
  return files_.back().get();
}

void Translator::enter(ProgramFile* program, const Call& call, long repeats) {
  if (!program->faults().empty()) throw InputError(program->faults());
  const auto is_running = [&](const Return& one) { return one.program == program; };
  if (program == program_ || std::any_of(returns_.begin(), returns_.end(), is_running)) {
    fail(call.place, fmt::format("{} calls itself", call.name));
  }
  const auto calls = std::count_if(returns_.begin(), returns_.end(),
                                   [](const Return& one) { return !one.is_repetition; });
  if (static_cast<std::size_t>(calls) >= kMaxCalls) {
    fail(call.place, fmt::format("calls nested deeper than {}", kMaxCalls));
  }
  count_jump();
  Return one;
  one.program = program_;
  one.mark = program_->mark();
  one.left = repeats - 1;
  one.call = call;
  one.is_modal = is_in_modal_call_;
  returns_.push_back(std::move(one));
  program_ = program;
  program_->begin();
  variables_.begin_program();
}

// M17, RET, M2, M30 or the end of the text.
void Translator::leave_subprogram() {
  while (returns_.back().is_repetition) {
    returns_.pop_back();
    if (returns_.empty()) return end_program(30);
  }
  Return& back = returns_.back();
  std::vector<Value> outputs;
  for (const auto& [own, callers] : back.outputs) outputs.push_back(variables_.get(own));
  variables_.end_program();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    variables_.set(back.outputs[i].second, outputs[i]);
  }
  back.outputs.clear();
  if (back.saved) restore(*back.saved);
  back.saved.reset();
  if (back.left > 0) {
    --back.left;
    count_jump();
    variables_.begin_program();
    return program_->begin();
  }
  if (back.is_modal) is_in_modal_call_ = false;
  program_ = back.program;
  program_->go_to(back.mark);
  returns_.pop_back();
}

// SAVE: modal functions and the frame are those of the caller again.
void Translator::restore(const Modes& modes) {
  if (modes.offset != modes_.offset) {
    if (modes.offset == 0) fail("SAVE requires a work offset programmed before");
    put_offset(modes.offset);
    forget_positions();
  }
  if (modes.feed_code != modes_.feed_code) feed_.reset();
  if (modes.stops_exactly != modes_.stops_exactly) use_path(modes.stops_exactly);
  if (modes.normal != modes_.normal || modes.frame != modes_.frame) {
    pole_.reset();
    polar_angle_.reset();
  }
  modes_ = modes;
  last_element_.reset();
}

}  // namespace servomill::controllers::siemens
