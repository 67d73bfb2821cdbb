#include "sim/config/quantity.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::config {
namespace {

struct Symbol {
  std::string_view name;
  Quantity quantity;
  double factor;
};

// The one table of units. Everything else is a product of these.
constexpr std::array kSymbols = {
    Symbol{"m", kLength, 1.0},
    Symbol{"mm", kLength, mm},
    Symbol{"um", kLength, um},
    Symbol{"nm", kLength, nm},
    Symbol{"inch", kLength, inch},
    Symbol{"rad", kAngle, 1.0},
    Symbol{"deg", kAngle, deg},
    Symbol{"mrad", kAngle, 1e-3},
    Symbol{"urad", kAngle, urad},
    Symbol{"arcsec", kAngle, deg / 3600.0},
    Symbol{"rev", kAngle, 360.0 * deg},
    Symbol{"s", kTime, 1.0},
    Symbol{"ms", kTime, ms},
    Symbol{"us", kTime, us},
    Symbol{"min", kTime, minute},
    Symbol{"h", kTime, 60.0 * minute},
    Symbol{"Hz", kRate, 1.0},
    Symbol{"kHz", kRate, 1e3},
    Symbol{"rpm", kAngularVelocity, rpm},
    Symbol{"g", kMass, 1e-3},
    Symbol{"kg", kMass, 1.0},
    Symbol{"N", kForce, 1.0},
    Symbol{"kN", kForce, 1e3},
    Symbol{"Nm", kTorque, 1.0},
    Symbol{"Nms", {.m = 2, .kg = 1, .s = -1}, 1.0},
    Symbol{"J", {.m = 2, .kg = 1, .s = -2}, 1.0},
    Symbol{"W", {.m = 2, .kg = 1, .s = -3}, 1.0},
    Symbol{"kW", {.m = 2, .kg = 1, .s = -3}, 1e3},
    Symbol{"A", kCurrent, 1.0},
    Symbol{"mA", kCurrent, 1e-3},
    Symbol{"V", kVoltage, 1.0},
    Symbol{"H", kInductance, 1.0},
    Symbol{"mH", kInductance, 1e-3},
    Symbol{"ohm", kResistance, 1.0},
    Symbol{"K", kTemperature, 1.0},
    Symbol{"%", kNumber, 1e-2},
};

struct Name {
  Quantity quantity;
  std::string_view name;
  std::string_view si;
  std::string_view example;
};

constexpr std::array kNames = {
    Name{kNumber, "a number", "", ""},
    Name{kLength, "a length", "m", "mm"},
    Name{kTime, "a time", "s", "ms"},
    Name{kAngle, "an angle", "rad", "deg"},
    Name{kMass, "a mass", "kg", "kg"},
    Name{kCurrent, "a current", "A", "A"},
    Name{kTemperature, "a temperature", "K", "K"},
    Name{kRate, "a rate", "1/s", "1/s"},
    Name{kVelocity, "a velocity", "m/s", "mm/s"},
    Name{kAcceleration, "an acceleration", "m/s^2", "m/s^2"},
    Name{kJerk, "a jerk", "m/s^3", "m/s^3"},
    Name{kAngularVelocity, "an angular velocity", "rad/s", "rpm"},
    Name{kAngularAcceleration, "an angular acceleration", "rad/s^2", "rad/s^2"},
    Name{kAngularJerk, "an angular jerk", "rad/s^3", "rad/s^3"},
    Name{kInertia, "an inertia", "kg m^2", "kg m^2"},
    Name{kForce, "a force", "N", "N"},
    Name{kTorque, "a torque", "Nm", "Nm"},
    Name{kVoltage, "a voltage", "V", "V"},
    Name{kStiffness, "a stiffness", "N/m", "N/um"},
    Name{kDamping, "a damping", "N s/m", "N s/m"},
    Name{kTorsionalStiffness, "a torsional stiffness", "Nm/rad", "Nm/rad"},
    Name{kTorsionalDamping, "a torsional damping", "Nms/rad", "Nms/rad"},
    Name{kTorqueConstant, "a torque constant", "Nm/A", "Nm/A"},
    Name{kBackEmf, "a back-EMF constant", "V s/rad", "V s/rad"},
    Name{kInductance, "an inductance", "H", "mH"},
    Name{kResistance, "a resistance", "ohm", "ohm"},
    Name{kForceConstant, "a force constant", "N/A", "N/A"},
    Name{kTransmission, "a length per angle", "m/rad", "mm/rev"},
    Name{kAnglePerLength, "an angle per length", "rad/m", "urad/m"},
    Name{kCurrentPerAngularVelocity, "a current per angular velocity", "A s/rad", "A s/rad"},
    Name{kExpansion, "an expansion", "1/K", "um/m/K"},
    Name{kPressure, "a force per area", "N/m^2", "N/mm^2"},
    Name{kPerLength, "a share per length", "1/m", "1/m"},
    Name{{.s = 2}, "a displacement per acceleration", "s^2", "um/m s^2"},
};

const Symbol* find_symbol(std::string_view name) {
  for (const Symbol& symbol : kSymbols) {
    if (symbol.name == name) return &symbol;
  }
  return nullptr;
}

const Name* find_name(Quantity quantity) {
  for (const Name& name : kNames) {
    if (name.quantity == quantity) return &name;
  }
  return nullptr;
}

// Symbols that a word may mean: those of the quantity if it has some of its own, else all.
std::vector<std::string_view> symbols_for(const Quantity* quantity) {
  std::vector<std::string_view> own, all;
  for (const Symbol& symbol : kSymbols) {
    all.push_back(symbol.name);
    if (quantity != nullptr && symbol.quantity == *quantity) own.push_back(symbol.name);
  }
  return own.empty() ? all : own;
}

// The one symbol that is nearest to a word; empty if several are: "mn" may be mm, m or nm.
std::string_view nearest_symbol(std::string_view word, const Quantity* quantity) {
  std::vector<std::string_view> names = symbols_for(quantity);
  const std::string_view nearest = nearest_name(word, names);
  std::erase(names, nearest);
  const std::string_view next = nearest_name(word, names);
  const std::array both = {next, nearest};  // of equals the first is taken
  const bool is_unique = next.empty() || nearest_name(word, both) == nearest;
  return is_unique ? nearest : std::string_view();
}

// @param quantity  that is expected; nullptr: any
std::string unknown_symbol(std::string_view word, const Quantity* quantity) {
  const std::string_view nearest = nearest_symbol(word, quantity);
  return fmt::format("unknown unit '{}'{}", word,
                     nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

// "m, mm, um, nm, inch": the symbols of a quantity that has some of its own.
std::string symbols_of(Quantity quantity) {
  std::string out;
  if (quantity == kNumber) return out;  // um/m are numbers, too
  for (const Symbol& symbol : kSymbols) {
    if (symbol.quantity == quantity)
      out += fmt::format("{}{}", out.empty() ? "" : ", ", symbol.name);
  }
  return out;
}

void multiply(Unit& unit, const Symbol& symbol, int exponent) {
  const auto add = [exponent](std::int8_t& to, std::int8_t what) {
    to = static_cast<std::int8_t>(to + exponent * what);
  };
  add(unit.quantity.m, symbol.quantity.m);
  add(unit.quantity.kg, symbol.quantity.kg);
  add(unit.quantity.s, symbol.quantity.s);
  add(unit.quantity.A, symbol.quantity.A);
  add(unit.quantity.K, symbol.quantity.K);
  add(unit.quantity.rad, symbol.quantity.rad);
  // division rounds once where a product with the inverse would round twice
  for (int i = 0; i < std::abs(exponent); ++i) {
    if (exponent > 0) unit.factor *= symbol.factor;
    if (exponent < 0) unit.factor /= symbol.factor;
  }
}

// "mm^2" -> "mm", 2; exponents are whole numbers from 1 to 9
bool split_power(std::string_view& word, int& exponent) {
  exponent = 1;
  const std::size_t caret = word.find('^');
  if (caret == std::string_view::npos) return true;
  const std::string_view digits = word.substr(caret + 1);
  if (digits.size() != 1 || digits[0] < '1' || digits[0] > '9') return false;
  exponent = digits[0] - '0';
  word = word.substr(0, caret);
  return true;
}

// "mm_per_s2" -> "mm/s^2"
std::string symbol_of_suffix(std::string_view suffix) {
  std::string symbol;
  if (suffix.starts_with("per_")) symbol = "1/", suffix.remove_prefix(4);
  while (!suffix.empty()) {
    if (suffix.starts_with("_per_")) {
      symbol += '/';
      suffix.remove_prefix(5);
      continue;
    }
    const char c = suffix.front();
    if (c >= '1' && c <= '9') symbol += '^';
    symbol += c == '_' ? ' ' : c;
    suffix.remove_prefix(1);
  }
  return symbol;
}

std::string product_of_base_units(Quantity q) {
  struct Power {
    std::string_view name;
    int exponent;
  };
  const std::array powers = {Power{"kg", q.kg}, Power{"m", q.m}, Power{"A", q.A},
                             Power{"K", q.K},   Power{"s", q.s}, Power{"rad", q.rad}};
  std::string above, below;
  for (const auto& [name, exponent] : powers) {
    const int size = std::abs(exponent);
    const std::string factor = size > 1 ? fmt::format("{}^{}", name, size) : std::string(name);
    if (exponent > 0) above += (above.empty() ? "" : " ") + factor;
    if (exponent < 0) below += "/" + factor;
  }
  return (above.empty() ? "1" : above) + below;
}

// A product of symbols; nullopt if it is none.
struct Product {
  Unit unit;                      // without its spelling
  std::string_view unknown = {};  // the word that is no symbol; empty: the form is wrong
  bool is_unit = false;
};

Product product_of(std::string_view symbol) {
  Product out;
  int sign = 1;
  bool first = true;
  std::string_view rest = symbol;
  while (true) {
    const std::size_t end = rest.find_first_of(" /");
    std::string_view word = rest.substr(0, end);
    int exponent = 1;
    if (!split_power(word, exponent) || word.empty()) return out;
    if (!(first && word == "1")) {
      const Symbol* known = find_symbol(word);
      if (known == nullptr) {
        out.unknown = word;
        return out;
      }
      multiply(out.unit, *known, sign * exponent);
    }
    if (end == std::string_view::npos) {
      out.is_unit = true;
      return out;
    }
    sign = rest[end] == '/' ? -1 : 1;
    rest.remove_prefix(end + 1);
    first = false;
  }
}

}  // namespace

ParsedUnit parse_unit(std::string_view symbol) {
  Product product = product_of(symbol);
  if (product.is_unit) {
    product.unit.symbol = symbol;
    return {std::move(product.unit), ""};
  }
  return {std::nullopt, product.unknown.empty() ? fmt::format("unknown unit '{}'", symbol)
                                                : unknown_symbol(product.unknown, nullptr)};
}

std::optional<Unit> unit_of_key(std::string_view key, Quantity quantity) {
  for (std::size_t bar = key.find('_'); bar != std::string_view::npos;
       bar = key.find('_', bar + 1)) {
    std::string symbol = symbol_of_suffix(key.substr(bar + 1));
    Product product = product_of(symbol);  // most endings are none: no word is lost about them
    if (!product.is_unit || product.unit.quantity != quantity) continue;
    product.unit.symbol = std::move(symbol);
    return std::move(product.unit);
  }
  return std::nullopt;
}

std::string si_unit(Quantity quantity) {
  const Name* known = find_name(quantity);
  return known != nullptr ? std::string(known->si) : product_of_base_units(quantity);
}

std::string name_of(Quantity quantity) {
  const Name* known = find_name(quantity);
  return known != nullptr ? std::string(known->name)
                          : "a quantity in " + product_of_base_units(quantity);
}

std::string example_unit(Quantity quantity) {
  const Name* known = find_name(quantity);
  return known != nullptr ? std::string(known->example) : product_of_base_units(quantity);
}

namespace {

// "3.6 m/min/mm" -> 3.6, "m/min/mm"
struct NumberAndUnit {
  double number;
  std::string_view unit;
};

std::optional<NumberAndUnit> split_quantity(std::string_view text) {
  double number = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  const std::size_t begin = text.find_first_not_of(' ');
  return NumberAndUnit{number, begin == std::string_view::npos ? "" : text.substr(begin)};
}

/// Name as in "unit of length": without its article.
std::string without_article(const std::string& name) { return name.substr(name.find(' ') + 1); }

}  // namespace

ScaledText scale_text(std::string_view text, Quantity quantity) {
  const auto split = split_quantity(text);
  const auto expected = [quantity] {
    return fmt::format("must be {} such as \"3 {}\"", name_of(quantity), example_unit(quantity));
  };
  if (!split) return {0.0, {}, expected()};
  if (split->unit.empty()) return {0.0, {}, "has no unit; " + expected()};
  ParsedUnit parsed = parse_unit(split->unit);
  if (!parsed.unit) {
    const bool is_product = split->unit.find_first_of(" /^") != std::string_view::npos;
    const std::string symbols = is_product ? "" : symbols_of(quantity);
    const std::string what = is_product ? parsed.complaint : unknown_symbol(split->unit, &quantity);
    // a question ends a message
    const std::size_t question = what.find("; did you mean");
    const std::string kind =
        symbols.empty() ? expected() : fmt::format("{} is in {}", name_of(quantity), symbols);
    parsed.complaint = fmt::format("{}; {}{}", what.substr(0, question), kind,
                                   question == std::string::npos ? "" : what.substr(question));
  }
  if (!parsed.unit) return {0.0, {}, parsed.complaint};
  if (parsed.unit->quantity != quantity) {
    return {0.0,
            {},
            fmt::format("'{}' is a unit of {}; {}", split->unit,
                        without_article(name_of(parsed.unit->quantity)), expected())};
  }
  return {split->number * parsed.unit->factor, *parsed.unit, ""};
}

std::string in_unit(double si, std::string_view symbol) {
  const ParsedUnit parsed = parse_unit(symbol);
  assert(parsed.unit);
  return fmt::format("{:.6g} {}", si / parsed.unit->factor, symbol);
}

}  // namespace servomill::sim::config
