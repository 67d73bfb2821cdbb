// Priority of operators, from the first: NOT; * / DIV MOD; + -; B_AND; B_XOR; B_OR; AND; XOR; OR;
// <<; comparisons. 840D sl, Job Planning, "Priority of operations".
#include "controllers/siemens/expression.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

constexpr int kMaxNested = 200;

class Evaluator {
 public:
  Evaluator(Scanner& scanner, const Variables& variables)
      : scanner_(scanner), variables_(variables) {}

  Value comparison();
  Reference reference();

 private:
  [[noreturn]] void fail(std::string message) const { scanner_.fail(std::move(message)); }
  double number(const Value& value) const {
    if (value.text) fail("expected a number, not a string");
    return value.number;
  }
  long bits(const Value& value) const;
  Value joined();
  Value logic(std::size_t level);
  Value sum();
  Value product();
  Value unary();
  Value primary();
  Value function(const std::string& name, const Place& place);
  double function_of_one(const std::string& name, double x, const Place& place) const;
  std::vector<Value> arguments(const std::string& name);
  int read_index();

  Scanner& scanner_;
  const Variables& variables_;
  int depth_ = 0;
};

// Numbers are equal within a relative 1e-12: Job Planning, "Precision correction on comparison
// errors".
bool are_equal(const Value& a, const Value& b) {
  if (a.text || b.text) return a.text == b.text;
  constexpr double kEqual = 1e-12;
  return std::abs(a.number - b.number) <= kEqual * std::max(std::abs(a.number), std::abs(b.number));
}

bool compare(std::string_view sign, const Value& a, const Value& b) {
  const bool is_equal = are_equal(a, b);
  if (sign == "==") return is_equal;
  if (sign == "<>") return !is_equal;
  const bool is_less = a.text ? *a.text < *b.text : a.number < b.number;
  if (sign == "<=") return is_equal || is_less;
  if (sign == ">=") return is_equal || !is_less;
  return sign == "<" ? !is_equal && is_less : !is_equal && !is_less;
}

Value Evaluator::comparison() {
  Value left = joined();
  bool is_first = true;
  while (true) {
    if (scanner_.rest().starts_with("<<")) return left;
    std::string_view found;
    for (const std::string_view sign : {"==", "<>", "<=", ">=", "<", ">"}) {
      if (!scanner_.take_sign(sign)) continue;
      found = sign;
      break;
    }
    if (found.empty()) return left;
    if (!is_first) {
      fail(
          "two comparisons without parentheses: AND, OR and XOR take precedence over == and <; "
          "write (...) AND (...)");
    }
    is_first = false;
    const Value right = joined();
    if (left.text.has_value() != right.text.has_value())
      fail("a string cannot be compared with a number");
    left = {compare(found, left, right) ? 1.0 : 0.0};
  }
}

// Texts joined by <<.
Value Evaluator::joined() {
  const auto text_of = [](const Value& value) {
    return value.text ? *value.text : fmt::format("{:g}", value.number);
  };
  constexpr std::size_t kLongest = 10'000;
  Value left = logic(0);
  while (scanner_.take_sign("<<")) {
    left.text = text_of(left) + text_of(logic(0));
    if (left.text->size() > kLongest) fail("the string is too long");
  }
  return left;
}

long Evaluator::bits(const Value& value) const {
  constexpr double kMax = 2147483648.0;
  const double x = number(value);
  if (std::abs(x) > kMax) fail(fmt::format("{:g} is not a 32-bit integer", x));
  return std::lround(x);
}

// OR, XOR, AND, then the same of bits.
Value Evaluator::logic(std::size_t level) {
  constexpr std::array<std::string_view, 6> kWords = {"OR", "XOR", "AND", "B_OR", "B_XOR", "B_AND"};
  if (level == kWords.size()) return sum();
  Value left = logic(level + 1);
  while (scanner_.take_word(kWords[level])) {
    const Value right = logic(level + 1);
    const bool is_bits = level > 2;
    const long a = is_bits ? bits(left) : (number(left) != 0.0 ? 1 : 0);
    const long b = is_bits ? bits(right) : (number(right) != 0.0 ? 1 : 0);
    const std::size_t kind = level % 3;
    left = {static_cast<double>(kind == 0 ? a | b : kind == 1 ? a ^ b : a & b)};
  }
  return left;
}

Value Evaluator::sum() {
  Value left = product();
  while (true) {
    if (scanner_.take('+')) {
      left = {number(left) + number(product())};
    } else if (scanner_.take('-')) {
      left = {number(left) - number(product())};
    } else {
      return left;
    }
  }
}

// "/" divides integers to a real number, DIV and MOD to integers: Job Planning, "Arithmetic
// functions".
Value Evaluator::product() {
  Value left = unary();
  while (true) {
    const bool is_division = scanner_.take('/');
    const bool is_whole = !is_division && scanner_.take_word("DIV");
    const bool is_rest = !is_division && !is_whole && scanner_.take_word("MOD");
    if (is_division || is_whole || is_rest) {
      const double a = number(left), b = number(unary());
      if (b == 0.0) fail("division by zero");
      left = {is_division ? a / b : is_whole ? std::trunc(a / b) : std::fmod(a, b)};
    } else if (scanner_.take('*')) {
      left = {number(left) * number(unary())};
    } else {
      if (!std::isfinite(left.number)) fail("the result is too large");
      return left;
    }
  }
}

Value Evaluator::unary() {
  if (++depth_ > kMaxNested) fail("the expression is nested too deeply");
  Value out;
  if (scanner_.take('-')) {
    out = {-number(unary())};
  } else if (scanner_.take('+')) {
    out = {number(unary())};
  } else if (scanner_.take_word("NOT")) {
    out = {number(unary()) == 0.0 ? 1.0 : 0.0};
  } else if (scanner_.take_word("B_NOT")) {
    out = {static_cast<double>(~bits(unary()))};
  } else {
    out = primary();
  }
  --depth_;
  return out;
}

Value Evaluator::primary() {
  if (scanner_.take('(')) {
    Value value = comparison();
    scanner_.expect(')', "the expression");
    return value;
  }
  if (scanner_.is_at_number()) return {scanner_.read_number()};
  if (scanner_.now() == '"') return {0.0, scanner_.read_text()};
  const Place place = scanner_.place();
  const std::string name = scanner_.peek_name();
  if (name.empty()) scanner_.read_number();  // says what is there instead
  if (name == "TRUE" || name == "FALSE") {
    scanner_.read_name();
    return {name == "TRUE" ? 1.0 : 0.0};
  }
  if (name == "$PI") {
    scanner_.read_name();
    return {std::numbers::pi};
  }
  const std::size_t begin = scanner_.position();
  scanner_.read_name();
  if (!variables_.is_known(name) && scanner_.take('(')) return function(name, place);
  scanner_.go_to(begin);
  return variables_.get(reference());
}

std::vector<Value> Evaluator::arguments(const std::string& name) {
  std::vector<Value> out;
  do {
    out.push_back(comparison());
  } while (scanner_.take(','));
  scanner_.expect(')', name);
  return out;
}

double Evaluator::function_of_one(const std::string& name, double x, const Place& place) const {
  const auto refuse = [&](bool is_outside) {
    if (is_outside) throw InputError(place, fmt::format("{}({:g}) is undefined", name, x));
  };
  if (name == "SIN") return std::sin(x * deg);
  if (name == "COS") return std::cos(x * deg);
  if (name == "TAN") return std::tan(x * deg);
  if (name == "ABS") return std::abs(x);
  if (name == "POT") return x * x;
  if (name == "TRUNC") return std::trunc(x);
  if (name == "ROUND") return std::round(x);
  if (name == "ROUNDUP") return x < 0.0 ? std::floor(x) : std::ceil(x);
  if (name == "EXP") return std::exp(x);
  if (name == "ASIN" || name == "ACOS") {
    refuse(std::abs(x) > 1.0);
    return (name == "ASIN" ? std::asin(x) : std::acos(x)) / deg;
  }
  if (name == "SQRT") {
    refuse(x < 0.0);
    return std::sqrt(x);
  }
  if (name == "LN") {
    refuse(x <= 0.0);
    return std::log(x);
  }
  throw InputError(place, fmt::format("function '{}(...)' is not supported", name));
}

// ATAN2(y, x): the angle of the sum of two vectors, -180 to 180 degrees.
Value Evaluator::function(const std::string& name, const Place& place) {
  if (name == "ISVAR") fail("ISVAR queries machine variables, which are unknown");
  const std::vector<Value> all = arguments(name);
  const auto need = [&](std::size_t count) {
    if (all.size() == count) return;
    throw InputError(place, fmt::format("{} requires {} arguments", name, count));
  };
  if (name == "STRLEN") {
    need(1);
    if (!all[0].text) throw InputError(place, "STRLEN requires a string");
    return {static_cast<double>(all[0].text->size())};
  }
  if (name == "ATAN2" || name == "MINVAL" || name == "MAXVAL") {
    need(2);
    const double a = number(all[0]), b = number(all[1]);
    return {name == "ATAN2" ? std::atan2(a, b) / deg
                            : (name == "MINVAL" ? std::min(a, b) : std::max(a, b))};
  }
  if (name == "BOUND") {
    need(3);
    return {std::min(std::max(number(all[0]), number(all[2])), number(all[1]))};
  }
  need(1);
  const double value = function_of_one(name, number(all[0]), place);
  if (!std::isfinite(value)) throw InputError(place, fmt::format("{}: too large", name));
  return {value};
}

int Evaluator::read_index() {
  const double value = number(comparison());
  constexpr double kMax = 1e6;
  if (!(std::abs(value) <= kMax) || value != std::floor(value)) {
    fail(fmt::format("{:g} is not a valid index", value));
  }
  return static_cast<int>(value);
}

Reference Evaluator::reference() {
  Reference out;
  out.place = scanner_.place();
  out.name = scanner_.read_name();
  const bool is_R = out.name.size() > 1 && out.name.front() == 'R' &&
                    out.name.find_first_not_of("0123456789", 1) == out.name.npos;
  if (is_R && out.name.size() <= 6) {  // R5
    out.indices.push_back(std::stoi(out.name.substr(1)));
    out.name = "R";
    return out;
  }
  if (out.name.starts_with('$')) {  // its indices may be axes and names: $P_UIFR[1,X,TR]
    out.name += scanner_.read_brackets();
    return out;
  }
  if (++depth_ > kMaxNested) fail("the expression is nested too deeply");
  if (scanner_.take('[')) {
    do {
      out.indices.push_back(read_index());
    } while (scanner_.take(','));
    scanner_.expect(']', out.name);
  }
  --depth_;
  return out;
}

}  // namespace

Value evaluate(Scanner& scanner, const Variables& variables) {
  return Evaluator(scanner, variables).comparison();
}

double evaluate_number(Scanner& scanner, const Variables& variables) {
  scanner.skip_blanks();
  const Place place = scanner.place();
  const Value value = evaluate(scanner, variables);
  if (value.text) throw InputError(place, "expected a number, not a string");
  return value.number;
}

Reference read_reference(Scanner& scanner, const Variables& variables) {
  return Evaluator(scanner, variables).reference();
}

}  // namespace servomill::controllers::siemens
