/// The actions of a machine that runs a program, in machine coordinates: what the readers of other
/// controls' programs return, and what verification compares with the original.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// Axis positions (6; m, rad). nullopt: nothing that the program or the operator entered determines
/// the position of this axis.
using KnownPosition = std::array<std::optional<double>, kAxisWords>;

enum class ActionKind : std::uint8_t {
  rapid,
  feed,  // straight in the axes
  arc,   // or helix, at feed
  dwell,
  tool,     // tool change to `number`
  spindle,  // `direction` and `value`
  coolant,  // `number`: bit 0 mist, bit 1 flood; the state after the block
  stop,     // M0, M1 (`number` 0, 1)
  end,      // M2, M30
  probe,    // straight at feed until the probe switches; the axes that it names stand somewhere
};

/// One action. Motion: `end` is the position of every axis after it, `is_commanded` the axes that
/// the block names. An axis that is not commanded keeps its position, known or unknown.
struct MachineAction {
  ActionKind kind = ActionKind::rapid;
  int line = 0;  // of the program text, from 1
  std::array<bool, kAxisWords> is_commanded{};
  KnownPosition end;  // machine coordinates: work offset and tool length applied; m, rad

  bool is_machine_position = false;  // G53, SUPA, M91, G28: without work offset and tool length
  bool is_to_reference = false;      // G28, G30: the control's own reference position
  bool is_straight = true;           // rapid: false where each axis runs at its own rate
  int normal_axis = 2;               // arc: 0 YZ, 1 ZX, 2 XY
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // arc: machine coordinates, m
  int turns = 1;                                     // arc: as Arc::turns

  FeedMode feed_mode = FeedMode::units_per_minute;
  /// units_per_minute: m/s along the path, rad/s where no linear axis moves. inverse_time: 1/s.
  /// units_per_revolution: m (rad) per revolution.
  double feed = 0.0;
  PathMode path_mode = PathMode::continuous;  // in force during the motion
  std::optional<double> path_tolerance;       // m; nullopt: the control's own
  bool is_path_mode_known = false;            // false: whatever the control starts with

  int tool = 0;         // motion: number of the tool in the spindle; 0: none or unknown
  int tool_offset = 0;  // motion: number of the length in force at its end; 0: none
  double value = 0.0;   // dwell: s; spindle: rad/s
  int number = 0;
  int direction = 0;  // spindle: 1 clockwise (M3), -1 (M4), 0 off (M5); probe: of its axis

  bool operator==(const MachineAction&) const = default;
};

/// Entries of the operator in the control, and the position at the start as far as it is known.
struct ControlSetup {
  /// G54 ... G59.3 (Heidenhain: presets from `first_preset` on) in machine coordinates; nullopt:
  /// unknown.
  std::array<std::optional<AxisWords>, 9> work_offset;
  int first_preset = 1;                   // Heidenhain: it is active at the start
  std::array<double, 9> work_rotation{};  // about Z; rad
  std::map<int, double> tool_length;      // by number of tool or offset; m. Absent: unknown
  KnownPosition start;                    // machine coordinates; m, rad
  bool skips_blocks = false;              // the switch for blocks with '/'
};

}  // namespace servomill::controllers
