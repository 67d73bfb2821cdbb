/// Tools and their offsets.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

struct ToolEntry {
  int number = 0;
  int pocket = 0;
  AxisWords offset = AxisWords::Zero();  // m, rad; length along Z is offset[2]
  double diameter = 0.0;                 // m
  double front_angle = 0.0;              // rad, like the rest for turning tools only
  double back_angle = 0.0;               // rad
  int orientation = 0;                   // of the tip, 0 ... 9
};

class ToolTable {
 public:
  /// Reads LinuxCNC's format in mm and degrees: one tool a line, words T (number), P (pocket),
  /// X Y Z A B C (offsets), D (diameter), I J (angles of the edges) and Q (orientation), each at
  /// most once and in any order; a ';' starts a remark. U V W must be 0, for there are no such
  /// axes.
  /// @throws InputError with every fault of every line
  static ToolTable parse(std::string_view text, const std::string& file);

  /// @throws InputError (without a place) for a second tool of the same number
  void add(const ToolEntry& tool);

  /// Puts a tool in the place of that of the same number.
  void replace(const ToolEntry& tool) { tools_[tool.number] = tool; }

  /// Every number that the table lacks is from now on a tool without length and diameter: for
  /// surveys of programs, where what depends on them counts as unknown.
  void take_any_number() { takes_any_ = true; }

  /// nullptr if there is no such tool.
  const ToolEntry* find(int number) const;
  /// The line of the table; nullptr if it has none.
  const ToolEntry* entry_of(int number) const;
  const std::map<int, ToolEntry>& entries() const { return tools_; }  ///< by number
  bool empty() const { return tools_.empty(); }
  std::size_t size() const { return tools_.size(); }

 private:
  std::map<int, ToolEntry> tools_;
  bool takes_any_ = false;
};

}  // namespace servomill::controllers
