/// Axis names (ISO 841) and the two vectors of axis positions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace servomill {

enum class Axis : std::uint8_t { X, Y, Z, A, B, C };

inline constexpr int kAxisWords = 6;
inline constexpr std::array<Axis, kAxisWords> kAllAxes = {Axis::X, Axis::Y, Axis::Z,
                                                          Axis::A, Axis::B, Axis::C};

/// Axis words of a program: X Y Z A B C (6; m, rad).
using AxisWords = Eigen::Matrix<double, kAxisWords, 1>;

inline constexpr int kJoints = 5;
inline constexpr int kLinearJoints = 3;

/// Axes of a machine: X, Y, Z and its (at most two) rotary axes in alphabetical order (5; m, rad).
/// Linear coordinates count the motion of the tool relative to the workpiece, whichever side of the
/// bed carries the axis. The place of an axis that the machine lacks holds 0.
using Joints = Eigen::Matrix<double, kJoints, 1>;

constexpr bool is_linear(Axis axis) { return axis <= Axis::Z; }
constexpr int index_of(Axis axis) { return static_cast<int>(axis); }
constexpr char letter(Axis axis) { return "XYZABC"[index_of(axis)]; }

/// Axis of a letter; lower case is accepted.
std::optional<Axis> axis_of(char letter);

/// The axes of a machine in the order of its `Joints`.
struct JointLayout {
  std::array<std::optional<Axis>, kJoints> axis;  // nullopt: the machine has no such axis

  /// Place of `a` in `Joints`, or nullopt if the machine lacks it.
  std::optional<int> joint_of(Axis a) const;
  bool has(int joint) const { return axis[static_cast<std::size_t>(joint)].has_value(); }
  char letter_of(int joint) const;

  Joints joints(const AxisWords& words) const;  ///< drops axes that the machine lacks
  AxisWords words(const Joints& Q) const;       ///< 0 for axes that the machine lacks

  bool operator==(const JointLayout&) const = default;
};

}  // namespace servomill
