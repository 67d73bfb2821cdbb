#include "plant/drives/drive_state.h"

#include <cassert>

namespace servomill::plant {

LaneState DriveState::lane(std::size_t l) const {
  assert(l / kLaneWidth < blocks.size());
  const DriveBlock& b = blocks[l / kLaneWidth];
  const std::size_t j = l % kLaneWidth;
  return {b.i[j],     b.w[j],       b.delta[j],   b.v[j],     b.x[j],    b.z[j],
          b.slide[j], b.contact[j], b.control[j], b.bed_x[j], b.bed_v[j]};
}

void DriveState::set_lane(std::size_t l, const LaneState& s) {
  assert(l / kLaneWidth < blocks.size());
  DriveBlock& b = blocks[l / kLaneWidth];
  const std::size_t j = l % kLaneWidth;
  b.i[j] = s.i;
  b.w[j] = s.w;
  b.delta[j] = s.delta;
  b.v[j] = s.v;
  b.x[j] = s.x;
  b.z[j] = s.z;
  b.known_v[j] = std::numeric_limits<double>::quiet_NaN();
  b.slide[j] = s.slide;
  b.contact[j] = s.contact;
  b.control[j] = s.control;
  b.bed_x[j] = s.bed_x;
  b.bed_v[j] = s.bed_v;
}

}  // namespace servomill::plant
