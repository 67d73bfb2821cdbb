#include "controllers/gcode/parser.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kLetters = "ABCDFGHIJKLMPQRSTXYZ";

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

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

const Operator* operator_at(std::string_view text) {
  for (const Operator& op : kOperators) {
    if (text.substr(0, op.token.size()) == op.token) return &op;
  }
  return nullptr;
}

// The run of letters at the front of `text`.
std::string_view leading_name(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && is_letter(text[n])) ++n;
  return text.substr(0, n);
}

std::string shown(char c) { return c == '\0' ? "the end of the line" : fmt::format("'{}'", c); }

}  // namespace

void Parser::fail(std::size_t at, std::string message) const {
  throw InputError({file_, number_, line_.column_at(at)}, std::move(message));
}

bool Parser::accept(std::string_view token) {
  if (std::string_view(line_.text).substr(at_, token.size()) != token) return false;
  at_ += token.size();
  return true;
}

void Parser::emit(OpCode code, int column, double value, int name) {
  block_->code.push_back({code, name, column, value});
}

void Parser::parse(std::string_view line, int number, Block& block) {
  block.clear();
  block.line = number_ = number;
  block_ = &block;
  at_ = comments_taken_ = 0;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  const std::size_t first = line.find_first_not_of(" \t");
  if (block_delete_ && first != std::string_view::npos && line[first] == '/') {
    block.deleted = true;
    return;
  }
  read_line(line, file_, number, line_);
  if (line_.text == "%") {
    block.percent = true;
    return;
  }
  accept("/");
  if (peek() == 'N') line_number();
  while (at_ < line_.text.size()) item();
}

void Parser::line_number() {
  const std::size_t start = at_++;
  if (!is_digit(peek())) fail(start, "N must be followed by an unsigned number");
  skip_digits();
  if (accept(".")) skip_digits();
}

void Parser::skip_digits() {
  while (is_digit(peek())) ++at_;
}

void Parser::item() {
  const char c = peek();
  if (c == '(') return take_comment();
  if (c == '#') return assignment();
  if (c == 'N') fail_here("N is only allowed at the start of a block");
  if (c == 'O') fail_here("O-words (subroutines, loops, conditions) are not supported yet");
  if (c == '%') fail_here("'%' must stand alone on its line, first and last in the program");
  if (kLetters.find(c) == std::string_view::npos) {
    fail_here(fmt::format("unexpected {}; a word starts with one of {}", shown(c), kLetters));
  }
  word();
}

void Parser::take_comment() {
  ++at_;
  Comment& comment = line_.comments[comments_taken_++];
  if (comment.kind != CommentKind::plain) block_->messages.push_back(std::move(comment));
}

void Parser::word() {
  const std::size_t start = at_;
  const char letter = line_.text[at_++];
  Word word;
  word.letter = letter;
  word.column = line_.column_at(start);
  word.value = value(std::string_view(&line_.text[start], 1));
  if (letter != 'G' && letter != 'M') {
    for (const Word& other : block_->words) {
      if (other.letter == letter) {
        fail(start, fmt::format("second {} word in one block; the first is in column {}", letter,
                                other.column));
      }
    }
  }
  block_->words.push_back(word);
}

void Parser::assignment() {
  Assignment assignment;
  assignment.column = column();
  ++at_;
  if (peek() == '<') {
    assignment.name = parameter_name();
  } else {
    assignment.index = value("#");
  }
  if (!accept("=")) fail_here(fmt::format("'=' expected after a parameter, not {}", shown(peek())));
  assignment.value = value("=");
  block_->assignments.push_back(assignment);
}

// Plain numbers are by far the most frequent values: they bypass the stack machine.
Value Parser::value(std::string_view what) {
  const char c = peek();
  const bool is_signed = c == '-' || c == '+';
  const char next = is_signed && at_ + 1 < line_.text.size() ? line_.text[at_ + 1] : c;
  Value out;
  if (is_digit(next) || next == '.') {
    if (is_signed) ++at_;
    out.number = number(what);
    if (c == '-') out.number = -out.number;
    return out;
  }
  out.begin = static_cast<int>(block_->code.size());
  real(what);
  out.end = static_cast<int>(block_->code.size());
  return out;
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
    function();
  } else {
    const double x = number(what);
    emit(OpCode::push, here, x);
  }
}

double Parser::number(std::string_view what) {
  const std::size_t start = at_;
  skip_digits();
  if (accept(".")) skip_digits();
  const std::string_view digits = std::string_view(line_.text).substr(start, at_ - start);
  if (digits.empty() || digits == ".") {
    fail(start, fmt::format("a value is expected after {}, not {}", what, shown(peek())));
  }
  if (peek() == '.') fail(start, fmt::format("'{}.' is not a number", digits));
  double x = 0.0;
  std::from_chars(digits.data(), digits.data() + digits.size(), x);
  return x;
}

void Parser::parameter(OpCode numbered, OpCode named) {
  const int here = line_.column_at(at_ - 1);
  if (peek() == '<') {
    const int name = parameter_name();
    emit(named, here, 0.0, name);
    return;
  }
  real("#");
  emit(numbered, here);
}

int Parser::parameter_name() {
  const std::size_t start = at_++;
  const std::size_t close = line_.text.find('>', at_);
  if (close == std::string::npos) fail(start, "parameter name is not closed; '>' is missing");
  if (close == at_) fail(start, "parameter name is empty");
  std::string name = line_.text.substr(at_, close - at_);
  if (name.find('(') != std::string::npos) fail(start, "comment within a parameter name");
  for (char& c : name) {
    if (is_letter(c)) c = static_cast<char>(c - 'A' + 'a');
  }
  at_ = close + 1;
  block_->names.push_back(std::move(name));
  return static_cast<int>(block_->names.size()) - 1;
}

void Parser::function() {
  const std::size_t start = at_;
  const int here = column();
  const std::string_view name = leading_name(std::string_view(line_.text).substr(at_));
  const Function* found = nullptr;
  for (const Function& f : kFunctions) {
    if (f.name == name) found = &f;
  }
  if (found == nullptr) {
    fail(start, fmt::format("unknown function '{}'{}", name, did_you_mean(name, kFunctionNames)));
  }
  at_ += name.size();
  if (peek() != '[') fail_here(fmt::format("'[' expected after {}", name));
  if (found->code == OpCode::has_number) {
    ++at_;
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
  const std::size_t start = at_++;
  expression(1);
  if (peek() == '\0') fail(start, "'[' is not closed; ']' is missing");
  if (!accept("]")) fail_here(fmt::format("operator or ']' expected, not {}", shown(peek())));
}

// Precedence climbing; `loosest` is the lowest level taken here.
void Parser::expression(int loosest) {
  real("'[' or an operator");
  for (;;) {
    const Operator* op = operator_at(std::string_view(line_.text).substr(at_));
    if (op == nullptr || op->level < loosest) return;
    const int here = column();
    at_ += op->token.size();
    expression(op->level + 1);
    emit(op->code, here);
  }
}

}  // namespace servomill::controllers
