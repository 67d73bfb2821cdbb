/// Program coordinates that G16, G51, G51.1, G54.1 and G68 put before work coordinates.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace servomill::controllers {

/// Scaling and mirror image, then a rotation of the plane, then a translation:
/// p_work = R (centre_s + S (p - centre_s) - centre_r) + centre_r + translation; m.
struct PlaneFrame {
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  // < 0: mirrored
  Eigen::Vector3d scale_centre = Eigen::Vector3d::Zero();
  bool is_scaled = false, is_mirrored = false;
  double angle = 0.0;  // rad, about the normal of the plane
  Eigen::Vector3d rotation_centre = Eigen::Vector3d::Zero();
  bool is_rotated = false;
  int normal_axis = 2;                                    // of the plane that is rotated
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // of G54.1 from the work system in force
  bool is_translated = false;
  int additional_system = 0;  // P of G54.1 in force; 0: none
  bool is_translation_known = true;

  bool is_active() const { return is_scaled || is_mirrored || is_rotated || is_translated; }
  /// G2 becomes G3 and left becomes right.
  bool flips(int normal) const;
  /// The axis has other coordinates than in the work system, or shares them with others.
  bool concerns(int axis) const;
  Eigen::Vector3d vector_to_work(const Eigen::Vector3d& v) const;
  Eigen::Vector3d to_work(const Eigen::Vector3d& p) const;
  Eigen::Vector3d from_work(const Eigen::Vector3d& p) const;
};

/// Polar coordinates of G16 in force.
struct PolarMode {
  bool is_on = false;
  double radius = 0.0;  // m
  double angle = 0.0;   // rad
  bool has_radius = false, has_angle = false;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // of absolute coordinates
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // in the plane, program coordinates; m
};

}  // namespace servomill::controllers
