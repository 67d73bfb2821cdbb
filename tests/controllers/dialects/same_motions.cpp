#include "same_motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace servomill::controllers {
namespace {

constexpr double kPositionTol = 1e-11;  // m, rad: printed with a picometre
constexpr double kFeedTol = 1e-9;       // relative

ActionKind kind_of(MoveKind kind) {
  switch (kind) {
    case MoveKind::rapid:
      return ActionKind::rapid;
    case MoveKind::feed:
      return ActionKind::feed;
    case MoveKind::arc:
      return ActionKind::arc;
    default:
      return ActionKind::dwell;
  }
}

void expect_equal(const Move& move, const MachineAction& action) {
  SCOPED_TRACE(fmt::format("line {}", action.line));
  EXPECT_EQ(move.line, action.line);
  ASSERT_EQ(kind_of(move.kind), action.kind);
  if (move.kind == MoveKind::dwell) {
    EXPECT_NEAR(move.value, action.value, 1e-12);
    return;
  }
  for (int i = 0; i < kAxisWords; ++i) {
    const auto& end = action.end[static_cast<std::size_t>(i)];
    if (end) {
      EXPECT_NEAR(move.end_machine[i], *end, kPositionTol)
          << letter(kAllAxes[static_cast<std::size_t>(i)]);
    }
  }
  if (move.kind == MoveKind::rapid) return;
  if (action.feed_mode == FeedMode::units_per_minute && move.feed_mode == action.feed_mode) {
    EXPECT_NEAR(move.feed / action.feed, 1.0, kFeedTol);
  }
  if (move.kind != MoveKind::arc) return;
  EXPECT_EQ(move.arc.turns, action.turns);
  ASSERT_EQ(move.arc.normal_axis, action.normal_axis);
  for (int i = 0; i < 3; ++i) {
    if (i != action.normal_axis) {
      EXPECT_NEAR(move.centre_machine[i], action.centre[i], kPositionTol);
    }
  }
}

}  // namespace

ProgramSetup setup_of(const ControlSetup& control, Reader reader) {
  ProgramSetup setup;
  setup.reader = reader;
  setup.block_delete = control.skips_blocks;
  for (std::size_t i = 0; i < 9; ++i) {
    if (control.work_offset[i]) setup.work_offset[i] = *control.work_offset[i];
    setup.work_rotation[i] = control.work_rotation[i];
  }
  for (const auto& [number, length] : control.tool_length) {
    ToolEntry tool;
    tool.number = number;
    tool.offset[2] = length;
    setup.tools.add(tool);
  }
  return setup;
}

std::size_t expect_same_motions(std::vector<Move> moves, std::vector<MachineAction> actions) {
  std::erase_if(actions, [](const auto& one) { return one.kind > ActionKind::dwell; });
  std::erase_if(moves, [](const auto& one) { return one.kind > MoveKind::dwell; });
  EXPECT_EQ(moves.size(), actions.size());
  for (std::size_t i = 0; i < std::min(moves.size(), actions.size()); ++i) {
    expect_equal(moves[i], actions[i]);
  }
  return moves.size();
}

}  // namespace servomill::controllers
