/// Programs as plug-ins see and rewrite them (strategies/plugin_c.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/put_move.h"
#include "strategies/plugin_c.h"

namespace servomill::strategies {

/// Most blocks that a plug-in may make of a program. They are in memory, as the interface has
/// arrays of moves and functions that take any of them: 460 bytes a motion and 72 a block.
inline constexpr std::size_t kMaxPluginBlocks = 5'000'000;

/// The motions of a program, for one call of `rewrite`, and the blocks that it adds.
class CProgram {
 public:
  /// @param moves  without tool-centre-point control
  /// @param start  (5; m, rad), where the program begins
  CProgram(const MoveRange& moves, const JointLayout& layout, const Joints& start);
  ~CProgram();
  CProgram(const CProgram&) = delete;
  CProgram& operator=(const CProgram&) = delete;

  const servomill_program* program() const;
  /// The blocks that were added, in their order.
  std::vector<servomill_block> take_blocks();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Hands out the moves with blocks in place of the motions that they name. Blocks carry over line,
/// arc length and feed of their motion.
/// @param displaces_rotary  false: rotary axes must stay on the programmed path
/// @return why a block is refused, after which nothing is handed out; empty if none is
std::string put_with_blocks(const MoveRange& moves, const std::vector<servomill_block>& blocks,
                            const JointLayout& layout, const Joints& start, bool displaces_rotary,
                            const PutMove& put);

}  // namespace servomill::strategies
