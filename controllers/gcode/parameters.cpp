#include "controllers/gcode/parameters.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <optional>

#include "controllers/gcode/lexer.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kIntegerTol = 1e-4;  // RS274/NGC: how far from an integer a number may be
constexpr double kEqualTol = 1e-4;    // as LinuxCNC: EQ and NE

// Every step pushes at most one number, and a line has fewer steps than characters.
using Stack = std::array<double, kLongestLine + 1>;

[[noreturn]] void fail(const Place& place, std::string message) {
  throw InputError(place, std::move(message));
}

// In extended precision, as LinuxCNC has it: TAN[90] is then the same huge number.
constexpr long double kDegree = 3.14159265358979323846264338327950288L / 180.0L;

double rounded(double x) { return std::trunc(x + (x < 0.0 ? -0.5 : 0.5)); }

double modulo(double a, double b) {
  const double r = std::fmod(a, b);
  return r < 0.0 ? r + std::abs(b) : r;
}

double power(double a, double b, const Place& place) {
  if (a < 0.0 && b != std::floor(b)) {
    fail(place, fmt::format("{} ** {}: a negative base requires an integer exponent", a, b));
  }
  return std::pow(a, b);
}

double binary(OpCode code, double a, double b, const Place& place) {
  switch (code) {
    case OpCode::power:
      return power(a, b, place);
    case OpCode::multiply:
      return a * b;
    case OpCode::divide:
      if (b == 0.0) fail(place, fmt::format("{} / {}: division by zero", a, b));
      return a / b;
    case OpCode::modulo:
      if (b == 0.0) fail(place, fmt::format("{} MOD {}: division by zero", a, b));
      return modulo(a, b);
    case OpCode::add:
      return a + b;
    case OpCode::subtract:
      return a - b;
    case OpCode::equal:
      return std::abs(a - b) < kEqualTol ? 1.0 : 0.0;
    case OpCode::not_equal:
      return std::abs(a - b) < kEqualTol ? 0.0 : 1.0;
    case OpCode::greater:
      return a > b ? 1.0 : 0.0;
    case OpCode::greater_equal:
      return a >= b ? 1.0 : 0.0;
    case OpCode::less:
      return a < b ? 1.0 : 0.0;
    case OpCode::less_equal:
      return a <= b ? 1.0 : 0.0;
    case OpCode::logical_and:
      return a != 0.0 && b != 0.0 ? 1.0 : 0.0;
    case OpCode::logical_or:
      return a != 0.0 || b != 0.0 ? 1.0 : 0.0;
    case OpCode::logical_xor:
      return (a != 0.0) != (b != 0.0) ? 1.0 : 0.0;
    case OpCode::atan:
      return std::atan2(a, b) / deg;
    default:
      assert(false && "not a binary operator");
      return 0.0;
  }
}

bool is_logic(OpCode code) {
  return code == OpCode::logical_and || code == OpCode::logical_or || code == OpCode::logical_xor;
}

// Operation on the bits of two whole numbers; no number where a control that counts bits has none.
std::optional<double> of_bits(OpCode code, double a, double b) {
  constexpr double kMax = 4294967295.0;
  const auto is_whole = [](double x) { return x >= 0.0 && x <= kMax && x == std::floor(x); };
  if (!is_whole(a) || !is_whole(b)) return std::nullopt;
  const auto x = static_cast<std::uint64_t>(a), y = static_cast<std::uint64_t>(b);
  return static_cast<double>(code == OpCode::logical_and  ? x & y
                             : code == OpCode::logical_or ? x | y
                                                          : x ^ y);
}

// A control that counts bits (Fanuc, Haas) would read another value.
void refuse_other_logic(OpCode code, double a, double b, double logical, const Place& place) {
  const std::optional<double> bits = of_bits(code, a, b);
  if (bits && *bits == logical) return;
  const std::string_view name = code == OpCode::logical_and  ? "AND"
                                : code == OpCode::logical_or ? "OR"
                                                             : "XOR";
  const std::string other =
      bits ? fmt::format("{:g} as bitwise operation", *bits)
           : std::string("undefined as bitwise operation, which requires integers >= 0");
  fail(place, fmt::format("{:g} {} {:g}: {:g} as logical operation (LinuxCNC), or {} (Fanuc, "
                          "Haas); choose with --reader linuxcnc, fanuc or haas",
                          a, name, b, logical, other));
}

double arc_function(std::string_view name, double (*f)(double), double x, const Place& place) {
  if (!(x >= -1.0 && x <= 1.0))
    fail(place, fmt::format("{}[{}]: argument must be in -1 ... 1", name, x));
  return f(x) / deg;
}

double unary(OpCode code, double x, const Place& place) {
  switch (code) {
    case OpCode::negate:
      return -x;
    case OpCode::abs:
      return std::abs(x);
    case OpCode::acos:
      return arc_function("ACOS", std::acos, x, place);
    case OpCode::asin:
      return arc_function("ASIN", std::asin, x, place);
    case OpCode::cos:
      return static_cast<double>(std::cos(x * kDegree));
    case OpCode::exp:
      return std::exp(x);
    case OpCode::fix:
      return std::floor(x);
    case OpCode::fup:
      return std::ceil(x);
    case OpCode::ln:
      if (x <= 0.0) fail(place, fmt::format("LN[{}]: argument must be > 0", x));
      return std::log(x);
    case OpCode::round:
      return rounded(x);
    case OpCode::sin:
      return static_cast<double>(std::sin(x * kDegree));
    case OpCode::sqrt:
      if (x < 0.0) fail(place, fmt::format("SQRT[{}]: argument must be >= 0", x));
      return std::sqrt(x);
    case OpCode::tan:
      return static_cast<double>(std::tan(x * kDegree));
    default:
      assert(false && "not a unary operator");
      return 0.0;
  }
}

bool is_binary(OpCode code) {
  return (code >= OpCode::power && code <= OpCode::logical_xor) || code == OpCode::atan;
}

// As LinuxCNC: a name that the block sets further left is known, as 0, before it is set.
double named_value(const Op& op, const Block& block, const Parameters& parameters,
                   const Place& place) {
  const std::string& name = block.names[static_cast<std::size_t>(op.name)];
  if (const std::optional<double> value = parameters.get(name)) return *value;
  for (const Assignment& a : block.assignments) {
    const bool is_it = a.name >= 0 && block.names[static_cast<std::size_t>(a.name)] == name;
    if (is_it && a.column < op.column) return 0.0;
  }
  const bool is_global = name.starts_with('_');
  fail(place, fmt::format("parameter #<{0}> is not defined{1}", name,
                          is_global ? fmt::format("; pass --parameter '#<{}>=NUMBER'", name) : ""));
}

}  // namespace

Parameters::Parameters(System system)
    : system_(std::move(system)), numbered_(static_cast<std::size_t>(parameter::kLast) + 1, 0.0) {
  numbered_[parameter::kDebug] = 1.0;
}

double Parameters::get(int number) const {
  assert(number >= 1 && number <= parameter::kLast);
  if (parameter::is_read_only(number)) return system_.number(number);
  return numbered_[static_cast<std::size_t>(number)];
}

std::optional<double> Parameters::get(const std::string& name) const {
  const Names& names = names_of(name);
  if (const auto found = names.find(name); found != names.end()) return found->second;
  const std::optional<double> value = system_.name(name);
  return !value && forgives_ ? 0.0 : value;
}

void Parameters::set(int number, double value) {
  assert(number >= 1 && number <= parameter::kLast && !parameter::is_read_only(number));
  double& slot = numbered_[static_cast<std::size_t>(number)];
  old_numbers_.emplace_back(number, slot);
  slot = value;
}

void Parameters::set(const std::string& name, double value) {
  Names& names = names_of(name);
  const auto found = names.find(name);
  old_names_.emplace_back(
      name, found == names.end() ? std::nullopt : std::optional<double>(found->second));
  names[name] = value;
}

void Parameters::commit() {
  old_numbers_.clear();
  old_names_.clear();
}

void Parameters::roll_back() {
  for (; !old_numbers_.empty(); old_numbers_.pop_back()) {
    const auto& [number, value] = old_numbers_.back();
    numbered_[static_cast<std::size_t>(number)] = value;
  }
  for (; !old_names_.empty(); old_names_.pop_back()) {
    const auto& [name, value] = old_names_.back();
    if (value) {
      names_of(name)[name] = *value;
    } else {
      names_of(name).erase(name);
    }
  }
}

int parameter_number(double value, const Place& place) {
  const double nearest = std::round(value);
  if (!(std::abs(value - nearest) <= kIntegerTol)) {
    fail(place, fmt::format("parameter number {} is not an integer", value));
  }
  if (nearest < 1.0 || nearest > parameter::kLast) {
    fail(place, fmt::format("parameter number {}; must be in 1 ... {}", nearest, parameter::kLast));
  }
  return static_cast<int>(nearest);
}

double run_code(const Value& value, const Block& block, const Parameters& parameters,
                const std::string& file) {
  Stack stack;
  std::size_t top = 0;  // one above the topmost number
  for (int i = value.begin; i < value.end; ++i) {
    const Op& op = block.code[static_cast<std::size_t>(i)];
    const auto here = [&] { return Place{file, block.line, op.column}; };
    const auto name = [&]() -> const std::string& {
      return block.names[static_cast<std::size_t>(op.name)];
    };
    if (op.code == OpCode::push) {
      stack[top++] = op.value;
    } else if (op.code == OpCode::named) {
      stack[top++] = named_value(op, block, parameters, here());
    } else if (op.code == OpCode::has_name) {
      stack[top++] = parameters.get(name()) ? 1.0 : 0.0;
    } else if (op.code == OpCode::numbered) {
      stack[top - 1] = parameters.get(parameter_number(stack[top - 1], here()));
    } else if (op.code == OpCode::has_number) {
      const double nearest = std::round(stack[top - 1]);
      const bool exists = nearest >= 1.0 && nearest <= parameter::kLast;
      stack[top - 1] = exists ? 1.0 : 0.0;
    } else if (is_binary(op.code)) {
      --top;
      const double a = stack[top - 1];
      stack[top - 1] = binary(op.code, a, stack[top], here());
      if (is_logic(op.code) && parameters.is_logic_open()) {
        refuse_other_logic(op.code, a, stack[top], stack[top - 1], here());
      }
    } else {
      stack[top - 1] = unary(op.code, stack[top - 1], here());
    }
    if (!std::isfinite(stack[top - 1])) fail(here(), "the result is not a finite number");
  }
  assert(top == 1);
  return stack[0];
}

}  // namespace servomill::controllers
