/// How a macro is read: by which control, and who hears of it.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "controllers/gcode/decimal_point.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/differences.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::macro {

class MacroReading {
 public:
  MacroReading(Reader reader, DecimalPoint decimal_point, bool is_trial)
      : reader_(reader), decimal_point_(decimal_point), is_trial_(is_trial) {}

  Reader reader() const { return reader_; }
  DecimalPoint decimal_point() const { return decimal_point_; }
  /// Refuses text that stops the control, too.
  [[noreturn]] void refuse(const Place& place, std::string message) const;
  /// Refuses text that stops servomill, and perhaps not the control.
  [[noreturn]] void fail(const Place& place, std::string message) const;
  /// Which of two readings the reader has.
  /// @throws InputError with both if it has neither
  int choose(WordDifference difference, const Place& place) const;
  /// Warns where the rule is needed first.
  void apply(ReaderRule rule, const Place& place);
  /// Warns once a line and column.
  void warn(const Place& place, std::string message);
  std::vector<Fault> take_warnings() { return std::exchange(warnings_, {}); }

 private:
  Reader reader_;
  DecimalPoint decimal_point_;
  bool is_trial_;
  std::set<ReaderRule> applied_;
  std::set<std::string> warned_;
  std::vector<Fault> warnings_;
};

}  // namespace servomill::controllers::macro
