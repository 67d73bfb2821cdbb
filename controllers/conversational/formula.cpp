#include "controllers/conversational/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "controllers/conversational/words.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

struct Token {
  enum class Kind { number, name, word, sign } kind = Kind::sign;
  std::string text;
  double number = 0.0;
  QName name;
  Place place;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

// Length of the token at the start of `text`.
std::size_t read_token(std::string_view text, Token& token) {
  std::size_t length = 0;
  if (const auto name = q_name_at(text, length)) {
    token.kind = Token::Kind::name;
    token.name = *name;
    return length;
  }
  if (is_digit(text.front()) || text.front() == '.' || text.front() == ',') {
    token.kind = Token::Kind::number;
    while (length < text.size() &&
           (is_digit(text[length]) || text[length] == '.' || text[length] == ',')) {
      ++length;
    }
    token.number = operand_of(text.substr(0, length), token.place).number;
    return length;
  }
  if (is_letter(text.front())) {
    token.kind = Token::Kind::word;
    while (length < text.size() && is_letter(text[length])) ++length;
    return length;
  }
  if (text.front() == '"') {
    token.kind = Token::Kind::word;
    const std::size_t end = text.find('"', 1);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  return 1;
}

std::vector<Token> tokens_of(std::span<const HeidenhainWord> words) {
  std::vector<Token> tokens;
  for (const HeidenhainWord& word : words) {
    for (std::size_t at = 0; at < word.text.size();) {
      Token token;
      token.place = word.place;
      token.place.column += static_cast<int>(at);
      const std::string_view rest = std::string_view(word.text).substr(at);
      const std::size_t length = read_token(rest, token);
      token.text = std::string(rest.substr(0, length));
      tokens.push_back(std::move(token));
      at += length;
    }
  }
  return tokens;
}

// Functions of one value: iTNC 530 (60642x-04) ISO manual pp. 303 and 304.
constexpr auto kFunctions =
    std::to_array<std::string_view>({"SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "SQRT", "SQ",
                                     "LN", "LOG", "EXP", "NEG", "INT", "ABS", "FRAC", "SGN"});

double function_value(std::string_view name, double x, const Place& place) {
  const auto refuse = [&](std::string_view why) {
    throw InputError(place, fmt::format("{} of {:g}: {}", name, x, why));
  };
  if (name == "SIN") return std::sin(x * deg);
  if (name == "COS") return std::cos(x * deg);
  if (name == "TAN") return std::tan(x * deg);
  if ((name == "ASIN" || name == "ACOS") && std::abs(x) > 1.0) refuse("must be in -1 ... 1");
  if (name == "ASIN") return std::asin(x) / deg;
  if (name == "ACOS") return std::acos(x) / deg;
  if (name == "ATAN") return std::atan(x) / deg;
  if (name == "SQRT" && x < 0.0) refuse("must be >= 0");
  if (name == "SQRT") return std::sqrt(x);
  if (name == "SQ") return x * x;
  if ((name == "LN" || name == "LOG") && !(x > 0.0)) refuse("must be > 0");
  if (name == "LN") return std::log(x);
  if (name == "LOG") return std::log10(x);
  if (name == "EXP") return std::exp(x);
  if (name == "NEG") return -x;
  if (name == "INT") return std::trunc(x);
  if (name == "ABS") return std::abs(x);
  if (name == "FRAC") return x - std::trunc(x);
  // SGN 0 is 1 (iTNC 530 (60642x-04) ISO p. 304), 0 on later controls (M)
  if (x == 0.0) refuse("1 on an iTNC 530, 0 on a TNC 640; use FN 9 to FN 12 for the comparison");
  return x > 0.0 ? 1.0 : -1.0;
}

// Multiplication and division before addition and subtraction: iTNC 530 (60642x-04) ISO p. 305.
class Parser {
 public:
  Parser(std::span<const HeidenhainWord> words, const QParameters& parameters)
      : tokens_(tokens_of(words)), parameters_(parameters) {
    end_.text = "the end of the block";
    if (!words.empty()) {
      end_.place = words.back().place;
      end_.place.column += static_cast<int>(words.back().text.size());
    }
  }

  QName target() {
    const Token token = take();
    if (token.kind != Token::Kind::name) fail(token, "expected a Q parameter first");
    const Token equals = take();
    if (equals.text != "=") fail(equals, "expected '=' after the Q parameter");
    return token.name;
  }

  double sum() {
    double value = product();
    while (next().text == "+" || next().text == "-") {
      const bool is_plus = take().text == "+";
      const double right = product();
      value += is_plus ? right : -right;
    }
    return value;
  }

  /// A number or a parameter with signs.
  double operand() {
    double sign = 1.0;
    while (next().text == "+" || next().text == "-") sign *= take().text == "-" ? -1.0 : 1.0;
    const Token token = take();
    if (token.kind == Token::Kind::number) return sign * token.number;
    if (token.kind == Token::Kind::name) return sign * parameters_.get(token.name, token.place);
    fail(token, "expected a number or a Q parameter");
  }

  Token take_word(std::initializer_list<std::string_view> names) {
    const Token token = take();
    if (std::find(names.begin(), names.end(), token.text) == names.end()) {
      fail(token, fmt::format("expected '{}'", *names.begin()));
    }
    return token;
  }
  Token take() { return at_ < tokens_.size() ? tokens_[at_++] : end_; }
  void finish() {
    if (at_ < tokens_.size()) fail(tokens_[at_], "unexpected text at the end of the block");
  }
  [[noreturn]] static void fail(const Token& token, std::string_view why) {
    throw InputError(token.place, fmt::format("'{}': {}", token.text, why));
  }
  static double quotient(double a, double b, const Token& sign) {
    if (b == 0.0) fail(sign, "division by zero");
    return a / b;
  }

 private:
  const Token& next() const { return at_ < tokens_.size() ? tokens_[at_] : end_; }

  double product() {
    double value = power();
    while (next().text == "*" || next().text == "/" || next().text == "%" || next().text == "DIV") {
      const Token sign = take();
      const double right = power();
      if (sign.text == "*") {
        value *= right;
      } else if (sign.text == "%") {
        value = remainder(value, right, sign);
      } else {
        value = quotient(value, right, sign);
      }
    }
    return value;
  }

  static double remainder(double a, double b, const Token& sign) {
    if (a < 0.0 || b <= 0.0) fail(sign, "the remainder for negative numbers is undocumented");
    return std::fmod(a, b);
  }

  double power() {
    const bool is_signed = next().text == "-" || next().text == "+";
    const double base = factor();
    if (next().text != "^") return base;
    const Token sign = take();
    if (is_signed)
      fail(sign, "a power after a sign: the order of evaluation is undocumented; use parentheses");
    const double value = std::pow(base, factor());
    if (next().text == "^") fail(next(), "two consecutive powers; use parentheses");
    if (!std::isfinite(value)) fail(sign, "the result is not a finite number");
    return value;
  }

  double factor() {
    const Token token = next();
    if (token.text == "+" || token.text == "-") {
      take();
      return token.text == "-" ? -factor() : factor();
    }
    if (token.text == "(") {
      take();
      const double value = sum();
      const Token close = take();
      if (close.text != ")") fail(close, "expected ')'");
      return value;
    }
    if (token.text == "PI") return take(), std::numbers::pi;
    if (token.kind != Token::Kind::word) return operand();
    take();
    const auto* found = std::find(kFunctions.begin(), kFunctions.end(), token.text);
    if (found == kFunctions.end()) {
      fail(token, fmt::format("unknown function{}", did_you_mean(token.text, kFunctions)));
    }
    return function_value(*found, factor(), token.place);
  }

  std::vector<Token> tokens_;
  const QParameters& parameters_;
  std::size_t at_ = 0;
  Token end_;
};

// Controls differ in how they round: what rounding decides is not known.
void refuse_rounding(double a, double b, const Place& place) {
  constexpr double kRounding = 1e-9;
  const double difference = std::abs(a - b);
  if (difference == 0.0 || difference > kRounding * std::max({1.0, std::abs(a), std::abs(b)})) {
    return;
  }
  throw InputError(place, fmt::format("{0:.15g} and {1:.15g} differ only by rounding, which "
                                      "depends on the control; compare with a tolerance",
                                      a, b));
}

double two_operands(int number, Parser& parser) {
  const double a = parser.operand();
  if (number == 0) return a;
  constexpr std::array<std::string_view, 4> kActions = {"", "+", "-", "*"};
  if (number <= 3) {
    parser.take_word({kActions[static_cast<std::size_t>(number)]});
    const double b = parser.operand();
    return number == 1 ? a + b : number == 2 ? a - b : a * b;
  }
  if (number == 4) {
    const auto sign = parser.take_word({"DIV", "/"});
    return Parser::quotient(a, parser.operand(), sign);
  }
  parser.take_word({number == 8 ? "LEN" : "ANG"});
  const double b = parser.operand();
  if (number == 8) return std::hypot(a, b);
  // the first is the side opposite, the second adjacent; 0 to 360 degrees
  const double angle = std::atan2(a, b) / deg;
  return angle < 0.0 ? angle + 360.0 : angle;
}

}  // namespace

Assignment evaluate_formula(std::span<const HeidenhainWord> words, const QParameters& parameters) {
  Parser parser(words, parameters);
  Assignment out;
  out.name = parser.target();
  out.value = parser.sum();
  parser.finish();
  return out;
}

Assignment evaluate_function(int number, std::span<const HeidenhainWord> words,
                             const QParameters& parameters) {
  Parser parser(words, parameters);
  Assignment out;
  out.name = parser.target();
  if (number >= 5 && number <= 7) {
    constexpr std::array<std::string_view, 3> kNames = {"SQRT", "SIN", "COS"};
    const std::string_view name = kNames[static_cast<std::size_t>(number - 5)];
    const auto token = parser.take_word({name});
    out.value = function_value(name, parser.operand(), token.place);
  } else {
    out.value = two_operands(number, parser);
  }
  parser.finish();
  return out;
}

Jump evaluate_jump(int number, std::span<const HeidenhainWord> words,
                   const QParameters& parameters) {
  Parser parser(words, parameters);
  parser.take_word({"IF"});
  const double a = parser.operand();
  constexpr std::array<std::array<std::string_view, 2>, 4> kActions = {
      {{"EQU", "EQU"}, {"NEQ", "NE"}, {"GT", "GT"}, {"LT", "LT"}}};
  const auto& sign = kActions[static_cast<std::size_t>(number - 9)];
  parser.take_word({sign[0], sign[1]});
  const double b = parser.operand();
  parser.take_word({"GOTO"});
  parser.take_word({"LBL"});
  Jump out;
  const auto label = parser.take();
  out.label = label.kind == Token::Kind::name
                  ? fmt::format("{:g}", parameters.get(label.name, label.place))
                  : label.text;
  parser.finish();
  refuse_rounding(a, b, words.front().place);
  out.is_taken = number == 9 ? a == b : number == 10 ? a != b : number == 11 ? a > b : a < b;
  return out;
}

}  // namespace servomill::controllers::conversational
