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

}  // namespace

void ModalState::set_rotation(double angle) {
  cos_rotation = std::cos(angle);
  sin_rotation = std::sin(angle);
}

void ModalState::set_tool_offset(const AxisWords& offset) { tool_offset = tool_account = offset; }

void ModalState::set_unit(double new_unit) {
  tool_account.head<3>() *= new_unit / unit;
  unit = new_unit;
}

AxisWords ModalState::rotated(const AxisWords& v) const {
  return turned(v, cos_rotation, sin_rotation);
}

AxisWords ModalState::unrotated(const AxisWords& v) const {
  return turned(v, cos_rotation, -sin_rotation);
}

AxisWords ModalState::to_machine(const AxisWords& work) const {
  return rotated(work + shift) + work_offset + tool_offset;
}

AxisWords ModalState::to_account(const AxisWords& work) const {
  return rotated(work + shift) + work_offset + tool_account;
}

AxisWords ModalState::from_account(const AxisWords& machine) const {
  return unrotated(machine - work_offset - tool_account) - shift;
}

AxisWords ModalState::target_to_work(const AxisWords& machine) const {
  AxisWords work = from_account(machine);
  work.tail<3>() += tool_offset.tail<3>();
  return work;
}

}  // namespace servomill::controllers
