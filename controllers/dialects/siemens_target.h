/// Target of one block in program coordinates: the positions of its words, absolute, incremental or
/// of a modulo axis, and those of the axes that move along although no word names them.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "controllers/dialects/siemens_frame.h"
#include "controllers/dialects/siemens_state.h"

namespace servomill::controllers {

/// 'X' of axis 0 and so on.
char siemens_axis_letter(int axis);
/// Place of an axis in the lists of a block.
inline std::size_t place_of(int axis) { return static_cast<std::size_t>(axis); }
inline bool is_linear_axis(int axis) { return axis < 3; }

class SiemensTarget {
 public:
  /// All of them outlive the target.
  SiemensTarget(const SiemensState& state, const SiemensBlock& block, const SiemensContext& context,
                const SiemensFrame& frame)
      : state_(state), block_(block), context_(context), frame_(frame) {}

  /// Positions of the words of the block.
  void read();

  /// m, rad; 0 of axes that are not used. At the end of siemens_motion machine coordinates.
  AxisWords words = AxisWords::Zero();
  std::array<bool, kAxisWords> is_used{};       // has a position
  std::array<bool, kAxisWords> is_commanded{};  // moves because of the block

  /// The axis stays where it is, but its position counts.
  void add_start(int axis);

  /// Unit of a word of this axis (m, rad).
  double unit_of(int axis, int column) const;
  /// @param name  of the word, for messages
  bool is_incremental(const SiemensNumber& word, char name) const;

 private:
  [[noreturn]] void fail(int column, std::string message) const;
  double angle_of(int axis, SiemensForm form, double value) const;
  double start_of_increment(int axis, int column) const;
  void complete_rotated_plane();

  const SiemensState& state_;
  const SiemensBlock& block_;
  const SiemensContext& context_;
  const SiemensFrame& frame_;
};

}  // namespace servomill::controllers
