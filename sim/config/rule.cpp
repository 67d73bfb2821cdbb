#include "sim/config/rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/config/quantity.h"

namespace servomill::sim::config {
namespace {

bool holds(const Rule& rule, double value) {
  switch (rule.comparison) {
    case Rule::Comparison::above:
      return value > rule.bound;
    case Rule::Comparison::at_least:
      return value >= rule.bound;
    case Rule::Comparison::below:
      return value < rule.bound;
    case Rule::Comparison::at_most:
      return value <= rule.bound;
  }
  return false;
}

}  // namespace

std::string_view symbol_of(Rule::Comparison comparison) {
  switch (comparison) {
    case Rule::Comparison::above:
      return ">";
    case Rule::Comparison::at_least:
      return ">=";
    case Rule::Comparison::below:
      return "<";
    case Rule::Comparison::at_most:
      return "<=";
  }
  return "";
}

bool all_hold(Rules rules, double value) {
  return std::isfinite(value) && std::all_of(rules.begin(), rules.end(), [value](const Rule& rule) {
           return holds(rule, value);
         });
}

std::string requirement(Rules rules, double value, const Unit& unit, bool name_unit) {
  if (!std::isfinite(value)) return "must be finite";
  std::string out;
  for (const Rule& rule : rules) {
    out += fmt::format("{}{} {:.12g}", out.empty() ? "must be " : " and ",
                       symbol_of(rule.comparison), rule.bound / unit.factor);
    if (name_unit && rule.bound != 0.0) out += " " + unit.symbol;
  }
  return out;
}

}  // namespace servomill::sim::config
