#include "controllers/gcode/macro/expression.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::macro {
namespace {

enum Op : int {
  kMultiply,
  kDivide,
  kAnd,
  kModulo,
  kAdd,
  kSubtract,
  kOr,
  kXor,
  kEq,
  kNe,
  kGt,
  kGe,
  kLt,
  kLe
};

struct Operator {
  std::string_view token;
  Op op;
  int level;  // higher binds tighter
};

constexpr std::array<Operator, 14> kOperators = {{{"*", kMultiply, 3},
                                                  {"/", kDivide, 3},
                                                  {"AND", kAnd, 3},
                                                  {"MOD", kModulo, 3},
                                                  {"+", kAdd, 2},
                                                  {"-", kSubtract, 2},
                                                  {"OR", kOr, 2},
                                                  {"XOR", kXor, 2},
                                                  {"EQ", kEq, 1},
                                                  {"NE", kNe, 1},
                                                  {"GT", kGt, 1},
                                                  {"GE", kGe, 1},
                                                  {"LT", kLt, 1},
                                                  {"LE", kLe, 1}}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }
bool is_logic(int op) { return op == kAnd || op == kOr || op == kXor; }

const Operator* operator_at(Cursor cursor) {
  for (const Operator& one : kOperators) {
    if (cursor.accept(one.token)) return &one;
  }
  return nullptr;
}

// Closer than controls calculate: B-63174EN/03, table 13.3 (b), has errors of 1e-8 in SIN.
bool is_near(double a, double b) {
  return a != b && std::abs(a - b) <= 1e-8 * std::max({1.0, std::abs(a), std::abs(b)});
}

}  // namespace

double rounded_to(double x, double increment) {
  const double steps = x / increment;
  return std::trunc(steps + std::copysign(0.5 + 1e-9 * std::max(1.0, std::abs(steps)), steps)) *
         increment;
}

// ------------------------------------------------------------------------------------------ whole

MacroValue Expression::settled(const Term& term) const {
  if (term.is_doubtful) {
    refuse(term.column,
           "a vacant variable after a sign or alone in brackets: it is undocumented whether it is "
           "0 or remains vacant; remove the sign or brackets, or set it");
  }
  if (term.is_comparison && context_.reading.reader() == Reader::fanuc) {
    refuse(term.column, "a comparison is allowed only in IF and WHILE");
  }
  return term.value;
}

// X-#1 of a vacant variable is left out as X#1 is.
MacroValue Expression::word_value() {
  const bool is_minus = cursor_.peek() == '-';
  Cursor next = cursor_;
  if (is_minus || next.peek() == '+') next.advance();
  if (next.peek() != '#') return settled(operand());
  cursor_ = next;
  const Term term = operand();
  return term.value && is_minus ? MacroValue(-*term.value) : term.value;
}

MacroValue Expression::assigned_value() { return settled(expression()); }

bool Expression::condition() {
  const int column = cursor_.column();
  if (cursor_.peek() != '[') refuse(column, "expected '[': a condition must be in brackets");
  const Term term = bracketed();
  if (!term.is_comparison && context_.reading.reader() == Reader::fanuc) {
    refuse(column, "a condition must compare two values with EQ, NE, GT, GE, LT or LE");
  }
  return term.number() != 0.0;
}

long Expression::variable_number() {
  const int column = cursor_.column();
  if (cursor_.peek() == '#') refuse(column, "## is not supported; write #[#1]");
  if (cursor_.peek() != '[' && !is_digit(cursor_.peek())) {
    refuse(column, "expected a variable number after '#'");
  }
  std::uint64_t digits = 0;
  double number = 0.0;
  if (cursor_.peek() == '[') {
    const Term term = bracketed();
    if (!term.value) refuse(column, "the variable number is vacant");
    number = *term.value;
  } else {
    cursor_.take_digits(digits);
    number = static_cast<double>(digits);
  }
  const double nearest = std::round(number);
  if (std::abs(number - nearest) > 1e-4 || nearest < 0.0 || nearest > 1e7) {
    refuse(column, fmt::format("#[{}]: the variable number must be an integer", number));
  }
  return std::lround(nearest);
}

// --------------------------------------------------------------------------------------- operands

// Brackets go five deep with Fanuc (Series 16/18-C for lathes p. 287); the limit here keeps the
// stack small.
Expression::Term Expression::operand() {
  constexpr int kDeepest = 40;
  if (++depth_ > kDeepest) refuse(cursor_.column(), "brackets and signs are nested too deeply");
  const Term out = operand_within();
  --depth_;
  return out;
}

Expression::Term Expression::operand_within() {
  const int column = cursor_.column();
  const char c = cursor_.peek();
  if (c == '-' || c == '+') {
    cursor_.advance();
    return signed_operand(c == '-');
  }
  if (c == '[') return bracketed();
  if (c == '#') {
    cursor_.advance();
    const long number = variable_number();
    return {context_.variables.read(number, here(column)), false, false, column};
  }
  if (is_letter(c)) return function();
  std::string digits;
  for (; is_digit(cursor_.peek()) || cursor_.peek() == '.'; cursor_.advance()) {
    digits += cursor_.peek();
  }
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    refuse(column, digits.empty() ? "expected a value" : "not a number: " + digits);
  }
  return {number, false, false, column};
}

Expression::Term Expression::signed_operand(bool is_minus) {
  Term term = operand();
  if (!term.value) {
    term.is_doubtful = true;
  } else if (is_minus) {
    term.value = -*term.value;
  }
  return term;
}

Expression::Term Expression::bracketed() {
  const int column = cursor_.column();
  cursor_.advance();
  Term term = expression();
  if (cursor_.at_end()) refuse(column, "'[' is not closed; ']' is missing");
  if (!cursor_.accept("]")) refuse(cursor_.column(), "expected an operator or ']'");
  term.is_doubtful = !term.value;
  term.column = column;
  return term;
}

Expression::Term Expression::expression() {
  Seen seen;
  const int column = cursor_.column();
  Term term = expression(1, seen);
  const bool is_fanuc = context_.reading.reader() == Reader::fanuc;
  if (seen.logic && (seen.comparison || (seen.arithmetic && !is_fanuc))) {
    refuse(column,
           "AND, OR or XOR combined with other operators: the precedence differs between controls; "
           "put brackets around each part");
  }
  return term;
}

// Precedence climbing; `loosest` is the lowest level taken here.
Expression::Term Expression::expression(int loosest, Seen& seen) {
  Term left = operand();
  for (;;) {
    const Operator* op = operator_at(cursor_);
    if (op == nullptr || op->level < loosest) return left;
    const int column = cursor_.column();
    if (op->level == 1 && seen.comparison) {
      refuse(column, "more than one comparison; put brackets around each");
    }
    (op->level == 1 ? seen.comparison : is_logic(op->op) ? seen.logic : seen.arithmetic) = true;
    cursor_.accept(op->token);
    const Term right = expression(op->level + 1, seen);
    left = combine(op->op, left, right, column);
  }
}

Expression::Term Expression::combine(int op, const Term& a, const Term& b, int column) {
  Term out{0.0, false, op >= kEq, a.column};
  if (op >= kEq) {
    out.value = compare(op, a, b, column);
    return out;
  }
  if (is_logic(op)) {
    out.value = logic(op, a, b, column);
    out.is_comparison = a.is_comparison && b.is_comparison;
    return out;
  }
  const double x = a.number(), y = b.number();
  if ((op == kDivide || op == kModulo) && y == 0.0) refuse(column, "division by zero");
  out.value = op == kMultiply   ? x * y
              : op == kDivide   ? x / y
              : op == kAdd      ? x + y
              : op == kSubtract ? x - y
                                : remainder(x, y, column);
  if (!std::isfinite(*out.value)) refuse(column, "the result is not a finite number");
  return out;
}

// Vacant is 0 but for EQ and NE. Source: Fanuc B-63944EN, undefined variables (from memory);
// Mitsubishi M700V, Programming manual, 13.5 (the same table).
double Expression::compare(int op, const Term& a, const Term& b, int column) {
  const double x = a.number(), y = b.number();
  if (op == kEq || op == kNe) {
    settled(a);
    settled(b);
    const bool is_equal = a.value.has_value() == b.value.has_value() && x == y;
    if (a.value.has_value() != b.value.has_value()) return op == kNe ? 1.0 : 0.0;
    if (!is_near(x, y)) return is_equal == (op == kEq) ? 1.0 : 0.0;
  }
  if (is_near(x, y)) {
    context_.reading.warn(here(column),
                          fmt::format("the compared values, {:.10g} and a value {:.1g} away, "
                                      "differ by less than the precision of controls: another "
                                      "control may branch differently; compare with a tolerance",
                                      x, std::abs(x - y)));
  }
  const bool holds = op == kEq   ? x == y
                     : op == kNe ? x != y
                     : op == kGt ? x > y
                     : op == kGe ? x >= y
                     : op == kLt ? x < y
                                 : x <= y;
  return holds ? 1.0 : 0.0;
}

double Expression::logic(int op, const Term& a, const Term& b, int column) const {
  const auto bits = [&](const Term& term) {
    const double x = term.number();
    if (x < 0.0 || x != std::floor(x) || x > 4294967295.0) {
      refuse(column, fmt::format("{}: AND, OR and XOR require integers >= 0", x));
    }
    return static_cast<std::uint64_t>(x);
  };
  const std::uint64_t x = bits(a), y = bits(b);
  return static_cast<double>(op == kAnd ? x & y : op == kOr ? x | y : x ^ y);
}

double Expression::remainder(double a, double b, int column) const {
  const bool is_plain = a >= 0.0 && b > 0.0 && a == std::floor(a) && b == std::floor(b);
  if (is_plain) return std::fmod(a, b);
  context_.reading.choose(WordDifference::remainder, here(column));
  const double divisor = std::round(b);
  if (divisor == 0.0) refuse(column, "division by zero");
  return std::fmod(std::round(a), divisor);
}

}  // namespace servomill::controllers::macro
