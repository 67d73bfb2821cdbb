#include "controllers/gcode/modal_state.h"

#include <cmath>

namespace servomill::controllers {
namespace {

AxisWords turned(const AxisWords& v, double c, double s) {
  AxisWords out = v;
  out[0] = c * v[0] - s * v[1];
  out[1] = s * v[0] + c * v[1];
  return out;
}

// Only rotary axes of a tool offset count while the tip is controlled.
AxisWords rotary_part(AxisWords words) {
  words.head<3>().setZero();
  return words;
}

AxisWords from_plane(const WorkPlane* plane, AxisWords p) {
  if (plane != nullptr) p.head<3>() = plane->R * p.head<3>() + plane->origin;
  return p;
}

AxisWords to_plane(const WorkPlane* plane, AxisWords p) {
  if (plane != nullptr) p.head<3>() = plane->R.transpose() * (p.head<3>() - plane->origin);
  return p;
}

}  // namespace

bool WorkZero::is_at(const WorkZero& other) const {
  constexpr double kRounding = 1e-9;  // m, rad
  return (origin - other.origin).cwiseAbs().maxCoeff() <= kRounding &&
         std::abs(cos_rotation - other.cos_rotation) <= kRounding &&
         std::abs(sin_rotation - other.sin_rotation) <= kRounding;
}

void ModalState::set_rotation(double angle) {
  cos_rotation = std::cos(angle);
  sin_rotation = std::sin(angle);
}

void ModalState::set_tool_offset(const AxisWords& offset) { tool_offset = tool_account = offset; }

void ModalState::set_unit(double new_unit) {
  tool_account.head<3>() *= new_unit / unit;
  unit = new_unit;
}

AxisWords ModalState::with_plane(AxisWords p, const Eigen::Vector2d& in_plane) const {
  p[first_axis()] = in_plane.x();
  p[second_axis()] = in_plane.y();
  return p;
}

AxisWords ModalState::rotated(const AxisWords& v) const {
  return turned(v, cos_rotation, sin_rotation);
}

AxisWords ModalState::unrotated(const AxisWords& v) const {
  return turned(v, cos_rotation, -sin_rotation);
}

WorkPlane ModalState::plane_in_workpiece() const {
  const WorkPlane in_work = plane ? *plane : WorkPlane{};
  AxisWords origin = AxisWords::Zero();
  origin.head<3>() = in_work.origin;
  WorkPlane out;
  out.origin = (rotated(origin + shift) + work_offset).head<3>();
  for (int i = 0; i < 3; ++i) {
    AxisWords column = AxisWords::Zero();
    column.head<3>() = in_work.R.col(i);
    out.R.col(i) = rotated(column).head<3>();
  }
  return out;
}

Eigen::Vector3d ModalState::direction_in_workpiece(const Eigen::Vector3d& v) const {
  return plane_in_workpiece().R * v;
}

AxisWords ModalState::to_machine(const AxisWords& work) const {
  if (!controls_tip()) return rotated(work + shift) + work_offset + tool_offset;
  return rotated(from_plane(plane.get(), work) + shift) + work_offset + rotary_part(tool_offset);
}

AxisWords ModalState::to_account(const AxisWords& work) const {
  if (controls_tip()) return to_machine(work);
  return rotated(work + shift) + work_offset + tool_account;
}

AxisWords ModalState::from_account(const AxisWords& machine) const {
  if (!controls_tip()) return unrotated(machine - work_offset - tool_account) - shift;
  const AxisWords turned_back = unrotated(machine - work_offset - rotary_part(tool_offset));
  return to_plane(plane.get(), turned_back - shift);
}

AxisWords ModalState::target_to_work(const AxisWords& machine) const {
  AxisWords work = from_account(machine);
  work.tail<3>() += tool_offset.tail<3>();
  return work;
}

}  // namespace servomill::controllers
