#include "controllers/gcode/readers/block_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/number_text.h"

namespace servomill::controllers {
namespace {

constexpr double kCodeTol = 1e-4;
constexpr std::string_view kAxisLetters = "XYZABC@^";

constexpr std::string_view kLineBlanks = " \t";

void describe_number(std::string_view text, BlockWord& word) {
  for (const char c : text.substr(1)) {
    word.has_point = word.has_point || c == '.';
    word.digits += c >= '0' && c <= '9' ? 1 : 0;
  }
}

}  // namespace

int tenths_of(double code) {
  const double tenths = std::floor(10.0 * code + 0.5);
  const bool is_code = std::abs(10.0 * code - tenths) <= 10.0 * kCodeTol;
  return is_code && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
}

std::string word_text(char letter, double value) {
  if (letter == 'G' || letter == 'M') return fmt::format("{}{}", letter, fixed_text(value, 1));
  std::string text = significant_text(value);
  if (letter == 'P' && text.find('.') == std::string::npos) text += '.';
  return letter + text;
}

BlockWords::BlockWords(std::string_view line, const Block& block, const Evaluate& evaluate)
    : line_(line) {
  std::size_t nth = 0;
  for (const Piece& piece : block.pieces) {
    const bool is_comment = piece.kind == PieceKind::comment;
    if (!is_comment) insert_at_ = static_cast<std::size_t>(piece.end);
    if (piece.kind != PieceKind::word) continue;
    const Word& word = block.words[nth++];
    BlockWord& out = words_.emplace_back();
    out.letter = word.letter;
    out.column = word.column;
    out.is_literal = word.value.is_constant();
    out.value = evaluate(word.value);
    out.begin = static_cast<std::size_t>(piece.begin);
    out.end = static_cast<std::size_t>(piece.end);
    if (out.is_literal) describe_number(line.substr(out.begin, out.end - out.begin), out);
  }
}

BlockWord* BlockWords::find(char letter) {
  for (BlockWord& word : words_) {
    if (word.letter == letter && !word.is_erased) return &word;
  }
  return nullptr;
}

const BlockWord* BlockWords::find(char letter) const {
  return const_cast<BlockWords*>(this)->find(letter);
}

BlockWord* BlockWords::code(char letter, int tenths) {
  for (BlockWord& word : words_) {
    if (word.letter == letter && !word.is_erased && tenths_of(word.value) == tenths) return &word;
  }
  return nullptr;
}

const BlockWord* BlockWords::code(char letter, int tenths) const {
  return const_cast<BlockWords*>(this)->code(letter, tenths);
}

bool BlockWords::has_axis() const {
  return std::any_of(kAxisLetters.begin(), kAxisLetters.end(), [&](char c) { return has(c); });
}

void BlockWords::erase(BlockWord& word) { word.is_erased = word.is_changed = true; }

void BlockWords::comment_out(BlockWord& word) {
  erase(word);
  word.is_kept_as_comment = true;
}

void BlockWords::erase(char letter) {
  if (BlockWord* word = find(letter)) erase(*word);
}

void BlockWords::set(char letter, double value, int column) {
  BlockWord* word = find(letter);
  if (word == nullptr) return add(letter, value, column);
  word->value = value;
  word->is_changed = true;
}

void BlockWords::add(char letter, double value, int column) {
  BlockWord word;
  word.letter = letter;
  word.value = value;
  word.column = column;
  word.is_changed = true;
  word.begin = word.end = insert_at_;
  words_.push_back(word);
}

bool BlockWords::is_changed() const {
  return std::any_of(words_.begin(), words_.end(),
                     [](const BlockWord& word) { return word.is_changed; });
}

// Unchanged parts of the line with the changed words between them; added words come behind all
// others, before a comment.
void BlockWords::write() const {
  written_.clear();
  std::size_t at = 0;
  const auto copy_until = [&](std::size_t end) {
    if (end > at) {
      written_.copy(std::string_view(line_).substr(at, end - at), static_cast<int>(at) + 1);
    }
    at = std::max(at, end);
  };
  for (const BlockWord& word : words_) {
    if (!word.is_changed || word.begin == word.end) continue;
    copy_until(word.begin);
    at = word.end;
    if (word.is_kept_as_comment) {
      written_.replace("(" + line_.substr(word.begin, word.end - word.begin) + ")", word.column);
      continue;
    }
    if (!word.is_erased) written_.replace(word_text(word.letter, word.value), word.column);
    if (word.is_erased) written_.trim_end(kLineBlanks);
  }
  copy_until(insert_at_);
  for (const BlockWord& word : words_) {
    if (word.is_erased || word.begin != word.end) continue;
    const std::string& text = written_.text();
    const bool is_first = text.empty() || kLineBlanks.find(text.back()) != kLineBlanks.npos;
    written_.replace((is_first ? "" : " ") + word_text(word.letter, word.value), word.column);
  }
  copy_until(line_.size());
}

std::string BlockWords::text() const {
  write();
  return written_.text();
}

}  // namespace servomill::controllers
