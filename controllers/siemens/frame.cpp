#include "controllers/siemens/frame.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

// Rotations by right angles leave 1e-17 where 0 is meant, which would couple axes.
Eigen::Matrix3d rounded(const Eigen::Matrix3d& M) {
  constexpr double kRounding = 1e-15;
  const double size = M.cwiseAbs().maxCoeff();
  return M.unaryExpr([&](double x) { return std::abs(x) < kRounding * size ? 0.0 : x; });
}

}  // namespace

void Frame::multiply(const Eigen::Matrix3d& by) {
  matrix_ = rounded(matrix_ * by);
  inverse_ = rounded(matrix_.inverse());
}

void Frame::translate(const Eigen::Vector3d& by) { shift_ += matrix_ * by; }

void Frame::rotate(int axis, double angle_deg) {
  multiply(Eigen::AngleAxisd(angle_deg * deg, Eigen::Vector3d::Unit(axis)).toRotationMatrix());
}

void Frame::scale(const Eigen::Vector3d& by) { multiply(by.asDiagonal().toDenseMatrix()); }

void Frame::mirror(int axis) {
  Eigen::Vector3d by = Eigen::Vector3d::Ones();
  by[axis] = -1.0;
  scale(by);
}

void Frame::mirror_rotary(std::size_t axis) {
  is_rotary_mirrored_[axis - 3] = !is_rotary_mirrored_[axis - 3];
}

double Frame::rotary_increment(std::size_t axis, double program) const {
  return is_rotary_mirrored_[axis - 3] ? -program : program;
}

double Frame::rotary_to_work(std::size_t axis, double program) const {
  return rotary_shift_[axis - 3] + rotary_increment(axis, program);
}

double Frame::rotary_to_program(std::size_t axis, double work) const {
  return rotary_increment(axis, work - rotary_shift_[axis - 3]);
}

bool Frame::keeps_plane(int normal) const {
  for (int i = 0; i < 3; ++i) {
    if (i != normal && (matrix_(i, normal) != 0.0 || matrix_(normal, i) != 0.0)) return false;
  }
  return true;
}

double Frame::scale_in_plane(int normal) const { return matrix_.col((normal + 1) % 3).norm(); }

bool Frame::keeps_lengths() const {
  constexpr double kEqual = 1e-12;
  return (matrix_.transpose() * matrix_).isIdentity(kEqual);
}

bool Frame::is_alike_in_plane(int normal) const {
  constexpr double kEqual = 1e-12;
  const Eigen::Vector3d u = matrix_.col((normal + 1) % 3), v = matrix_.col((normal + 2) % 3);
  return std::abs(u.norm() - v.norm()) <= kEqual * u.norm() &&
         std::abs(u.dot(v)) <= kEqual * u.squaredNorm();
}

bool Frame::is_mirrored(int normal) const {
  const int u = (normal + 1) % 3, v = (normal + 2) % 3;
  return matrix_(u, u) * matrix_(v, v) - matrix_(u, v) * matrix_(v, u) < 0.0;
}

}  // namespace servomill::controllers::siemens
