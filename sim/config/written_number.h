/// Numbers with their units as TOML has them.
#pragma once

#include <optional>
#include <string>

namespace servomill::sim::config {

/// A number with its unit as TOML has it: 60.0 or "60 1/s".
struct WrittenNumber {
  double value = 0.0;
  std::string unit;  // empty: a plain number
  bool operator==(const WrittenNumber&) const = default;
};

/// Value of a TOML scalar that is a number, or a text of a number and a known unit.
std::optional<WrittenNumber> written_number(const std::string& toml);

/// The number that a TOML value is, in the unit it is written in ("60 1/s" is 60); NaN if none.
double number_of(const std::string& toml);

}  // namespace servomill::sim::config
