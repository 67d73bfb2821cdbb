#include "sim/engine/servo_kernel.h"

#include "controllers/servo/position_feedback.h"
#include "plant/sensing/quantise.h"
#include "plant/vocabulary/pack.h"

namespace servomill::sim::engine {

namespace {

using Number = Pack<SERVOMILL_ARCH>;
using plant::DriveBlock;
using plant::DriveInputBlock;

bool any(const LaneArray& flags) { return (Number(flags) > Number(0.0)).any(); }

void read_motors(const ServoConstants* constants, ServoState* states, const DriveBlock* drives,
                 std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    const ServoConstants& c = constants[n];
    ServoState& s = states[n];
    const Number phi = (Number(drives[n].delta) + Number(drives[n].x)) * Number(c.per_r);
    put(s.phi, plant::quantised(Number(c.motor_step), Number(c.per_motor_step), phi));
  }
}

void read_scale(const ServoConstants& c, ServoState& s, const LaneArray& x) {
  put(s.scale, plant::quantised(Number(c.scale_step), Number(c.per_scale_step), Number(x)));
}

void read_scales(const ServoConstants* constants, ServoState* states, const DriveBlock* drives,
                 std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) read_scale(constants[n], states[n], drives[n].x);
}

void read_scales_at(const ServoConstants* constants, ServoState* states, const LaneArray* positions,
                    std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) read_scale(constants[n], states[n], positions[n]);
}

void sample_position_feedback(const ServoConstants* constants, const ServoInputs* inputs,
                              ServoState* states, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    const ServoConstants& c = constants[n];
    const ServoInputs& in = inputs[n];
    ServoState& s = states[n];
    const Number y_scale =
        Number(s.scale) + Number(in.virtual_displacement) + Number(in.added_reading);
    const Number y_motor = Number(c.r) * Number(s.phi);
    put(s.y_scale, y_scale);
    put(s.y_motor, y_motor);
    Number difference(s.difference);
    const Number y =
        controllers::combined_reading(Number(c.feedback_gain), difference, y_motor, y_scale);
    put(s.difference, difference);
    put(s.Q_fb, select(Number(c.reads_scale) > Number(0.0), y_scale, y));
  }
}

bool position_loops(const ServoConstants* constants, const ServoInputs* inputs, ServoState* states,
                    const DriveBlock* drives, std::size_t count) {
  bool any_beyond = false;
  for (std::size_t n = 0; n < count; ++n) {
    const ServoConstants& c = constants[n];
    const ServoInputs& in = inputs[n];
    ServoState& s = states[n];
    const auto fine = (abs(Number(in.Q_cmd) - Number(s.Q_fb)) <= Number(in.most_following_error)) &
                      (abs(Number(drives[n].v)) <= Number(in.most_speed)) &
                      (abs(Number(drives[n].w)) <= Number(in.most_motor_speed));  // false with NaN
    put(s.beyond_limits, select(fine, Number(0.0), Number(1.0)));
    any_beyond |= !fine.all();
    controllers::position_loop(c.cascade, s.cascade_state, Number(in.Q_cmd), Number(s.Q_fb),
                               Number(in.dQ_ff), Number(in.ddQ_ff), Number(in.v_add));
  }
  return any_beyond;
}

void velocity_loops(const ServoConstants* constants, const ServoInputs* inputs, ServoState* states,
                    std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    const ServoConstants& c = constants[n];
    const ServoInputs& in = inputs[n];
    ServoState& s = states[n];
    const auto voltage_limited = Number(s.current_state.excess) != Number(0.0);
    controllers::velocity_loop(c.cascade, s.cascade_state, Number(s.phi), Number(in.tau_add),
                               voltage_limited, Number(in.added_velocity));
  }
}

void current_loops(const ServoConstants* constants, const ServoInputs* inputs, ServoState* states,
                   const DriveBlock* drives, DriveInputBlock* commands, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    const ServoConstants& c = constants[n];
    const ServoInputs& in = inputs[n];
    ServoState& s = states[n];
    controllers::latch_current_command(s.cascade_state);
    const Number i_cmd = Number(s.cascade_state.i_cmd) + Number(in.added_current);
    if (!any(c.has_winding)) {
      put(commands[n].command, i_cmd);
      continue;
    }
    controllers::current_loop(c.current, s.current_state, i_cmd, Number(drives[n].i));
    put(commands[n].command,
        select(Number(c.has_winding) > Number(0.0), Number(s.current_state.u), i_cmd));
  }
}

void get_scales(const ServoState* states, std::size_t stride, const int* joints, std::size_t count,
                LaneArray* to) {
  for (std::size_t n = 0; n < count; ++n) put(to[joints[n]], Number(states[n * stride].scale));
}

void displace(ServoInputs* inputs, std::size_t stride, const int* joints, std::size_t count,
              const LaneFlags& lanes, const LaneArray* displacement) {
  unsigned bits = 0;
  for (std::size_t n = 0; n < kLaneWidth; ++n) bits |= (lanes[n] ? 1U : 0U) << n;
  const auto mask = Number::Mask::of(bits);
  for (std::size_t n = 0; n < count; ++n) {
    LaneArray& at = inputs[n * stride].virtual_displacement;
    put(at, select(mask, Number(displacement[joints[n]]), Number(at)));
  }
}

}  // namespace

template <>
ServoKernel make_servo_kernel<SERVOMILL_LEVEL>() {
  return {&read_motors,    &read_scales,    &read_scales_at, &sample_position_feedback,
          &position_loops, &velocity_loops, &current_loops,  &get_scales,
          &displace};
}

}  // namespace servomill::sim::engine
