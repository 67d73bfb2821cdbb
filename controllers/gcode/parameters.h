/// Numbered and named parameters of a program, and the evaluation of expressions over them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "controllers/gcode/block.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

/// Numbers that mean something to the machine; values in mm and degrees, axes in the order
/// X Y Z A B C from the first number on.
namespace parameter {
inline constexpr int kProbed = 5061;         // G38.2 ... G38.5: where the probe switched
inline constexpr int kProbedAxes = 9;        // X Y Z A B C U V W
inline constexpr int kProbeSwitched = 5070;  // 1: it did, 0: it did not
inline constexpr int kHome = 5161;           // G28
inline constexpr int kSecondHome = 5181;     // G30
inline constexpr int kG92Active = 5210;      // 1: G92 offset in force
inline constexpr int kG92 = 5211;            // G92 and G52
inline constexpr int kWorkSystem = 5220;     // 1 is G54, 9 is G59.3
inline constexpr int kWorkOffset = 5221;     // of G54; + 20 for each further one
inline constexpr int kWorkRotation = 5230;   // degrees about Z; + 20 for each further one
inline constexpr int kTool = 5400;           // tool in the spindle, then its offsets, read-only
inline constexpr int kToolDiameter = 5410;
inline constexpr int kPosition = 5420;  // in work coordinates and program units, read-only
inline constexpr int kLastReadOnly = 5428;
inline constexpr int kDebug = 5599;  // 0: (DEBUG, ...) says nothing; 1 at first
inline constexpr int kLast = 5601;
constexpr int work_offset(int system) { return kWorkOffset + 20 * (system - 1); }
constexpr int work_rotation(int system) { return kWorkRotation + 20 * (system - 1); }
constexpr bool is_read_only(int number) { return number >= kTool && number <= kLastReadOnly; }
}  // namespace parameter

/// All parameters. Changes since the last `commit` can be taken back. Names that begin with '_' are
/// global; others belong to the subroutine, or to the program outside of all, that sets them.
class Parameters {
 public:
  /// Values that the interpreter computes on demand: read-only numbers 5400 ... 5428, and named
  /// ones that are set by the system, like #<_x>. Returns nullopt for a name that it does not know.
  struct System {
    std::function<double(int number)> number;
    std::function<std::optional<double>(std::string_view name)> name;
  };

  explicit Parameters(System system);

  /// @pre 1 <= number <= parameter::kLast
  double get(int number) const;
  std::optional<double> get(const std::string& name) const;
  bool is_system_name(std::string_view name) const { return system_.name(name).has_value(); }
  /// @pre 1 <= number <= parameter::kLast, not read-only
  void set(int number, double value);
  void set(const std::string& name, double value);

  /// Lets names that are not defined count as 0, as in a definition that is passed over.
  void forgive_unknown_names(bool forgive) { forgives_ = forgive; }
  /// AND, OR and XOR whose values as conditions and of bits differ are refused.
  void leave_logic_open(bool is_open) { is_logic_open_ = is_open; }
  bool is_logic_open() const { return is_logic_open_; }

  /// A subroutine with names of its own begins; ends.
  void enter_scope() { local_.emplace_back(); }
  void leave_scope() { local_.pop_back(); }

  void commit();
  void roll_back();

 private:
  System system_;
  std::vector<double> numbered_;
  using Names = std::unordered_map<std::string, double>;
  Names& names_of(const std::string& name) { return name[0] == '_' ? global_ : local_.back(); }
  const Names& names_of(const std::string& name) const {
    return name[0] == '_' ? global_ : local_.back();
  }

  bool forgives_ = false, is_logic_open_ = false;
  Names global_;
  std::vector<Names> local_{Names()};  // of each call
  std::vector<std::pair<int, double>> old_numbers_;
  std::vector<std::pair<std::string, std::optional<double>>> old_names_;
};

/// The number of a parameter given by an expression.
/// @throws InputError if it is not an integer within 1e-4 or not in 1 ... parameter::kLast
int parameter_number(double value, const Place& place);

/// @throws InputError for a parameter that is not defined, an argument out of the domain of a
/// function, a division by zero or a result that is not finite
double run_code(const Value& value, const Block& block, const Parameters& parameters,
                const std::string& file);
inline double evaluate(const Value& value, const Block& block, const Parameters& parameters,
                       const std::string& file) {
  return value.is_constant() ? value.number : run_code(value, block, parameters, file);
}
/// Keeps the number in the value, too.
inline double evaluate(Value& value, const Block& block, const Parameters& parameters,
                       const std::string& file) {
  if (!value.is_constant()) value.number = run_code(value, block, parameters, file);
  return value.number;
}

}  // namespace servomill::controllers
