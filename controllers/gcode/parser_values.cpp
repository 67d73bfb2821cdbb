// Values of a line: numbers, parameters, functions and expressions.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

#include "controllers/gcode/parser.h"
#include "controllers/gcode/parser_text.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers {
namespace {

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

const Operator* operator_at(Cursor cursor) {
  for (const Operator& op : kOperators) {
    if (cursor.accept(op.token)) return &op;
  }
  return nullptr;
}

constexpr int kMaxDigits = 15;  // whose number is exact in a double
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

}  // namespace

Value Parser::bracketed_value(std::string_view what) {
  Value out;
  out.begin = static_cast<int>(block_->code.size());
  real(what);
  out.end = static_cast<int>(block_->code.size());
  return out;
}

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
    fail(start, fmt::format("expected a value after {}, found {}", what, shown(peek())));
  }
  if (peek() == '.') fail_here("a second decimal point in one number");
  if (count <= kMaxDigits) {
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
    fail(start, fmt::format("expected a value after {}, found the word {}", what, name));
  }
  if (found == nullptr) {
    fail(start, fmt::format("unknown function '{}'{}", name, did_you_mean(name, kFunctionNames)));
  }
  if (peek() != '[') fail_here(fmt::format("expected '[' after {}", name));
  if (found->code == OpCode::has_number) {
    cursor_.advance();
    if (!accept("#")) fail_here("EXISTS requires a parameter, as in EXISTS[#<name>]");
    parameter(OpCode::has_number, OpCode::has_name);
    if (!accept("]")) fail_here("expected ']' after the parameter of EXISTS");
    return;
  }
  bracketed();
  if (found->code == OpCode::atan) {
    if (!accept("/")) fail_here("expected '/': ATAN requires two arguments, ATAN[y]/[x]");
    if (peek() != '[') fail_here("expected '[': ATAN requires two arguments, ATAN[y]/[x]");
    bracketed();
  }
  emit(found->code, here);
}

void Parser::bracketed() {
  const std::size_t start = cursor_.at();
  cursor_.advance();
  expression(1);
  if (cursor_.at_end()) fail(start, "'[' is not closed; ']' is missing");
  if (!accept("]")) fail_here(fmt::format("expected an operator or ']', found {}", shown(peek())));
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

}  // namespace servomill::controllers
