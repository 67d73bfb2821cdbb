// Labels, jumps, calls and Q parameters.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/conversational/formula.h"
#include "controllers/conversational/translator.h"

namespace servomill::controllers::conversational {
namespace {

constexpr std::size_t kMaxCalls = 19;  // in each other: TNC 640; 8 on the iTNC 530 (M)

}  // namespace

int Translator::whole(double value, int most, const Place& place, std::string_view what) const {
  if (value >= 0.0 && value <= most && value == std::floor(value)) return static_cast<int>(value);
  fail(place, fmt::format("{} {:g}: must be an integer from 0 to {}", what, value, most));
}

void Translator::go_to(const std::string& label) {
  const BlockMark* mark = program().find_label(label);
  if (mark == nullptr) fail(fmt::format("LBL {} is not defined in the program", label));
  run_.count_jump(place_);
  program().go_to(*mark);
}

// LBL 0 ends a subprogram; it has no effect where none was called.
void Translator::label(const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> all(block.words);
  const std::string name = label_of(block.words.size() > 1 ? all.subspan(1) : all);
  if (name != "0" || returns_.empty() || returns_.back().is_program) return;
  file_ = returns_.back().file;
  program().go_to(returns_.back().mark);
  returns_.pop_back();
}

void Translator::call(const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> words(block.words);
  if (words.size() < 3) fail("CALL requires LBL with a label or PGM with a program name");
  if (words[1].text == "PGM") return call_program(words.subspan(2));
  if (words[1].text != "LBL") fail(words[1].place, "expected CALL LBL or CALL PGM");
  // a name in quotation marks may hold blanks
  std::size_t end = 3;
  if (words[2].text.front() == '"') {
    while (end < words.size() && words[end - 1].text.back() != '"') ++end;
  }
  std::string name = label_of(words.subspan(2, end - 2));
  if (name.front() == 'Q') {
    name = fmt::format("{:.0f}", value(operand_of(name, words[2].place)));
  }
  call_label(name, words.subspan(end));
}

// REP 5, REP5, REP 5/5: the number after the slash counts the repeats the control has left to do.
// REP alone is an entry that was skipped in the dialog.
void Translator::call_label(const std::string& label, std::span<const HeidenhainWord> rest) {
  if (label == "0") fail("LBL 0 cannot be called");
  if (rest.empty() || (rest.size() == 1 && rest.front().text == "REP")) {
    if (returns_.size() >= kMaxCalls) {
      fail(fmt::format("calls nested deeper than {}", kMaxCalls));
    }
    const BlockMark behind = program().mark();
    go_to(label);
    returns_.push_back({file_, behind, false, label});
    return;
  }
  std::string text;
  for (const HeidenhainWord& word : rest) text += word.text;
  if (!text.starts_with("REP")) fail(rest.front().place, "expected REP");
  text = text.substr(3, text.find('/') - 3);
  constexpr int kMaxRepeats = 65534;  // [640] p. 631
  const Place& at = rest.front().place;
  const int wanted = whole(value(operand_of(text, at)), kMaxRepeats, at, "REP");
  const auto key = std::pair(file_, block_mark_.offset);
  auto [found, is_new] = repeats_.try_emplace(key, wanted);
  if (found->second <= 0) {
    repeats_.erase(found);
    return;
  }
  --found->second;
  go_to(label);
}

void Translator::call_program(std::span<const HeidenhainWord> words) {
  if (words.size() > 1) fail(words[1].place, "unexpected text after the program name");
  const std::string name = program_name(words.front().text);
  if (returns_.size() >= kMaxCalls) fail(fmt::format("calls nested deeper than {}", kMaxCalls));
  std::optional<ProgramText> text;
  if (setup_.subroutine_file) text = setup_.subroutine_file(name);
  if (!text) {
    fail(words.front().place, fmt::format("CALL PGM {0}: file {0}.H found neither next to the "
                                          "program nor in the folders of --subs",
                                          name));
  }
  require_no_compensation("CALL PGM");
  const std::size_t called = file_of_program(*text, name, words.front().place);
  run_.count_jump(place_);
  returns_.push_back({file_, program().mark(), true, name});
  file_ = called;
}

// Opens a program at its start. A file read before is used again, unless it is still running.
std::size_t Translator::file_of_program(ProgramText& text, const std::string& name,
                                        const Place& place) {
  for (std::size_t i = 1; i < files_.size(); ++i) {
    const bool is_running =
        i == file_ || std::any_of(returns_.begin(), returns_.end(),
                                  [i](const Return& one) { return one.file == i; });
    if (is_running || files_[i]->file() != text.file()) continue;
    files_[i]->begin();
    return i;
  }
  std::string all;
  for (std::string_view line; text.next(line);) all.append(line).append("\n");
  auto file = std::make_unique<ProgramFile>(std::move(all), text.file());
  if (!file->faults().empty()) throw InputError(file->faults());
  const auto begin = file->begin();
  const bool begins = begin && begin->words.size() > 2 && begin->words[0].text == "BEGIN";
  if (!begins) fail(place, fmt::format("{} does not begin with BEGIN PGM", name));
  if ((begin->words.back().text == "INCH") != is_inch_) {
    fail(place,
         fmt::format("CALL PGM {}: the called program must have the same unit (MM, INCH)", name));
  }
  files_.push_back(std::move(file));
  return files_.size() - 1;
}

void Translator::assign(const QName& name, double value) {
  parameters_.set(name, value);
  // CYCL DEF 247 takes effect with its parameter
  if (name == QName{'Q', 339} && cycle_ && cycle_->number == 247) {
    cycle_.reset();
    set_preset(value);
  }
}

// Q200=2 Q201=-20 after CYCL DEF.
void Translator::assign_words(Words& words) {
  bool is_behind_name = false;
  while (const HeidenhainWord* word = words.take_next()) {
    const std::size_t equals = word->text.find('=');
    std::size_t length = 0;
    const auto name = q_name_at(word->text, length);
    if (!name || equals != length) {
      if (name || word->address == "Q")
        fail(word->place,
             fmt::format("'{}' has no value; write it with '=' and a number", word->text));
      if (is_behind_name && word->address.size() <= 2 && !word->rest.empty()) {
        fail(
            word->place,
            fmt::format("'{}' is not allowed in a cycle definition; program it in a separate block",
                        word->text));
      }
      continue;  // the name of the cycle
    }
    is_behind_name = true;
    std::string text = word->text.substr(equals + 1);
    if (text.empty()) {
      const HeidenhainWord* more = words.take_next();
      if (more == nullptr) fail(word->place, fmt::format("'{}' requires a number", word->text));
      text = more->text;
    }
    const auto feed = feed_of_name(text, word->place);
    assign(*name, feed ? *feed : value(operand_of(text, word->place)));
  }
}

// FMAX and FAUTO as values; nullopt: another text.
std::optional<double> Translator::feed_of_name(const std::string& text, const Place& place) const {
  if (text == "FMAX" || text == "MAX") return 99999.999;
  if (text != "FAUTO" && text != "AUTO") return std::nullopt;
  if (!tool_call_feed_) fail(place, "FAUTO: the last TOOL CALL has no F");
  return *tool_call_feed_ / (is_inch_ ? 2.54 : 1.0);
}

// FN 14 ends a program with a message; FN 15, 16, 19, 20, 26, 27 and 38 write and wait, without
// motion.
bool Translator::run_function(const HeidenhainBlock& block) {
  const std::span<const HeidenhainWord> words(block.words);
  refresh_system_parameters();
  if (words[0].address != "FN") {
    const bool is_cycle_value = words[0].text.find('=') != std::string::npos && words.size() == 1;
    if (is_cycle_value) {
      Words all(words);
      assign_words(all);
      return true;
    }
    const Assignment made = evaluate_formula(words, parameters_);
    assign(made.name, made.value);
    return true;
  }
  const bool is_split = words[0].rest.empty();
  if (is_split && words.size() < 2) return false;
  std::string head = is_split ? words[1].text : words[0].rest;
  if (head.ends_with(':')) head.pop_back();
  const auto number = integer_of(head);
  if (!number) return false;
  const auto rest = words.subspan(is_split ? 2 : 1);
  if (rest.empty()) fail(fmt::format("FN {}: the operation is missing", *number));
  if (*number <= 8 || *number == 13) {
    const Assignment made = evaluate_function(static_cast<int>(*number), rest, parameters_);
    assign(made.name, made.value);
    return true;
  }
  if (*number <= 12) {
    const Jump jump = evaluate_jump(static_cast<int>(*number), rest, parameters_);
    if (jump.is_taken) go_to(jump.label);
    return true;
  }
  if (*number == 14) fail("FN 14: the program stops here with an error message");
  if (*number == 18 || *number == 28) return read_of_control(static_cast<int>(*number), rest);
  constexpr std::array kWithoutMotion = {15, 16, 19, 20, 26, 27, 38};
  if (std::find(kWithoutMotion.begin(), kWithoutMotion.end(), *number) != kWithoutMotion.end()) {
    warn_once(fmt::format("FN {}", *number),
              fmt::format("FN {} is ignored: no effect on motion", *number));
    return true;
  }
  fail(
      fmt::format("FN {} writes data of the control or PLC, with unknown effect; remove the block "
                  "if it causes no motion",
                  *number));
}

// FN 18: SYSREAD Q1 = ID270 NR1 IDX3, FN 28: TABREAD Q1 = 6/"DOC": the value is the control's; a
// block that needs it is refused, unless the user gave it.
bool Translator::read_of_control(int number, std::span<const HeidenhainWord> rest) {
  std::optional<QName> name;
  std::string text;
  for (const HeidenhainWord& word : rest) {
    std::size_t length = 0;
    const auto found = q_name_at(word.text, length);
    if (found && !name && text.find('=') == std::string::npos) name = found;
    text += (text.empty() ? "" : " ") + word.text;
  }
  if (!name) fail(fmt::format("FN {}: expected a Q parameter for the result", number));
  const bool is_given = setup_.parameters.contains(to_string(*name));
  if (is_given) {
    assign(*name, setup_.parameters.at(to_string(*name)));
  } else {
    parameters_.forget(
        *name,
        fmt::format("was read from the control (FN {}: {}; set it with --parameter {}=NUMBER)",
                    number, text, to_string(*name)));
  }
  warn_once(fmt::format("FN {} {}", number, to_string(*name)),
            is_given ? fmt::format("FN {}: {} set by --parameter", number, to_string(*name))
                     : fmt::format("FN {}: {} is unknown here; set it with --parameter {}=NUMBER",
                                   number, to_string(*name), to_string(*name)));
  return true;
}

// Tool, plane and unit: [530] preassigned Q parameters. Q120 to Q122 stay as PLANE leaves them.
void Translator::refresh_system_parameters() {
  parameters_.set({'Q', 109}, 2.0);
  const ToolEntry* tool = setup_.tools.find(tool_);
  if (!has_tool_call_ || tool == nullptr) return;
  if (!tools_without_radius_.contains(tool_)) {
    parameters_.set({'Q', 108}, tool->diameter / 2e-3 + delta_radius_);
  }
  parameters_.set({'Q', 114}, tool->offset[2] * 1e3 + delta_length_);
}

}  // namespace servomill::controllers::conversational
