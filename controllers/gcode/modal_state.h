/// Modal state of the interpreter from block to block, parameters aside.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/cutter_compensation.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

inline constexpr int kWorkSystems = 9;          // G54 ... G59.3
inline constexpr int kOtherToolOffset = -1;     // `Move::tool_offset` of G43.1 and G43.2
inline constexpr int kPrintMessage = 1;         // `Move::number` of (PRINT, ...); else 0
inline constexpr double kSlowestInverse = 0.1;  // mm, inch or deg per minute under G93: LinuxCNC
inline constexpr int kMist = 1, kFlood = 2;     // bits of `Move::number` of a coolant move

/// An axis word as the value of a parameter, in mm or degrees, and back.
/// @param axis  0 ... 5, X to C
inline double in_parameter_unit(int axis, double value) { return value / (axis < 3 ? mm : deg); }
inline double from_parameter_unit(int axis, double value) { return value * (axis < 3 ? mm : deg); }

/// Cutter compensation in force, and the moves that wait until the next one is known.
struct Compensation {
  struct Waiting {
    Move move;
    HeldMove path;  // of a motion
  };
  bool is_on = false;
  bool is_first_corner = false;  // the next corner is that behind the entry
  bool is_entered = false;       // the first move was made: the tool is beside the programmed path
  bool is_radius_unknown = false;  // no table has the tool: the programmed path is followed
  Cutter cutter;
  Eigen::Vector2d programmed = Eigen::Vector2d::Zero();  // where the programmed path is now
  std::vector<Waiting> queue;            // a motion, and what followed without moving in the plane
  HeldMove last_front;                   // of the queue before this one
  std::optional<Eigen::Vector2d> begin;  // where the front of the queue begins, if known
  bool refuses_arc = false;              // G40, and no straight move since
  /// Place of the tool after G40, as `to_account`; until the next motion. M6 continues from there.
  std::optional<AxisWords> left_at;

  bool acts() const { return is_on && cutter.radius > 0.0; }
  const HeldMove& front() const { return queue.empty() ? last_front : queue.front().path; }
};

/// Origin of work coordinates in other ones, and the rotation of X and Y.
struct WorkZero {
  AxisWords origin = AxisWords::Zero();  // m, rad
  double cos_rotation = 1.0, sin_rotation = 0.0;

  /// But for rounding of offsets that a program sets to what they are.
  bool is_at(const WorkZero& other) const;
};

/// Control points between G5.2 and G5.3.
struct OpenNurbs {
  int order = 3;
  std::vector<Eigen::Vector2d> points;  // m, in work coordinates; first where the tool stands
  std::vector<double> weights;
  // what must not change until G5.3
  AxisWords position = AxisWords::Zero();
  WorkZero zero;
  double unit = mm;
};

/// Positions are SI. Machine coordinates = R (position + shift) + work_offset + tool_offset, where
/// R turns X and Y by the rotation of the work system.
///
/// LinuxCNC keeps its own account of the position with a tool offset whose number it does not
/// convert when G20 or G21 follows. That account is kept here as well (`tool_account`), for it
/// decides where G53, G28 and moves behind a change of tool offset end.
///
/// While the tip is controlled (tool-centre-point control or a tilted work plane) machine
/// coordinates are tip words: X Y Z of the tip in the workpiece. The tool offset is left out of
/// them, and so it is of the account:
/// tip = R (plane (position) + shift) + work_offset.
struct ModalState {
  AxisWords position = AxisWords::Zero();  // in work coordinates; of the compensated tool
  AxisWords shift = AxisWords::Zero();     // G92, G52
  AxisWords work_offset = AxisWords::Zero();
  AxisWords tool_offset = AxisWords::Zero();
  AxisWords tool_account = AxisWords::Zero();
  double cos_rotation = 1.0;
  double sin_rotation = 0.0;
  int work_system = 1;
  int tool_offset_number = 0;
  bool is_length_unknown = false;  // of the tool offset in force, which then counts as 0
  bool is_height_unknown = false;  // work coordinate Z, since such an offset was switched on or off

  ToolControl tool_control = ToolControl::none;         // by G43.4 and G43.5
  Eigen::Vector3d tool_axis = Eigen::Vector3d::Zero();  // k_W of G43.5; 0: none given yet
  std::shared_ptr<const WorkPlane> plane;               // of G68.2, in work coordinates

  Compensation compensation;

  int motion = 800;           // ten times the code; 800: none
  int normal_axis = 2;        // of the plane of arcs and cycles
  bool is_uvw_plane = false;  // G17.1 G18.1 G19.1, where neither can be done
  double unit = mm;           // of length words
  bool is_incremental = false;
  bool is_centre_absolute = false;
  bool retracts_to_r = true;  // G99, as rs274 begins; false: G98
  CycleMemory cycle;          // its i and j are also where a G5 without I and J begins to
  Eigen::Vector2d spline_end = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  OpenNurbs nurbs;
  FeedMode feed_mode = FeedMode::units_per_minute;
  double feed_linear = 0.0;  // m/s, or m per revolution under G95
  double feed_rotary = 0.0;  // rad/s, or rad per revolution
  PathMode path_mode = PathMode::continuous;
  double path_tolerance = 0.0;  // m

  int tool = 0;
  int selected_tool = -1;  // -1: no T yet
  int spindle_direction = 0;
  double spindle_speed = 0.0;  // rad/s
  int coolant = 0;
  bool feed_override = true, speed_override = true;  // M48 ... M51: whether the operator may
  bool adaptive_feed = false, feed_hold = true;      // M52 M53

  double s = 0.0;  // m, length of the XYZ path so far

  void set_rotation(double angle);
  void set_tool_offset(const AxisWords& offset);
  void set_unit(double new_unit);
  /// Indices of the axes of the plane: X Y, Z X or Y Z.
  int first_axis() const { return (normal_axis + 1) % 3; }
  int second_axis() const { return (normal_axis + 2) % 3; }
  Eigen::Vector2d in_plane(const AxisWords& p) const { return {p[first_axis()], p[second_axis()]}; }
  AxisWords with_plane(AxisWords p, const Eigen::Vector2d& in_plane) const;
  /// Programmed position: `position` but for cutter compensation.
  AxisWords programmed() const {
    return compensation.is_entered ? with_plane(position, compensation.programmed) : position;
  }
  /// True if X Y Z are the tip in the workpiece.
  bool controls_tip() const { return tool_control != ToolControl::none || plane != nullptr; }
  /// Tip in the spindle nose, m.
  Eigen::Vector3d p_ST() const { return -tool_offset.head<3>(); }
  /// Frame of the tilted work plane, or of work coordinates without one, in the workpiece.
  WorkPlane plane_in_workpiece() const;
  /// Direction in W of one that the program gives.
  Eigen::Vector3d direction_in_workpiece(const Eigen::Vector3d& v) const;

  /// Frame of work coordinates in machine coordinates, without tool offset and tilted plane.
  WorkZero zero() const { return {rotated(shift) + work_offset, cos_rotation, sin_rotation}; }

  AxisWords rotated(const AxisWords& v) const;
  AxisWords unrotated(const AxisWords& v) const;

  /// Machine coordinates of these work coordinates.
  AxisWords to_machine(const AxisWords& work) const;
  /// The same with `tool_account`, and back.
  AxisWords to_account(const AxisWords& work) const;
  AxisWords from_account(const AxisWords& machine) const;
  /// Work coordinates of a point that a program gives in machine coordinates (G53, G28, G30). As
  /// in LinuxCNC the tool offset of rotary axes, which next to nobody has, is left out.
  AxisWords target_to_work(const AxisWords& machine) const;
};

}  // namespace servomill::controllers
