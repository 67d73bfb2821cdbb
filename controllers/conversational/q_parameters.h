/// Q parameters of a conversational program.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::conversational {

/// The name of a Q parameter: Q5, QL2 (local to a program), QR7 (kept when the control is off).
struct QName {
  char kind = 'Q';  // 'Q', 'L', 'R'
  int number = -1;
  bool operator==(const QName&) const = default;
};

std::string to_string(const QName& name);

/// Reads "Q5", "QL2", "QR7" at the start of a text.
/// @param length  receives the number of characters that it takes
std::optional<QName> q_name_at(std::string_view text, std::size_t& length);

/// A number in a block: written out, or a Q parameter with a sign.
struct Operand {
  double number = 0.0;
  double sign = 1.0;
  std::optional<QName> name;
  Place place;
};

/// Values of Q parameters. A parameter that has not been assigned has no value: on the control it
/// still holds the one assigned by an earlier program.
class QParameters {
 public:
  void set(const QName& name, double value) {
    values_[{name.kind, name.number}] = value;
    unknown_.erase({name.kind, name.number});
  }
  /// From here on the parameter holds a value of the control that is not known.
  /// @param source  "is the angle of a rotary axis after PLANE", for the message
  void forget(const QName& name, std::string source) {
    values_.erase({name.kind, name.number});
    unknown_[{name.kind, name.number}] = std::move(source);
  }
  /// @throws InputError for a parameter without a value
  double get(const QName& name, const Place& place) const;
  double value(const Operand& operand) const {
    return operand.name ? operand.sign * get(*operand.name, operand.place) : operand.number;
  }
  std::optional<double> find(const QName& name) const;

 private:
  std::map<std::pair<char, int>, double> values_;
  std::map<std::pair<char, int>, std::string> unknown_;  // and where the value comes from
};

}  // namespace servomill::controllers::conversational
