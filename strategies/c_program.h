/// Programs as plug-ins see and rewrite them (strategies/plugin_c.h).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "strategies/plugin_c.h"

namespace servomill::strategies {

/// Most blocks that a plug-in may make of a program.
inline constexpr std::size_t kMaxPluginBlocks = 5'000'000;

/// The motions of a program, for one call of `rewrite`, and the blocks that it adds.
class CProgram {
 public:
  /// @param moves  without tool-centre-point control; must outlive this
  /// @param start  (5; m, rad), where the program begins
  CProgram(const std::vector<Move>& moves, const JointLayout& layout, const Joints& start);
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

/// The moves with blocks in place of the motions that they name. Blocks carry over line, arc length
/// and feed of their motion.
/// @param displaces_rotary  false: rotary axes must stay on the programmed path
/// @param wrong             why a block cannot be; empty if all can
std::vector<Move> with_blocks(const std::vector<Move>& moves,
                              const std::vector<servomill_block>& blocks, const JointLayout& layout,
                              const Joints& start, bool displaces_rotary, std::string& wrong);

}  // namespace servomill::strategies
