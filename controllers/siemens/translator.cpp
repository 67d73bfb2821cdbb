#include "controllers/siemens/translator.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/siemens/codes.h"

namespace servomill::controllers::siemens {

Translator::Translator(std::string text, std::string file, const ProgramSetup& setup)
    : setup_(setup),
      path_(lines_, {"G41 and G42", "G40", "G0", "G1", "RND=", "CHR="}),
      run_(lines_, path_, setup_.most_jumps),
      variables_(setup.parameters) {
  files_.push_back(std::make_unique<ProgramFile>(std::move(text), std::move(file)));
  program_ = files_.front().get();
  tool_ = setup_.tool;
}

std::optional<GcodeLine> Translator::next() {
  return run_.next([this] { run_block(); });
}

void Translator::begin_program() {
  has_begun_ = true;
  if (!program_->faults().empty()) throw InputError(program_->faults());
  place_ = {program_->file(), 1, 1};
  lines_.put("G17 G21 G40 G49 G80 G90 G91.1 G94", place_);
}

void Translator::run_block() {
  if (!has_begun_) begin_program();
  if (end_repetition()) return;
  const auto line = program_->next();
  run_.count_block(place_);
  if (!line) {
    place_ = {program_->file(), std::max(program_->line(), 1), 0};
    if (!returns_.empty()) return leave_subprogram();
    warn_once("end", "the program ends without M30: treated as if M30 followed");
    return end_program(30);
  }
  place_ = {program_->file(), line->number, static_cast<int>(line->column) + 1};
  if (line->is_optional && setup_.block_delete) return;
  execute(*line);
}

void Translator::execute(const Line& line) {
  Scanner scanner(line.text, program_->file(), line.number, line.column);
  std::string word = scanner.peek_name();
  const bool may_be_label = word.size() > 1 && !is_digit(word[1]);
  if (may_be_label) {
    const std::size_t begin = scanner.position();
    scanner.read_name();
    if (scanner.take(':')) {
      if (scanner.at_end()) return;
      word = scanner.peek_name();
    } else {
      scanner.go_to(begin);
    }
  }
  const bool is_address = word.size() < 2 || is_digit(word[1]);  // most blocks begin so
  if (!is_address) {
    if (flow(scanner, word, line)) return;
    const std::string why = is_code(word) ? "" : refusal_of(word);
    if (!why.empty()) scanner.fail(fmt::format("{}: {}", word, why));
  }
  execute_block(read_block(scanner, variables_));
}

void Translator::sort_codes(const Block& block) {
  codes_.fill(nullptr);
  for (const Code& one : block.codes) {
    const auto group = group_of(one.name);
    if (!group) {
      const std::string why = refusal_of(one.name);
      fail(one.place, why.empty() ? fmt::format("{} is not supported", one.name)
                                  : fmt::format("{}: {}", one.name, why));
    }
    const Code*& slot = codes_[static_cast<std::size_t>(*group)];
    if (slot != nullptr && slot->name != one.name && *group != Group::without_effect) {
      fail(one.place, fmt::format("{} and {} in one block (same G group)", slot->name, one.name));
    }
    slot = &one;
    is_programmed_[static_cast<std::size_t>(*group)] = true;
  }
}

void Translator::execute_block(const Block& block) {
  sort_codes(block);
  refuse_switched_on(block);
  set_modes(block);
  refuse_unread(block);
  warn_of_settings(block);
  tools(block);
  set_speed(block);
  begin_functions(block);
  const bool is_action = act(block);
  if (!is_action && moves(block)) {
    move(block);
    if (modal_call_ && !is_in_modal_call_) call_modal();
  }
  if (is_action || !moves(block)) count_block_behind_corner();
  execute_calls(block);
  end_functions(block);
}

void Translator::end_program(int m) {
  path_.flush();
  lines_.put(fmt::format("M{}", m), place_);
  run_.end();
}

void Translator::warn_once(const std::string& key, std::string message) {
  if (warned_.insert(key).second) warnings_.push_back({place_, std::move(message)});
}

// A machine or setting datum: the user's, or as the control is delivered.
double Translator::setting(const std::string& name, double as_delivered) const {
  return variables_.given(name).value_or(as_delivered);
}

}  // namespace servomill::controllers::siemens
