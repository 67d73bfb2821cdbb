/// The programmable frame of a Siemens program: TRANS, ROT, SCALE, MIRROR and their additive forms.
/// Lengths in mm, angles in degrees.
#pragma once

#include <Eigen/Core>
#include <array>

#include "controllers/translation/gcode_lines.h"

namespace servomill::controllers::siemens {

using translation::Point;

/// work = shift + matrix * program; rotary axes are shifted and mirrored only.
class Frame {
 public:
  bool operator==(const Frame& other) const = default;
  bool is_plain() const { return *this == Frame{}; }

  /// Further transformations act in the coordinates that this frame gives the program.
  void translate(const Eigen::Vector3d& by);
  void rotate(int axis, double angle_deg);
  void scale(const Eigen::Vector3d& by);
  void mirror(int axis);
  void translate_rotary(std::size_t axis, double by) {
    rotary_shift_[axis - 3] += rotary_increment(axis, by);
  }
  void mirror_rotary(std::size_t axis);

  Eigen::Vector3d to_work(const Eigen::Vector3d& program) const {
    return shift_ + matrix_ * program;
  }
  Eigen::Vector3d increment(const Eigen::Vector3d& program) const { return matrix_ * program; }
  Eigen::Vector3d to_program(const Eigen::Vector3d& work) const {
    return inverse_ * (work - shift_);
  }
  /// Axis `work` moves with axis `program`.
  bool couples(int work, int program) const { return matrix_(work, program) != 0.0; }
  bool couples_back(int program, int work) const { return inverse_(program, work) != 0.0; }
  double rotary_to_work(std::size_t axis, double program) const;
  double rotary_to_program(std::size_t axis, double work) const;
  double rotary_increment(std::size_t axis, double program) const;

  /// True if a plane of the program is the same plane of the work system: arcs stay arcs in it if
  /// both axes are scaled alike.
  bool keeps_plane(int normal) const;
  bool is_alike_in_plane(int normal) const;
  /// Arcs of the plane run the other way round, and the tool is on the other side.
  bool is_mirrored(int normal) const;
  /// True without SCALE.
  bool keeps_lengths() const;
  /// Scale of lengths in the plane.
  double scale_in_plane(int normal) const;

 private:
  void multiply(const Eigen::Matrix3d& by);

  Eigen::Matrix3d matrix_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
  std::array<double, 3> rotary_shift_{};
  std::array<bool, 3> is_rotary_mirrored_{};
};

}  // namespace servomill::controllers::siemens
