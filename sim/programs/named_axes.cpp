#include "sim/programs/named_axes.h"

#include "controllers/gcode/request.h"

namespace servomill::sim::programs {

int non_modal_code(const controllers::ExecutedBlock& block) {
  return block.request == nullptr ? -1 : block.request->code(controllers::Group::g_non_modal);
}

bool names_axis(const controllers::ExecutedBlock& block, Axis axis) {
  if (block.request == nullptr) return false;
  const bool is_of_plane = axis == Axis::X || axis == Axis::Y;
  return block.request->has(letter(axis)) || (is_of_plane && block.request->has_polar());
}

}  // namespace servomill::sim::programs
