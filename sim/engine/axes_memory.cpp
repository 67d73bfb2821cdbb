// Functions of ServoAxes that take and restore all that changes with time.
#include <cassert>

#include "sim/engine/servo_axes.h"

namespace servomill::sim::engine {

ServoAxes::Memory ServoAxes::memory() const {
  assert(!cvode_);
  return {state_, input_, servo_inputs_, servo_state_, functions_, leg_, beyond_limits_, now_};
}

void ServoAxes::restore(const Memory& memory) {
  assert(!cvode_ && memory.functions.size() == functions_.size());
  state_ = memory.drives;
  input_ = memory.inputs;
  servo_inputs_ = memory.servo_inputs;
  servo_state_ = memory.servo_state;
  functions_ = memory.functions;
  leg_ = memory.leg;
  beyond_limits_ = memory.beyond_limits;
  now_ = memory.now;
}

}  // namespace servomill::sim::engine
