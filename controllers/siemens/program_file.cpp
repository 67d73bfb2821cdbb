#include "controllers/siemens/program_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/scanner.h"

namespace servomill::controllers::siemens {
namespace {

constexpr std::string_view kHeader = "%_N_";

bool is_header(std::string_view line) {
  return capitals(line.substr(0, kHeader.size())) == kHeader;
}

std::string_view without_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
    line.remove_suffix(1);
  }
  return line;
}

// Takes blanks, '/' with its level, and the block number from the front of a line.
void skip_front(Line& line) {
  const std::string_view all = line.text;
  std::size_t at = 0;
  const auto skip_blanks = [&] {
    while (at < all.size() && (all[at] == ' ' || all[at] == '\t')) ++at;
  };
  skip_blanks();
  if (at < all.size() && all[at] == '/') {
    line.is_optional = true;
    if (++at < all.size() && is_digit(all[at])) ++at;
    skip_blanks();
  }
  const bool has_number = at + 1 < all.size() &&
                          (all[at] == 'N' || all[at] == 'n' || all[at] == ':') &&
                          is_digit(all[at + 1]);
  if (has_number) {
    for (++at; at < all.size() && is_digit(all[at]);) ++at;
    skip_blanks();
  }
  line.column = at;
  line.text = all.substr(at);
}

bool is_structure_word(std::string_view word) {
  for (const std::string_view one : {"IF", "ELSE", "ENDIF", "WHILE", "ENDWHILE", "FOR", "ENDFOR",
                                     "LOOP", "ENDLOOP", "REPEAT", "UNTIL"}) {
    if (word == one) return true;
  }
  return false;
}

// The word that opens what this one closes.
std::string opener_of(std::string_view word) {
  if (word == "UNTIL") return "REPEAT";
  return std::string(word.substr(3));  // ENDIF, ENDWHILE, ...
}

// IF with a jump in its block, REPEAT with labels: no structures.
bool is_single_block(const std::string& word, std::string_view text) {
  const std::string all = capitals(text);
  if (word == "IF") return all.find("GOTO") != std::string::npos;
  return word == "REPEAT" && all.find_first_not_of(" \t\r", 0) != std::string::npos;
}

// Takes "X1" or "M06" from the front of words without blanks; 0 characters: there is none.
std::size_t length_of_address(std::string_view text) {
  if (text.size() < 2 || !is_letter(text[0]) || !is_digit(text[1])) return 0;
  return std::min(text.find_first_not_of("0123456789.", 1), text.size());
}

// M6 as a word, also in T1M6; not in MSG("TAP M6"), nor in a name.
bool changes_tool(std::string_view block) {
  bool is_quoted = false, is_in_name = false;
  for (std::size_t at = 0; at < block.size();) {
    const char c = block[at];
    if (c == '"') is_quoted = !is_quoted;
    const std::size_t length = is_quoted || is_in_name ? 0 : length_of_address(block.substr(at));
    const std::string address = capitals(block.substr(at, length));
    if (address == "M6" || address == "M06") return true;
    is_in_name = length == 0 && is_name_character(c);
    at += std::max<std::size_t>(length, 1);
  }
  return false;
}

}  // namespace

std::string program_name(std::string_view text) {
  std::string name = capitals(without_end(text));
  const std::size_t folder = name.find_last_of("/\\");
  if (folder != std::string::npos) name.erase(0, folder + 1);
  for (const std::string_view front : {"%_N_", "_N_"}) {
    if (name.starts_with(front)) name.erase(0, front.size());
  }
  name.erase(std::min(name.find_first_of(" \t;("), name.size()));
  for (const std::string_view end : {"_MPF", "_SPF", ".MPF", ".SPF"}) {
    if (name.size() > end.size() && name.ends_with(end)) name.erase(name.size() - end.size());
  }
  return name;
}

ProgramFile::ProgramFile(std::string text, std::string file)
    : text_(std::make_shared<const std::string>(std::move(text))), file_(std::move(file)) {
  end_ = text_->size();
  name_ = program_name(file_);
  split();
  index();
}

ProgramFile::ProgramFile(std::shared_ptr<const std::string> text, std::string file, BlockMark begin,
                         std::size_t end, std::string name)
    : text_(std::move(text)),
      file_(std::move(file)),
      name_(std::move(name)),
      begin_(begin),
      at_(begin),
      end_(end) {
  index();
}

// Ends this program at the header of a second one.
void ProgramFile::split() {
  struct Part {
    BlockMark begin;
    std::size_t end;
    std::string name;
  };
  std::vector<Part> parts;
  bool has_words = false;
  while (true) {
    const BlockMark before = at_;
    const std::size_t begin = at_.offset;
    if (begin >= text_->size()) break;
    const std::size_t end = std::min(text_->find('\n', begin), text_->size());
    const std::string_view line = without_end(std::string_view(*text_).substr(begin, end - begin));
    at_ = {end + 1, at_.line + 1};
    if (is_header(line) && (has_words || !parts.empty())) {
      if (parts.empty()) end_ = begin;
      if (!parts.empty()) parts.back().end = begin;
      parts.push_back({before, text_->size(), program_name(line)});
    } else if (is_header(line)) {
      name_ = program_name(line);
      has_words = true;
    } else if (!line.empty() && line.front() != ';' && line.front() != '%') {
      has_words = true;
    }
  }
  at_ = begin_;
  for (Part& part : parts) {
    others_.push_back(std::unique_ptr<ProgramFile>(
        new ProgramFile(text_, file_, part.begin, part.end, std::move(part.name))));
  }
}

std::optional<Line> ProgramFile::next() {
  while (at_.offset < end_) {
    const std::size_t end = std::min(text_->find('\n', at_.offset), end_);
    Line line;
    line.mark = at_;
    line.text = without_end(std::string_view(*text_).substr(at_.offset, end - at_.offset));
    while (!line.text.empty() && (line.text.back() == '\0' || line.text.back() == '\x1a')) {
      line.text.remove_suffix(1);  // which file transfers append
    }
    at_ = {end + 1, at_.line + 1};
    line.number = at_.line;
    if (line.text.starts_with('%')) continue;  // a name, or the start of a tape
    skip_front(line);
    if (line.text.empty() || line.text.front() == ';') continue;
    return line;
  }
  return std::nullopt;
}

void ProgramFile::index() {
  constexpr std::size_t kMaxFaults = 100;
  std::vector<Open> open;
  while (const auto line = next()) {
    if (faults_.size() >= kMaxFaults) break;
    index_label(*line);
    Scanner scanner(line->text, file_, line->number, line->column);
    std::string word = scanner.peek_name();
    if (word.size() > 1 && !is_digit(word[1])) {
      scanner.read_name();
      if (scanner.take(':')) word = scanner.peek_name();
    }
    if (is_structure_word(word)) {
      scanner.take_word(word);
      Line behind = *line;
      behind.text = scanner.rest();
      index_structure(behind, word, open);
    }
    const bool may_have_M = !has_M6_ && line->text.find_first_of("Mm") != line->text.npos;
    if (may_have_M) has_M6_ = changes_tool(scanner.rest());
  }
  for (const Open& one : open) {
    faults_.push_back({one.place, fmt::format("{} is not closed; its end is missing", one.word)});
  }
  at_ = begin_;
}

void ProgramFile::index_structure(const Line& line, const std::string& word,
                                  std::vector<Open>& open) {
  if (is_single_block(word, line.text)) return;
  const Place place{file_, line.number, static_cast<int>(line.column) + 1};
  const bool opens =
      word == "IF" || word == "WHILE" || word == "FOR" || word == "LOOP" || word == "REPEAT";
  if (opens) {
    open.push_back({word, line.mark, at_, place});
    return;
  }
  const std::string wanted = word == "ELSE" ? "IF" : opener_of(word);
  const bool is_else = !open.empty() && open.back().word == "ELSE" && wanted == "IF";
  if (open.empty() || (open.back().word != wanted && (!is_else || word == "ELSE"))) {
    faults_.push_back({place, fmt::format("{} requires {}", word, wanted)});
    return;
  }
  close(line, word, open);
  if (word == "ELSE") open.push_back({word, line.mark, at_, place});
}

// IF goes on behind ELSE or ENDIF, ELSE behind ENDIF; loops go on behind their end, which goes back
// to their begin.
void ProgramFile::close(const Line& line, const std::string& word, std::vector<Open>& open) {
  const Open opened = open.back();
  open.pop_back();
  partners_[opened.begin.offset] = at_;
  const bool is_branch = word == "ELSE" || word == "ENDIF";
  if (!is_branch)
    partners_[line.mark.offset] = opened.word == "REPEAT" ? opened.behind : opened.begin;
}

// "ROUGH: G1 X5": two letters or '_' at the begin.
void ProgramFile::index_label(const Line& line) {
  const std::size_t colon = line.text.find(':');
  constexpr std::size_t kLongest = 64;
  if (colon == line.text.npos || colon < 2 || colon > kLongest) return;
  const std::string_view name = line.text.substr(0, colon);
  if (is_digit(name.front()) ||
      !std::all_of(name.begin(), name.end(), [](char c) { return is_name_character(c); })) {
    return;
  }
  std::string key = capitals(name);
  labels_[key].push_back({key, line.mark});
}

// Read with the first jump to one: long programs have one in each line.
void ProgramFile::read_block_numbers() {
  if (std::exchange(has_block_numbers_, true)) return;
  const BlockMark now = at_;
  at_ = begin_;
  while (at_.offset < end_) {
    const BlockMark mark = at_;
    const std::size_t end = std::min(text_->find('\n', at_.offset), end_);
    std::string_view text = std::string_view(*text_).substr(mark.offset, end - mark.offset);
    at_ = {end + 1, at_.line + 1};
    text.remove_prefix(std::min(text.find_first_not_of("/ \t"), text.size()));
    if (text.empty() || (text.front() != 'N' && text.front() != 'n')) continue;
    std::size_t digits = 1;
    while (digits < text.size() && is_digit(text[digits])) ++digits;
    if (digits == 1) continue;
    const std::size_t zeros = std::min(text.find_first_not_of('0', 1), digits);
    std::string key = "N" + std::string(text.substr(zeros, digits - zeros));
    labels_[key].push_back({key, mark});
  }
  at_ = now;
}

const std::vector<Label>& ProgramFile::labels_of(const std::string& name) {
  static const std::vector<Label> kNone;
  const bool is_number = name.size() > 1 && name.front() == 'N' && is_digit(name[1]);
  if (is_number) read_block_numbers();
  std::string key = name;
  if (is_number) key = "N" + name.substr(std::min(name.find_first_not_of('0', 1), name.size()));
  const auto found = labels_.find(key);
  return found == labels_.end() ? kNone : found->second;
}

const Label* ProgramFile::label_behind(const std::string& name, const BlockMark& from) {
  for (const Label& label : labels_of(name)) {
    if (label.mark.offset >= from.offset) return &label;
  }
  return nullptr;
}

const Label* ProgramFile::label_before(const std::string& name, const BlockMark& from) {
  const Label* found = nullptr;
  for (const Label& label : labels_of(name)) {
    if (label.mark.offset < from.offset) found = &label;
  }
  return found;
}

const BlockMark* ProgramFile::partner(const BlockMark& mark) const {
  const auto found = partners_.find(mark.offset);
  return found == partners_.end() ? nullptr : &found->second;
}

ProgramFile* ProgramFile::subprogram(const std::string& name) const {
  for (const auto& other : others_) {
    if (other->name() == name) return other.get();
  }
  return nullptr;
}

std::set<std::string> ProgramFile::called_names() {
  std::set<std::string> names;
  begin();
  while (const auto line = next()) {
    Scanner scanner(line->text, file_, line->number, line->column);
    std::string name = scanner.peek_name();
    if (scanner.take_word("MCALL")) name = scanner.peek_name();
    if (scanner.take_word("CALL") || scanner.take_word("EXTCALL")) {
      scanner.take('(');
      scanner.skip_blanks();
      const std::size_t close = scanner.rest().find('"', 1);
      if (scanner.now() == '"' && close != line->text.npos) {
        name = program_name(scanner.rest().substr(1, close - 1));
      }
    }
    const bool is_address = name.size() > 1 && is_digit(name[1]) && name.front() != 'L';
    if (name.size() > 1 && !is_address && !is_code(name)) names.insert(name);
  }
  begin();
  for (const auto& other : others_) names.merge(other->called_names());
  return names;
}

}  // namespace servomill::controllers::siemens
