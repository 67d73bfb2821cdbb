// Functions in expressions of custom macro B.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/gcode/macro/expression.h"
#include "controllers/gcode/program_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::macro {
namespace {

constexpr std::array<std::string_view, 17> kFunctions = {
    "ABS", "ACOS", "ADP", "ASIN", "ATAN",  "BCD", "BIN",  "COS", "EXP",
    "FIX", "FUP",  "LN",  "POW",  "ROUND", "SIN", "SQRT", "TAN"};

bool is_name_letter(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

double Expression::argument() {
  const int column = cursor_.column();
  if (cursor_.peek() != '[') refuse(column, "expected '[' after the function name");
  return bracketed().number();
}

double Expression::rounded(double x) const {
  return rounded_to(x, context_.increment > 0.0 ? context_.increment : 1.0);
}

double Expression::in_range(double x, std::string_view name, int column) const {
  if (std::abs(x) > 1.0) refuse(column, fmt::format("{}[{}]: must be in -1 ... 1", name, x));
  return x;
}

// Fanuc gives angles below 0 from 270 degrees on, or as they are.
double Expression::angle(double degrees, int column) const {
  if (degrees >= 0.0) return degrees;
  const int reading = context_.reading.choose(WordDifference::angle_range, here(column));
  return reading == 0 ? degrees + 360.0 : degrees;
}

// ATAN[y]/[x], of Fanuc also ATAN[y, x] (B-64484EN, arithmetic and logic operation, from memory).
double Expression::atan(int column) {
  const int opened = cursor_.column();
  if (!cursor_.accept("[")) refuse(opened, "expected '[' after the function name");
  const double y = expression().number();
  const bool has_comma = cursor_.accept(",");
  const double pair_x = has_comma ? expression().number() : 0.0;
  if (cursor_.at_end()) refuse(opened, "'[' is not closed; ']' is missing");
  if (!cursor_.accept("]")) refuse(cursor_.column(), "expected an operator or ']'");
  if (!has_comma && !cursor_.accept("/")) return std::atan(y) / deg;
  const double x = has_comma ? pair_x : argument();
  if (x == 0.0 && y == 0.0) refuse(column, "ATAN[0]/[0] is undefined");
  return angle(std::atan2(y, x) / deg, column);
}

double Expression::pow(int column) {
  if (!cursor_.accept("[")) refuse(cursor_.column(), "expected '[' after POW");
  const double base = expression().number();
  if (!cursor_.accept(",")) refuse(cursor_.column(), "expected ',': POW[base, exponent]");
  const double exponent = expression().number();
  if (!cursor_.accept("]")) refuse(cursor_.column(), "expected ']' after POW[base, exponent");
  const double out = std::pow(base, exponent);
  if (!std::isfinite(out))
    refuse(column, fmt::format("POW[{},{}] is not a number", base, exponent));
  return out;
}

// BIN reads the decimal digits of a number as written in four bits each, BCD writes them so.
double Expression::decimal(bool is_to_binary, double x, int column) const {
  if (x < 0.0 || x != std::floor(x) || x > 99999999.0 * (is_to_binary ? 29.0 : 1.0)) {
    refuse(column, fmt::format("{}: BIN and BCD require integers of up to 8 digits", x));
  }
  const double from = is_to_binary ? 16.0 : 10.0, to = is_to_binary ? 10.0 : 16.0;
  double out = 0.0, place = 1.0;
  for (; x > 0.0; x = std::floor(x / from), place *= to) {
    const double digit = std::fmod(x, from);
    if (digit > 9.0) refuse(column, "BIN: a digit is greater than 9");
    out += digit * place;
  }
  return out;
}

Expression::Term Expression::function() {
  const int column = cursor_.column();
  std::string name;
  for (; is_name_letter(cursor_.peek()); cursor_.advance()) name += cursor_.peek();
  const Term out{0.0, false, false, column};
  const auto is = [&](std::string_view other) { return name == other; };
  const auto result = [&](double value) {
    if (!std::isfinite(value)) refuse(column, fmt::format("{}: the result is not a number", name));
    return Term{value, false, false, column};
  };
  if (is("ATAN")) return result(atan(column));
  if (is("POW")) return result(pow(column));
  if (is("ADP")) {
    context_.reading.fail(here(column),
                          "ADP adds a decimal point by the increments of the control, which are "
                          "unknown; write the value with its decimal point");
  }
  if (std::find(kFunctions.begin(), kFunctions.end(), name) == kFunctions.end()) {
    refuse(column, fmt::format("unknown function '{}'{}", name, did_you_mean(name, kFunctions)));
  }
  const double x = argument();
  if (is("SIN")) return result(std::sin(x * deg));
  if (is("COS")) return result(std::cos(x * deg));
  if (is("TAN")) return result(std::tan(x * deg));
  if (is("ASIN")) return result(angle(std::asin(in_range(x, name, column)) / deg, column));
  if (is("ACOS")) return result(std::acos(in_range(x, name, column)) / deg);
  if (is("SQRT") && x < 0.0) refuse(column, fmt::format("SQRT[{}]: must be >= 0", x));
  if (is("SQRT")) return result(std::sqrt(x));
  if (is("ABS")) return result(std::abs(x));
  if (is("ROUND")) return result(rounded(x));
  if (is("FIX")) return result(std::trunc(x));
  if (is("FUP")) return result(x < 0.0 ? std::floor(x) : std::ceil(x));
  if (is("LN") && x <= 0.0) refuse(column, fmt::format("LN[{}]: must be > 0", x));
  if (is("LN")) return result(std::log(x));
  if (is("EXP")) return result(std::exp(x));
  if (is("BIN") || is("BCD")) return result(decimal(is("BIN"), x, column));
  return out;
}

}  // namespace servomill::controllers::macro
