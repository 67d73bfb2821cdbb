#include "controllers/gcode/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cstdint>
#include <utility>

#include "controllers/gcode/program_text.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kLetters = "ABCDFGHIJKLMPQRSTXYZ@^";

constexpr std::uint32_t kLetterBits = [] {
  std::uint32_t bits = 0;
  for (const char letter : kLetters) bits |= word_bit(letter);
  return bits;
}();

bool starts_word(char c) {
  return (c >= '@' && c <= 'Z' && (kLetterBits & word_bit(c)) != 0) || c == '^';
}

struct Operator {
  std::string_view token;
  OpCode code;
  int level;  // higher binds tighter
};

// A token stands before the tokens that are its prefix.
constexpr std::array<Operator, 15> kOperators = {{
    {"**", OpCode::power, 5},
    {"*", OpCode::multiply, 4},
    {"/", OpCode::divide, 4},
    {"MOD", OpCode::modulo, 4},
    {"+", OpCode::add, 3},
    {"-", OpCode::subtract, 3},
    {"EQ", OpCode::equal, 2},
    {"NE", OpCode::not_equal, 2},
    {"GT", OpCode::greater, 2},
    {"GE", OpCode::greater_equal, 2},
    {"LT", OpCode::less, 2},
    {"LE", OpCode::less_equal, 2},
    {"AND", OpCode::logical_and, 1},
    {"OR", OpCode::logical_or, 1},
    {"XOR", OpCode::logical_xor, 1},
}};

struct Function {
  std::string_view name;
  OpCode code;
};

constexpr std::array<Function, 14> kFunctions = {{
    {"ABS", OpCode::abs},
    {"ACOS", OpCode::acos},
    {"ASIN", OpCode::asin},
    {"ATAN", OpCode::atan},
    {"COS", OpCode::cos},
    {"EXISTS", OpCode::has_number},
    {"EXP", OpCode::exp},
    {"FIX", OpCode::fix},
    {"FUP", OpCode::fup},
    {"LN", OpCode::ln},
    {"ROUND", OpCode::round},
    {"SIN", OpCode::sin},
    {"SQRT", OpCode::sqrt},
    {"TAN", OpCode::tan},
}};

constexpr auto kFunctionNames = [] {
  std::array<std::string_view, kFunctions.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kFunctions[i].name;
  return names;
}();

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

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

const Operator* operator_at(Cursor cursor) {
  for (const Operator& op : kOperators) {
    if (cursor.accept(op.token)) return &op;
  }
  return nullptr;
}

// The run of letters where the cursor stands; it is left behind them.
std::string take_letters(Cursor& cursor) {
  std::string letters;
  for (; is_letter(cursor.peek()); cursor.advance()) letters += cursor.peek();
  return letters;
}

std::string shown(char c) { return c == '\0' ? "the end of the line" : fmt::format("'{}'", c); }

constexpr int kMostDigits = 15;  // whose number is exact in a double
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

}  // namespace

void Parser::fail(std::size_t at, std::string message) const {
  throw InputError({*file_, number_, static_cast<int>(at) + 1}, std::move(message));
}

void Parser::emit(OpCode code, int column, double value, int name) {
  block_->code.push_back({code, name, column, value});
}

// The piece ends where the cursor has come to, blanks before it left out.
void Parser::add_piece(PieceKind kind, std::size_t begin, char letter) {
  if (!keeps_pieces_) return;
  const std::string_view line = cursor_.line();
  std::size_t end = cursor_.at();
  while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\t')) --end;
  block_->pieces.push_back({kind, letter, static_cast<int>(begin), static_cast<int>(end)});
}

void Parser::parse(std::string_view line, const std::string& file, int number, Block& block,
                   Extent extent) {
  block.clear();
  block.line = number_ = number;
  block_ = &block;
  file_ = &file;
  letters_ = 0;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  cursor_ = Cursor(line);
  check_characters(line, file, number);
  if (block_delete_ && peek() == '/') {
    block.deleted = true;
    cursor_.go_to(line.size());
    add_piece(PieceKind::block_delete, line.find('/'));
    return;
  }
  const std::size_t start = cursor_.at();
  if (accept("%")) {
    if (!cursor_.at_end()) {
      fail(start, "'%' must stand alone on its line, first and last in the program");
    }
    block.percent = true;
    return add_piece(PieceKind::percent, start);
  }
  if (accept("/")) add_piece(PieceKind::block_delete, start);
  if (peek() == 'N') line_number();
  flow(extent);
  if (extent != Extent::all) return;
  while (!cursor_.at_end()) item();
}

void Parser::line_number() {
  const std::size_t start = cursor_.at();
  cursor_.advance();
  if (!is_digit(peek())) fail(start, "N must be followed by an unsigned number");
  skip_digits();
  if (accept(".")) {
    if (!is_digit(peek())) fail_here("a digit is expected behind the point of N");
    skip_digits();
  }
  add_piece(PieceKind::line_number, start);
}

void Parser::skip_digits() {
  while (is_digit(peek())) cursor_.advance();
}

void Parser::item() {
  const char c = peek();
  if (starts_word(c)) return word();
  if (c == '(' || c == ';') return comment();
  if (c == '#') return assignment();
  if (c == 'N') fail_here("N is only allowed at the start of a block");
  if (c == 'O') fail_here("an O-word must be the first word of its block");
  if (c == '%') fail_here("'%' must stand alone on its line, first and last in the program");
  fail_here(fmt::format("unexpected {}; a word starts with one of {}", shown(c), kLetters));
}

void Parser::comment() {
  const std::size_t start = cursor_.at();
  const std::string_view line = cursor_.line();
  if (peek() == ';') {
    cursor_.go_to(line.size());
    block_->pieces.push_back(
        {PieceKind::comment, '\0', static_cast<int>(start), static_cast<int>(line.size())});
    return;
  }
  const std::size_t close = line.find(')', start);
  block_->message = classify_comment(line.substr(start + 1, close - start - 1), column());
  cursor_.go_to(close);
  cursor_.advance();
  add_piece(PieceKind::comment, start);
}

void Parser::word() {
  const std::size_t start = cursor_.at();
  Word word;
  word.letter = peek();
  word.column = column();
  cursor_.advance();
  word.value = value(std::string_view(&word.letter, 1));
  if (word.letter != 'G' && word.letter != 'M') {
    const std::uint32_t bit = word_bit(word.letter);
    if ((letters_ & bit) != 0) {
      const auto first = std::find_if(block_->words.begin(), block_->words.end(),
                                      [&](const Word& w) { return w.letter == word.letter; });
      fail(start, fmt::format("second {} word in one block; the first is in column {}", word.letter,
                              first->column));
    }
    letters_ |= bit;
  }
  block_->words.push_back(word);
  add_piece(PieceKind::word, start, word.letter);
}

void Parser::assignment() {
  const std::size_t start = cursor_.at();
  Assignment assignment;
  assignment.column = column();
  cursor_.advance();
  if (peek() == '<') {
    assignment.name = name_in_angles("parameter name");
  } else {
    assignment.index = value("#");
  }
  if (!accept("=")) fail_here(fmt::format("'=' expected after a parameter, not {}", shown(peek())));
  assignment.value = value("=");
  block_->assignments.push_back(assignment);
  add_piece(PieceKind::assignment, start);
}

// ----------------------------------------------------------------------------------- flow control

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
    fail_here(fmt::format("'[' expected after {}, not {}", keyword, shown(peek())));
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
      fail_here(fmt::format("unexpected {} after {}; an O-word stands alone in its block",
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
  if (!has_P) fail(start, "M98 needs a P word, the number of a subprogram");
}

Value Parser::bracketed_value(std::string_view what) {
  Value out;
  out.begin = static_cast<int>(block_->code.size());
  real(what);
  out.end = static_cast<int>(block_->code.size());
  return out;
}

// ----------------------------------------------------------------------------------------- values

// Plain numbers are by far the most frequent values: they bypass the stack machine.
Value Parser::value(std::string_view what) {
  const char c = peek();
  const Cursor before = cursor_;
  if (c == '-' || c == '+') cursor_.advance();
  Value out;
  if (is_digit(peek()) || peek() == '.') {
    out.number = number(what);
    if (c == '-') out.number = -out.number;
    return out;
  }
  cursor_ = before;
  return bracketed_value(what);
}

void Parser::real(std::string_view what) {
  const int here = column();
  if (accept("-")) {
    real(what);
    emit(OpCode::negate, here);
  } else if (accept("+")) {
    real(what);
  } else if (peek() == '[') {
    bracketed();
  } else if (accept("#")) {
    parameter(OpCode::numbered, OpCode::named);
  } else if (is_letter(peek())) {
    function(what);
  } else {
    const double x = number(what);
    emit(OpCode::push, here, x);
  }
}

// Up to fifteen digits divided by a power of ten up to 10^22 are rounded once, hence correctly.
double Parser::number(std::string_view what) {
  const std::size_t start = cursor_.at();
  std::uint64_t digits = 0;
  int count = 0, decimals = 0;
  count = cursor_.take_digits(digits);
  if (peek() == '.') {
    cursor_.advance();
    decimals = cursor_.take_digits(digits);
    count += decimals;
  }
  if (count == 0) {
    fail(start, fmt::format("a value is expected after {}, not {}", what, shown(peek())));
  }
  if (peek() == '.') fail_here("a second decimal point in one number");
  if (count <= kMostDigits) {
    return static_cast<double>(digits) / kPowersOfTen[static_cast<std::size_t>(decimals)];
  }
  std::string text(cursor_.line().substr(start, cursor_.at() - start));
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  double x = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), x);
  return x;
}

void Parser::parameter(OpCode numbered, OpCode named) {
  const int here = column() - 1;
  if (peek() == '<') {
    const int name = name_in_angles("parameter name");
    emit(named, here, 0.0, name);
    return;
  }
  real("#");
  emit(numbered, here);
}

// In small letters and without blanks; an index into Block::names.
int Parser::name_in_angles(std::string_view what) {
  const std::size_t start = cursor_.at();
  cursor_.advance();
  std::string name;
  for (char c = peek(); c != '>'; c = peek()) {
    if (c == '\0') fail(start, fmt::format("{} is not closed; '>' is missing", what));
    if (c == '(' || c == ';') fail_here(fmt::format("comment within a {}", what));
    name += is_letter(c) ? static_cast<char>(c - 'A' + 'a') : c;
    cursor_.advance();
  }
  cursor_.advance();
  block_->names.push_back(std::move(name));
  return static_cast<int>(block_->names.size()) - 1;
}

void Parser::function(std::string_view what) {
  const std::size_t start = cursor_.at();
  const int here = column();
  const std::string name = take_letters(cursor_);
  const Function* found = nullptr;
  for (const Function& f : kFunctions) {
    if (f.name == name) found = &f;
  }
  if (found == nullptr && name.size() == 1) {  // the letter of the next word
    fail(start, fmt::format("a value is expected after {}, not the word {}", what, name));
  }
  if (found == nullptr) {
    fail(start, fmt::format("unknown function '{}'{}", name, did_you_mean(name, kFunctionNames)));
  }
  if (peek() != '[') fail_here(fmt::format("'[' expected after {}", name));
  if (found->code == OpCode::has_number) {
    cursor_.advance();
    if (!accept("#")) fail_here("EXISTS takes a parameter, like EXISTS[#<name>]");
    parameter(OpCode::has_number, OpCode::has_name);
    if (!accept("]")) fail_here("']' expected after the parameter of EXISTS");
    return;
  }
  bracketed();
  if (found->code == OpCode::atan) {
    if (!accept("/")) fail_here("'/' expected: ATAN takes two arguments, ATAN[y]/[x]");
    if (peek() != '[') fail_here("'[' expected: ATAN takes two arguments, ATAN[y]/[x]");
    bracketed();
  }
  emit(found->code, here);
}

void Parser::bracketed() {
  const std::size_t start = cursor_.at();
  cursor_.advance();
  expression(1);
  if (cursor_.at_end()) fail(start, "'[' is not closed; ']' is missing");
  if (!accept("]")) fail_here(fmt::format("operator or ']' expected, not {}", shown(peek())));
}

// Precedence climbing; `loosest` is the lowest level taken here.
void Parser::expression(int loosest) {
  real("'[' or an operator");
  for (;;) {
    const Operator* op = operator_at(cursor_);
    if (op == nullptr || op->level < loosest) return;
    const int here = column();
    accept(op->token);
    expression(op->level + 1);
    emit(op->code, here);
  }
}

std::string print_line(std::string_view line, const Block& block) {
  std::string out;
  const auto blanks = [&](std::size_t begin, std::size_t end) {
    const std::string_view gap = line.substr(begin, end - begin);
    assert(is_blank(gap));
    out += gap;
  };
  std::size_t at = 0;
  for (const Piece& piece : block.pieces) {
    const auto begin = static_cast<std::size_t>(piece.begin);
    const auto end = static_cast<std::size_t>(piece.end);
    blanks(at, begin);
    out += line.substr(begin, end - begin);
    at = end;
  }
  blanks(at, line.size());
  return out;
}

}  // namespace servomill::controllers
