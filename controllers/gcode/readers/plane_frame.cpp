#include "controllers/gcode/readers/plane_frame.h"

#include <Eigen/Geometry>

namespace servomill::controllers {
namespace {

Eigen::Matrix3d rotation_of(const PlaneFrame& frame) {
  return Eigen::AngleAxisd(frame.angle, Eigen::Vector3d::Unit(frame.normal_axis))
      .toRotationMatrix();
}

}  // namespace

bool PlaneFrame::flips(int normal) const {
  return scale[(normal + 1) % 3] * scale[(normal + 2) % 3] < 0.0;
}

bool PlaneFrame::concerns(int axis) const {
  if (axis > 2) return false;
  return (is_rotated && axis != normal_axis) || scale[axis] != 1.0 || translation[axis] != 0.0;
}

Eigen::Vector3d PlaneFrame::vector_to_work(const Eigen::Vector3d& v) const {
  const Eigen::Vector3d scaled = scale.cwiseProduct(v);
  return is_rotated ? Eigen::Vector3d(rotation_of(*this) * scaled) : scaled;
}

Eigen::Vector3d PlaneFrame::to_work(const Eigen::Vector3d& p) const {
  Eigen::Vector3d out = scale_centre + scale.cwiseProduct(p - scale_centre);
  if (is_rotated) out = rotation_of(*this) * (out - rotation_centre) + rotation_centre;
  return out + translation;
}

Eigen::Vector3d PlaneFrame::from_work(const Eigen::Vector3d& p) const {
  Eigen::Vector3d out = p - translation;
  if (is_rotated) out = rotation_of(*this).transpose() * (out - rotation_centre) + rotation_centre;
  return scale_centre + (out - scale_centre).cwiseQuotient(scale);
}

}  // namespace servomill::controllers
