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

AxisWords ModalState::rotated(const AxisWords& v) const {
  return turned(v, cos_rotation, sin_rotation);
}

AxisWords ModalState::to_machine(const AxisWords& work) const {
  return rotated(work + shift) + work_offset + tool_offset;
}

AxisWords ModalState::to_work(const AxisWords& machine) const {
  return turned(machine - work_offset - tool_offset, cos_rotation, -sin_rotation) - shift;
}

AxisWords ModalState::target_to_work(const AxisWords& machine) const {
  AxisWords work = to_work(machine);
  work.tail<3>() += tool_offset.tail<3>();
  return work;
}

}  // namespace servomill::controllers
