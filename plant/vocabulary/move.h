/// Canonical moves: what a program asks of the machine, free of syntax, modal state and units.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "plant/vocabulary/axes.h"

namespace servomill {

struct Spline;

enum class MoveKind : std::uint8_t {
  // motion
  rapid,
  feed,  // `number` 2 ... 5: with the probe armed, G38.2 ... G38.5
  arc,
  spline,
  dwell,
  // everything else
  tool,     // M6: `number` is the tool now in the spindle
  spindle,  // M3 M4 M5: `direction`, `value` in rad/s
  coolant,  // M7 M8 M9: `number` bit 0 mist, bit 1 flood
  stop,     // M0 M1 M60 (number 0, 1, 60): waits for the operator, does not in a simulation
  end,      // M2 M30
  message,  // (MSG, ...) `text`
};

enum class FeedMode : std::uint8_t { units_per_minute, inverse_time, units_per_revolution };

/// How the path may leave the programmed one at corners.
enum class PathMode : std::uint8_t {
  exact_path,  // G61: corners are reached exactly, without a stop where none is needed
  exact_stop,  // G61.1: stands still at the end of every move
  continuous,  // G64 P: corners are rounded within `path_tolerance`
};

/// Motion that the spindle turns with: `value` of the move is the lead, m a revolution.
enum class Synchronised : std::uint8_t {
  no,
  thread,   // G33
  tap_in,   // G33.1 to its depth
  tap_out,  // and back, the spindle reversed
};

/// Circle or helix from the point before to `end`, about `centre`; normal is one of the principal
/// axes: 0 for G19 (YZ), 1 for G18 (ZX), 2 for G17 (XY).
struct Arc {
  int normal_axis = 2;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m, like `end`; component along normal unused
  int turns = 1;  // > 0 counter-clockwise about the positive normal, < 0 clockwise; |turns| counts
                  // started revolutions
};

/// Meaning of X Y Z of a move, and source of the tool's orientation.
enum class ToolControl : std::uint8_t {
  none,         // X Y Z are positions of the axes
  rotary_axes,  // G43.4: tip in the workpiece; the rotary axes move linearly to their words
  tool_axis,    // G43.5: tip in the workpiece; the tool axis moves on a great circle
  work_plane,   // G68.2: tip in the workpiece; the rotary axes stand still
};

/// A tilted work plane in the workpiece: p_W = R p + origin.
struct WorkPlane {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m
};

/// One canonical move. `end` is in the active work coordinate system (of a tilted work plane if
/// there is one), `end_machine` in machine coordinates: rotation, work offset and tool offset
/// applied. Without tool control `end_machine` holds the axis positions. With it X Y Z of
/// `end_machine` are the tip in the workpiece frame W, p_WT, tool offset not applied; A B C are the
/// positions of the rotary axes at the end.
struct Move {
  MoveKind kind = MoveKind::feed;
  int line = 0;                                              // of the original program, from 1
  AxisWords end = AxisWords::Zero();                         // m, rad
  AxisWords end_machine = AxisWords::Zero();                 // m, rad
  Arc arc;                                                   // kind arc, centre in work coordinates
  Eigen::Vector3d centre_machine = Eigen::Vector3d::Zero();  // kind arc, m
  double feed =
      0.0;  // m/s if X, Y or Z moves, else rad/s; not for rapid. Per revolution: what it
            // is at the speed of the spindle, 0 while that stands still. NaN in a survey: unknown
  FeedMode feed_mode =
      FeedMode::units_per_minute;  // how it was programmed; `feed` is the same quantity
  PathMode path_mode = PathMode::continuous;
  double path_tolerance = 0.0;  // m; 0 with `continuous`: the machine's default
  double value = 0.0;  // dwell: s; spindle: rad/s; feed per revolution: m or rad a revolution;
                       // synchronised: lead, m a revolution, as programmed
  int number = 0;
  ToolControl tool_control = ToolControl::none;
  Synchronised synchronised = Synchronised::no;  // kind feed
  int direction = 0;                             // spindle: 1 clockwise (M3), -1 (M4), 0 off
  int work_offset = 1;                           // 1 is G54, 9 is G59.3
  bool is_shifted = false;  // work coordinates lie elsewhere than those of G54 when the program
                            // began: G52, G92, G10, or another work system
  int tool_offset = 0;      // H of G43; 0: none (G49)
  Eigen::Vector3d tool_axis = Eigen::Vector3d::UnitZ();  // G43.5: k_W at the end
  std::shared_ptr<const WorkPlane> plane;  // arcs in a tilted plane: where `arc` and `end` lie
  std::shared_ptr<const Spline> spline;    // kind spline (spline_curve.h)
  std::string text;

  // Arc length on the path of the *original* program where this move begins and ends (m). The
  // reader of a program sets them; whoever rewrites moves carries them over.
  double s_begin = 0.0;
  double s_end = 0.0;
};

constexpr bool is_motion(MoveKind kind) { return kind <= MoveKind::spline; }
/// A motion at the programmed feed.
constexpr bool is_feed(MoveKind kind) { return is_motion(kind) && kind != MoveKind::rapid; }

}  // namespace servomill
