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

void read_motors(ServoBlock* servos, const DriveBlock* drives, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    ServoBlock& s = servos[n];
    const Number phi = (Number(drives[n].delta) + Number(drives[n].x)) * Number(s.per_r);
    put(s.phi, plant::quantised(Number(s.motor_step), Number(s.per_motor_step), phi));
  }
}

void read_scale(ServoBlock& s, const LaneArray& x) {
  put(s.scale, plant::quantised(Number(s.scale_step), Number(s.per_scale_step), Number(x)));
}

void read_scales(ServoBlock* servos, const DriveBlock* drives, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) read_scale(servos[n], drives[n].x);
}

void read_scales_at(ServoBlock* servos, const LaneArray* positions, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) read_scale(servos[n], positions[n]);
}

void sample_position_feedback(ServoBlock* servos, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    ServoBlock& s = servos[n];
    const Number y_scale =
        Number(s.scale) + Number(s.virtual_displacement) + Number(s.added_reading);
    const Number y_motor = Number(s.r) * Number(s.phi);
    put(s.y_scale, y_scale);
    put(s.y_motor, y_motor);
    Number difference(s.difference);
    const Number y =
        controllers::combined_reading(Number(s.feedback_gain), difference, y_motor, y_scale);
    put(s.difference, difference);
    put(s.Q_fb, select(Number(s.reads_scale) > Number(0.0), y_scale, y));
  }
}

bool position_loops(ServoBlock* servos, const DriveBlock* drives, std::size_t count) {
  bool any_beyond = false;
  for (std::size_t n = 0; n < count; ++n) {
    ServoBlock& s = servos[n];
    const auto fine = (abs(Number(s.Q_cmd) - Number(s.Q_fb)) <= Number(s.most_following_error)) &
                      (abs(Number(drives[n].v)) <= Number(s.most_speed)) &
                      (abs(Number(drives[n].w)) <= Number(s.most_motor_speed));  // false with NaN
    put(s.beyond_limits, select(fine, Number(0.0), Number(1.0)));
    any_beyond |= !fine.all();
    controllers::position_loop(s.cascade, s.cascade_state, Number(s.Q_cmd), Number(s.Q_fb),
                               Number(s.dQ_ff), Number(s.ddQ_ff), Number(s.v_add));
  }
  return any_beyond;
}

void velocity_loops(ServoBlock* servos, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    ServoBlock& s = servos[n];
    const auto voltage_limited = Number(s.current_state.excess) != Number(0.0);
    controllers::velocity_loop(s.cascade, s.cascade_state, Number(s.phi), Number(s.tau_add),
                               voltage_limited, Number(s.added_velocity));
  }
}

void current_loops(ServoBlock* servos, const DriveBlock* drives, DriveInputBlock* inputs,
                   std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    ServoBlock& s = servos[n];
    controllers::latch_current_command(s.cascade_state);
    const Number i_cmd = Number(s.cascade_state.i_cmd) + Number(s.added_current);
    if (!any(s.has_winding)) {
      put(inputs[n].command, i_cmd);
      continue;
    }
    controllers::current_loop(s.current, s.current_state, i_cmd, Number(drives[n].i));
    put(inputs[n].command,
        select(Number(s.has_winding) > Number(0.0), Number(s.current_state.u), i_cmd));
  }
}

void get_scales(const ServoBlock* servos, std::size_t stride, const int* joints, std::size_t count,
                LaneArray* to) {
  for (std::size_t n = 0; n < count; ++n) put(to[joints[n]], Number(servos[n * stride].scale));
}

void displace(ServoBlock* servos, std::size_t stride, const int* joints, std::size_t count,
              const LaneFlags& lanes, const LaneArray* displacement) {
  unsigned bits = 0;
  for (std::size_t n = 0; n < kLaneWidth; ++n) bits |= (lanes[n] ? 1U : 0U) << n;
  const auto mask = Number::Mask::of(bits);
  for (std::size_t n = 0; n < count; ++n) {
    LaneArray& at = servos[n * stride].virtual_displacement;
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
