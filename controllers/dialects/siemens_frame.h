/// Offsets between the program's coordinates and those of the machine in one block.
#pragma once

#include <array>

#include "controllers/dialects/siemens_state.h"

namespace servomill::controllers {

/// machine = R program + offset + length, R a rotation about Z. Each part is evaluated for the axis
/// that needs it, so that an unknown offset of one axis does not refuse another.
class SiemensFrame {
 public:
  SiemensFrame(const SiemensState& state, const SiemensBlock& block, const SiemensContext& context);

  bool is_of_machine() const { return is_of_machine_; }
  bool length_is_in_force() const;  // false: D0, no tool, or suppressed; true where D is unknown
  double rotation() const { return rotation_; }  // rad; 0 with SUPA

  /// @throw InputError where the offset or the length of the axis is not determined
  double offset(int axis) const { return offset_[axis]; }
  double length(int axis) const;

  /// The axis along which tool lengths act; nullopt: it depends on the plane, which is unknown.
  std::optional<int> axis_of_any_length() const;
  /// The axis that the length of the tool in force moves; -1: none.
  int length_axis() const;

  /// Machine position of X and Y, or of all axes where nothing rotates.
  void to_machine(AxisWords& words, const std::array<bool, kAxisWords>& is_used) const;
  /// Program position of an axis, where the machine's is known (with a rotation: of X and Y).
  std::optional<double> program(const KnownPosition& machine, int axis) const;

 private:
  [[noreturn]] void fail(std::string message) const;
  void read_offset();

  const SiemensState& state_;
  const SiemensBlock& block_;
  const SiemensContext& context_;
  bool is_of_machine_ = false;
  AxisWords offset_ = AxisWords::Zero();
  double rotation_ = 0.0;
};

}  // namespace servomill::controllers
