/// Bounds on the numbers of a document. Rules are data, so that a message can say what was
/// violated.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace servomill::sim::config {

struct Unit;

/// A bound on a number, in SI.
struct Rule {
  enum class Comparison : std::uint8_t { above, at_least, below, at_most };
  Comparison comparison;
  double bound;
};

/// ">", ">=", "<", "<="
std::string_view symbol_of(Rule::Comparison comparison);

constexpr Rule above(double bound) { return {Rule::Comparison::above, bound}; }
constexpr Rule at_least(double bound) { return {Rule::Comparison::at_least, bound}; }
constexpr Rule below(double bound) { return {Rule::Comparison::below, bound}; }
constexpr Rule at_most(double bound) { return {Rule::Comparison::at_most, bound}; }

/// Rules that must all hold: `{above(0.0), at_most(1.0)}`.
using Rules = std::initializer_list<Rule>;

/// True for a finite value that violates none of the rules.
bool all_hold(Rules rules, double value);

/// "must be > 0 and <= 500 um", or "must be finite" for a value that is not.
/// @param unit       the bounds are given in it: that which the user wrote the value in
/// @param name_unit  false: the key names it already
std::string requirement(Rules rules, double value, const Unit& unit, bool name_unit);

}  // namespace servomill::sim::config
