/// Variables of a Siemens program: R parameters, those of DEF and PROC, and system variables that
/// the user gives.
///
/// 840D sl, Job Planning, "Variables": R parameters keep the value of an earlier program, so one
/// that was not assigned is unknown; variables of DEF begin with 0, FALSE or an empty text. They
/// are known in their own program only (MD11120 = 0, as delivered).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::siemens {

/// A number or a text.
struct Value {
  double number = 0.0;
  std::optional<std::string> text = {};
  const char* unknown_because = nullptr;
};

enum class Type { real, integer, boolean, character, text, axis };

/// The type of that name (REAL, INT, BOOL, CHAR, STRING, AXIS), or nullopt.
std::optional<Type> type_named(std::string_view name);

/// A variable and the indices of one of its elements.
struct Reference {
  std::string name;          // "R", "DEPTH", "$P_TOOLR"
  std::vector<int> indices;  // R[5] and R5 hold {5}
  Place place;
};

class Variables {
 public:
  /// @param given  those of the user, by name: "R5", "$P_TOOLR", "$MN_G53_TOOLCORR"
  explicit Variables(const std::map<std::string, double>& given);

  bool is_known(std::string_view name) const;
  /// True if the program that runs has defined variables.
  bool has_own() const { return !local_.back().empty(); }
  /// @throws InputError if the name is taken, or the array is too large
  void define(const std::string& name, Type type, const std::vector<int>& sizes,
              const Place& place);
  /// @throws InputError if there is no such variable or element, or it has no value
  Value get(const Reference& reference) const;
  /// Returns the number of a value that must be one.
  double number(const Reference& reference) const;
  void set(const Reference& reference, const Value& value);
  /// Makes a variable unknown until it is set again.
  /// @param why  behind its name in the message to who reads it
  void forget(const Reference& reference, const char* why);
  /// Number of elements of a variable; 1 for a scalar.
  std::size_t size(const Reference& reference) const;
  /// Assigns by position in the array, from 0.
  void set_element(const Reference& reference, std::size_t at, const Value& value);
  /// The number given by the user for a name such as $MN_G53_TOOLCORR.
  std::optional<double> given(const std::string& name) const;

  /// Variables of a called program; those of the caller are hidden until it ends.
  void begin_program() { local_.emplace_back(); }
  void end_program() { local_.pop_back(); }

 private:
  struct Variable {
    Type type = Type::real;
    std::vector<int> sizes;
    std::vector<Value> values;
  };

  static const Value& known(const Reference& reference, const Value& value);
  const Variable* find(std::string_view name) const;
  std::size_t element(const Variable& variable, const Reference& reference) const;

  std::map<std::string, double> given_;
  std::map<int, Value> R_;
  std::vector<std::map<std::string, Variable, std::less<>>> local_;
};

/// "R5", "$A_X[1]", "DEPTH[2,3]".
std::string to_string(const Reference& reference);

}  // namespace servomill::controllers::siemens
