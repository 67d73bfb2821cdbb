// O-words, M98 and M99 of a line.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/gcode/parser.h"
#include "controllers/gcode/parser_text.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers {
namespace {

struct Keyword {
  std::string_view name;
  Flow flow;
};

// A keyword stands before those that are its beginning.
constexpr std::array<Keyword, 15> kKeywords = {{
    {"BREAK", Flow::break_},
    {"CALL", Flow::call},
    {"CONTINUE", Flow::continue_},
    {"DO", Flow::do_},
    {"ELSEIF", Flow::elseif},
    {"ELSE", Flow::else_},
    {"ENDIF", Flow::endif},
    {"ENDREPEAT", Flow::endrepeat},
    {"ENDSUB", Flow::endsub},
    {"ENDWHILE", Flow::endwhile},
    {"IF", Flow::if_},
    {"REPEAT", Flow::repeat},
    {"RETURN", Flow::return_},
    {"SUB", Flow::sub},
    {"WHILE", Flow::while_},
}};

constexpr auto kKeywordNames = [] {
  std::array<std::string_view, kKeywords.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kKeywords[i].name;
  return names;
}();

}  // namespace

// O-words, M98 and M99 come first in their block and stand alone in it.
void Parser::flow(Extent extent) {
  const std::size_t start = cursor_.at();
  OWord& o = block_->o_word;
  o.column = column();
  o.name = -1;
  o.has_value = false;
  o.arguments.clear();
  if (peek() == 'M') return subprogram_call(o);
  if (peek() != 'O') return;
  cursor_.advance();
  label(o);
  std::string_view keyword = "an O-word";
  if (cursor_.at_end() || peek() == '(' || peek() == ';') {
    o.flow = Flow::program;
  } else {
    const auto* found = std::find_if(kKeywords.begin(), kKeywords.end(),
                                     [&](const Keyword& k) { return accept(k.name); });
    if (found == kKeywords.end()) {
      if (extent != Extent::flow_only) fail_at_keyword();
      o.flow = Flow::unknown;
      return;
    }
    o.flow = found->flow;
    keyword = found->name;
  }
  if (extent == Extent::flow_only) return;
  if (o.flow == Flow::call) {
    arguments(o, start);
  } else {
    value_of_flow(o, keyword);
    add_piece(PieceKind::o_word, start);
  }
  if (extent == Extent::all) only_comments(keyword);
}

void Parser::fail_at_keyword() {
  if (!is_letter(peek())) fail_here(fmt::format("unexpected {} after an O-word", shown(peek())));
  const std::size_t at = cursor_.at();
  const std::string letters = take_letters(cursor_);
  fail(at, fmt::format("unknown keyword '{}' after an O-word{}", letters,
                       did_you_mean(letters, kKeywordNames)));
}

void Parser::label(OWord& o) {
  if (peek() == '<') {
    o.name = name_in_angles("label");
  } else {
    o.number = value("O");
  }
}

void Parser::value_of_flow(OWord& o, std::string_view keyword) {
  const bool needs_value = o.flow == Flow::if_ || o.flow == Flow::elseif ||
                           o.flow == Flow::while_ || o.flow == Flow::repeat;
  const bool may_have_value = needs_value || o.flow == Flow::return_ || o.flow == Flow::endsub;
  o.value_column = column();
  if (needs_value && peek() != '[') {
    fail_here(fmt::format("expected '[' after {}, found {}", keyword, shown(peek())));
  }
  if (!may_have_value || peek() != '[') return;
  o.has_value = true;
  o.value = bracketed_value(keyword);
}

// Comments may stand between them: then the O-word has several pieces.
void Parser::arguments(OWord& o, std::size_t start) {
  while (peek() == '[' || peek() == '(') {
    if (peek() == '[') {
      o.arguments.push_back(bracketed_value("CALL"));
      continue;
    }
    if (cursor_.at() > start) add_piece(PieceKind::o_word, start);
    comment();
    start = cursor_.at();
  }
  if (cursor_.at() > start) add_piece(PieceKind::o_word, start);
}

void Parser::only_comments(std::string_view keyword) {
  while (!cursor_.at_end()) {
    if (peek() != '(' && peek() != ';') {
      fail_here(fmt::format("unexpected {} after {}; an O-word must be in a separate block",
                            shown(peek()), keyword));
    }
    comment();
  }
}

// M98 P L and M99. M as the first word may also be any other code: then the cursor goes back.
void Parser::subprogram_call(OWord& o) {
  const std::size_t start = cursor_.at();
  const Cursor before = cursor_;
  cursor_.advance();
  if (!is_digit(peek())) {
    cursor_ = before;
    return;
  }
  const double code = number("M");
  if (code != 98.0 && code != 99.0) {
    cursor_ = before;
    return;
  }
  o.flow = code == 98.0 ? Flow::m98 : Flow::m99;
  const std::string_view keyword = code == 98.0 ? "M98" : "M99";
  add_piece(PieceKind::o_word, start);
  if (o.flow == Flow::m99) return only_comments(keyword);
  while (!cursor_.at_end()) item();
  bool has_P = false;
  for (const Word& word : block_->words) {
    if (word.letter == 'P') o.number = word.value;
    if (word.letter == 'L') o.value = word.value;
    if (word.letter == 'L') o.value_column = word.column;
    has_P = has_P || word.letter == 'P';
    o.has_value = o.has_value || word.letter == 'L';
  }
  if (!has_P) fail(start, "M98 requires a P word (subprogram number)");
}

}  // namespace servomill::controllers
