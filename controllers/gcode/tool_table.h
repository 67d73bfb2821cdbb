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
  int orientation = 0;                   // of a turning tool, 1 ... 9; 0: of a mill
};

class ToolTable {
 public:
  /// Reads LinuxCNC's format in mm and degrees: one tool a line, words T P X Y Z A B C D and, for
  /// turning tools, Q (orientation), I and J (angles, unused here); a ';' starts a comment.
  /// @throws InputError with every faulty line
  static ToolTable parse(std::string_view text, const std::string& file);

  /// @throws InputError (without a place) for a second tool of the same number
  void add(const ToolEntry& tool);

  /// nullptr if there is no such tool.
  const ToolEntry* find(int number) const;
  const std::map<int, ToolEntry>& entries() const { return tools_; }  ///< by number
  bool empty() const { return tools_.empty(); }
  std::size_t size() const { return tools_.size(); }

 private:
  std::map<int, ToolEntry> tools_;
};

}  // namespace servomill::controllers
