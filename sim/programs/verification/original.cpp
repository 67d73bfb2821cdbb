#include "sim/programs/verification/original.h"

#include <algorithm>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;
using controllers::Group;

constexpr double kStill = 1e-12;  // m, rad: what rounding leaves of positions

// One with '/'; it counts as such if it is run, too.
bool is_optional(const ExecutedBlock& block) {
  if (block.block == nullptr || block.block->deleted) return false;
  const auto& pieces = block.block->pieces;
  return std::any_of(pieces.begin(), pieces.end(), [](const controllers::Piece& piece) {
    return piece.kind == controllers::PieceKind::block_delete;
  });
}

// The tool whose length is in force, or else that in the spindle.
Eigen::Vector3d working_tool(const controllers::ModalState& state,
                             const controllers::ToolTable& tools) {
  if (!state.tool_offset.isZero(0.0)) return state.p_ST();
  const controllers::ToolEntry* tool = tools.find(state.tool);
  return tool == nullptr ? state.p_ST() : Eigen::Vector3d(-tool->offset.head<3>());
}

}  // namespace

controllers::ActionKind kind_of(MoveKind kind) {
  using controllers::ActionKind;
  switch (kind) {
    case MoveKind::rapid:
      return ActionKind::rapid;
    case MoveKind::feed:
      return ActionKind::feed;
    case MoveKind::arc:
      return ActionKind::arc;
    case MoveKind::dwell:
      return ActionKind::dwell;
    case MoveKind::tool:
      return ActionKind::tool;
    case MoveKind::stop:
      return ActionKind::stop;
    default:
      return ActionKind::end;
  }
}

AxisFlags6 OriginalAction::changed() const {
  AxisFlags6 out{};
  for (int i = 0; i < kAxisWords; ++i) {
    out[static_cast<std::size_t>(i)] = std::abs(move.end_machine[i] - begin[i]) > kStill;
  }
  return out;
}

bool OriginalAction::moves_tip() const {
  const bool is_of_workpiece =
      !is_machine_position || (is_reference_return && !is_to_reference);  // on the way to it
  return is_motion(move.kind) && is_of_workpiece && (is_named[2] || changed()[2]);
}

Original::Original(controllers::ProgramText text, const controllers::ProgramSetup& setup,
                   const OriginalOptions& options)
    : setup_(setup),
      options_(options),
      interpreter_(std::move(text), setup),
      position_(setup.start),
      known_(options.is_start_known),
      ever_known_(options.is_start_known) {}

const OriginalAction* Original::next() {
  while (waiting_.empty()) {
    const auto block = interpreter_.next_block();
    if (!block) return nullptr;
    take(*block);
  }
  current_ = std::move(waiting_.front());
  waiting_.pop_front();
  return &current_;
}

void Original::take(const ExecutedBlock& block) {
  text_ = block.text;
  line_ = block.line;
  has_optional_blocks_ = has_optional_blocks_ || is_optional(block);
  if (block.request != nullptr && block.request->code(Group::g_path_control) >= 0) {
    has_path_mode_ = true;
  }
  std::size_t motions = static_cast<std::size_t>(
      std::count_if(block.moves.begin(), block.moves.end(),
                    [](const Move& move) { return is_motion(move.kind); }));
  for (const Move& move : block.moves) {
    if (is_motion(move.kind)) {
      take_motion(move, block, --motions == 0);
    } else {
      take_other(move);
    }
  }
}

void Original::take_motion(const Move& move, const ExecutedBlock& block, bool is_last) {
  OriginalAction action;
  action.move = move;
  action.begin = position_;
  action.was_known = known_;
  action.was_ever_known = ever_known_;
  action.auxiliary = auxiliary_;
  // a canned cycle follows its path exactly (G61), whatever is in force
  const bool is_cycle =
      block.request != nullptr && controllers::is_canned_cycle(block.request->motion_code());
  action.is_of_cycle = is_cycle;
  action.has_path_mode = has_path_mode_ || (is_cycle && move.path_mode == PathMode::exact_path);
  const int code = non_modal_code(block);
  action.is_machine_position = code == 530 || code == 280 || code == 300;
  action.is_reference_return = code == 280 || code == 300;
  action.is_to_reference = action.is_reference_return && is_last;
  action.p_ST = working_tool(*block.state, setup_.tools);
  // moves that cutter compensation held back and those of cycles are not what the block names
  if (move.line == block.line && !is_cycle) {
    for (std::size_t k = 0; k < kAxisWords; ++k) {
      action.is_named[k] = names_axis(block, kAllAxes[k]);
    }
  }
  learn(action, block);
  position_ = move.end_machine;
  waiting_.push_back(std::move(action));
}

void Original::learn(OriginalAction& action, const ExecutedBlock& block) {
  const bool is_absolute = !block.state->is_incremental || action.is_machine_position;
  const AxisFlags6 changed = action.changed();
  bool is_any_named = false;
  for (const Axis axis : kAllAxes) is_any_named |= names_axis(block, axis);
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!options_.layout.joint_of(kAllAxes[k])) known_[k] = true;
    if (is_absolute && names_axis(block, kAllAxes[k])) known_[k] = ever_known_[k] = true;
    if (!action.is_to_reference) continue;
    if (!is_any_named) action.is_named[k] = options_.layout.joint_of(kAllAxes[k]).has_value();
    // another control's reference position is another place
    const bool moves = action.is_named[k] || changed[k];
    if (moves) known_[k] = ever_known_[k] = !options_.forgets_positions;
  }
  action.is_known = known_;
}

void Original::take_other(const Move& move) {
  switch (move.kind) {
    case MoveKind::spindle:
      auxiliary_.direction = move.direction;
      auxiliary_.speed = move.value;
      return;
    case MoveKind::coolant:
      auxiliary_.coolant = move.number;
      return;
    case MoveKind::dwell:
      if (move.value == 0.0) return;
      [[fallthrough]];
    case MoveKind::tool:
    case MoveKind::stop:
    case MoveKind::end: {
      OriginalAction action;
      action.move = move;
      action.begin = position_;
      action.auxiliary = auxiliary_;
      if (move.kind == MoveKind::tool) auxiliary_.direction.reset();  // it stops the spindle
      const bool may_move = move.kind == MoveKind::tool || move.kind == MoveKind::stop;
      if (options_.forgets_positions && may_move) known_ = {};
      action.is_known = known_;
      waiting_.push_back(std::move(action));
      return;
    }
    default:
      return;
  }
}

}  // namespace servomill::sim::programs
