/// The run of a program in another language, block by block, to lines of G-code.
#pragma once

#include <functional>
#include <optional>

#include "controllers/translation/contour_path.h"
#include "controllers/translation/gcode_lines.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::translation {

class BlockRun {
 public:
  /// @param lines, path  those of the translator, which outlive this
  /// @param most_jumps   after so many, the program is considered endless
  BlockRun(GcodeLines& lines, ContourPath& path, long most_jumps)
      : lines_(lines), path_(path), most_jumps_(most_jumps) {}

  /// The next line; nullopt after the end of the program. Blocks run until there is one.
  /// @throws InputError that a block has thrown, after the lines of all blocks before it
  std::optional<GcodeLine> next(const std::function<void()>& run_block);
  /// No block runs any more.
  void end() { has_ended_ = true; }
  /// Counts a block; ten of them after the first jump count as a jump.
  /// @throws InputError if the program looks endless
  void count_block(const Place& place);
  void count_jump(const Place& place);

 private:
  void hold_back(const InputError& error);

  GcodeLines& lines_;
  ContourPath& path_;
  long most_jumps_;
  long jumps_ = 0, blocks_ = 0;      // blocks: since the first jump
  std::optional<InputError> error_;  // thrown once the lines before it have been returned
  bool has_ended_ = false;
};

}  // namespace servomill::controllers::translation
