#include "controllers/conversational/program_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "controllers/conversational/words.h"

namespace servomill::controllers::conversational {

std::string label_of(std::span<const HeidenhainWord> words) {
  std::string text;
  for (const HeidenhainWord& word : words) text += (text.empty() ? "" : " ") + word.text;
  if (text.starts_with("LBL") && words.size() == 1) text.erase(0, 3);  // LBL5
  if (const auto number = integer_of(text)) return fmt::format("{}", *number);
  return text;
}

std::string program_name(std::string_view text) {
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  const std::size_t folder = text.find_last_of("\\/:");
  if (folder != std::string_view::npos) text.remove_prefix(folder + 1);
  const std::size_t dot = text.rfind('.');
  if (dot != std::string_view::npos) text = text.substr(0, dot);
  return std::string(text);
}

ProgramFile::ProgramFile(std::string text, std::string file)
    : text_(std::move(text)), file_(std::move(file)) {
  // characters that file transfers append after the last line
  while (!text_.empty() && (text_.back() == '\0' || text_.back() == '\x1a')) text_.pop_back();
  blank_title();
  index();
}

// Lines in brackets before BEGIN PGM: titles and set-up sheets that programming systems write.
void ProgramFile::blank_title() {
  std::size_t begin = 0;
  while (begin < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    const std::size_t first = text_.find_first_not_of(" \t\r", begin);
    if (first < end && text_[first] != '(') return;
    if (first < end) {
      std::fill(text_.begin() + static_cast<std::ptrdiff_t>(begin),
                text_.begin() + static_cast<std::ptrdiff_t>(end), ' ');
      ++lines_before_begin_;
    }
    begin = end + 1;
  }
}

// "N5 L X+1": programs for simulators of the control have such numbers; the control's have none.
void ProgramFile::take_number_with_N(HeidenhainBlock& block) {
  if (block.words.empty() || block.number || block.words.front().address != "N") return;
  const auto number = integer_of(block.words.front().rest);
  if (!number) return;
  block.number = *number;
  block.words.erase(block.words.begin());
  if (!block.words.empty()) block.place = block.words.front().place;
  has_numbers_with_N_ = true;
}

// "L X+10 (SIDE 1)": the comments of simulators and posts. Blocks with formulas and patterns have
// brackets of their own.
void ProgramFile::drop_bracket_comment(HeidenhainBlock& block) {
  auto& words = block.words;
  if (words.empty() || words.back().text.back() != ')') return;
  const std::string& address = words.front().address;
  const bool has_brackets =
      address == "PATTERN" || address == "FN" || address.starts_with('Q') || address == "CYCL";
  if (has_brackets && words.front().text.front() != '(') return;
  const auto begin = std::find_if(words.begin(), words.end(), [](const HeidenhainWord& word) {
    return word.text.front() == '(';
  });
  const auto closes = [](const HeidenhainWord& word) { return word.text.back() == ')'; };
  if (begin == words.end() || std::find_if(begin, words.end(), closes) != words.end() - 1) return;
  words.erase(begin, words.end());
  has_bracket_comments_ = true;
}

namespace {

bool are_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

// "TOOL DEF1" is TOOL DEF 1, and "CYCL DEF9 .0" is CYCL DEF 9.0: posts put blanks as they like.
void set_blanks_of_definition(HeidenhainBlock& block) {
  auto& words = block.words;
  const bool is_definition =
      words.size() > 1 &&
      ((words[1].address == "DEF" && (words[0].text == "TOOL" || words[0].text == "CYCL")) ||
       (words[1].address == "PGM" && words[0].text == "CALL"));
  if (!is_definition) return;
  if (!words[1].rest.empty()) {
    HeidenhainWord number = words[1];
    number.address.clear();
    number.text = number.rest;
    number.place.column += 3;
    words[1].text = words[1].address;
    words[1].rest.clear();
    words.insert(words.begin() + 2, number);
  }
  const bool is_split = words.size() > 3 && are_digits(words[2].text) &&
                        words[3].text.front() == '.' && are_digits(words[3].text.substr(1));
  if (!is_split) return;
  words[2].text += words[3].text;
  words[2].rest = words[2].text;
  words.erase(words.begin() + 3);
}

}  // namespace

std::optional<HeidenhainBlock> ProgramFile::next() {
  const std::string_view rest = std::string_view(text_).substr(at_.offset);
  HeidenhainBlocks blocks(rest, file_, at_.line, true);
  const auto advance = [&] { at_ = {text_.size() - blocks.rest().size(), blocks.line()}; };
  try {
    auto block = blocks.next();
    advance();
    if (!block) return block;
    take_number_with_N(*block);
    drop_bracket_comment(*block);
    set_blanks_of_definition(*block);
    return block;
  } catch (const InputError&) {
    advance();
    throw;
  }
}

std::optional<HeidenhainBlock> ProgramFile::begin() {
  at_ = {};
  auto block = next();
  while (block && block->words.empty()) block = next();
  return block;
}

const BlockMark* ProgramFile::find_label(const std::string& label) const {
  const auto found = labels_.find(label);
  return found == labels_.end() ? nullptr : &found->second;
}

void ProgramFile::index() {
  constexpr std::size_t kMaxFaults = 100;
  while (at_.offset < text_.size() && faults_.size() < kMaxFaults) {
    try {
      const auto block = next();
      if (block && !block->words.empty()) index(*block);
    } catch (const InputError& error) {
      faults_.insert(faults_.end(), error.faults().begin(), error.faults().end());
    }
  }
  at_ = {};
}

void ProgramFile::index(const HeidenhainBlock& block) {
  const auto& words = block.words;
  const std::string& first = words.front().text;
  const std::string second = words.size() > 1 ? words[1].text : "";
  if (first == "TOOL" && second == "DEF") tool_definitions_.push_back(block);
  if (first == "CALL" && second == "PGM" && words.size() > 2) called_.push_back(words[2].text);
  if (words.front().address != "LBL") return;
  const std::span<const HeidenhainWord> all(words);
  const std::string label = label_of(words.size() > 1 ? all.subspan(1) : all);
  if (label == "0" || label.empty()) return;
  if (!labels_.emplace(label, at_).second) {
    faults_.push_back({block.place, fmt::format("LBL {} appears twice", label)});
  }
}

}  // namespace servomill::controllers::conversational
