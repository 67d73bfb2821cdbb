/// The servo loops of eight axes at once, with the encoders that they read.
#pragma once

#include <cstddef>

#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"
#include "plant/drives/drive_state.h"
#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::sim::engine {

/// Eight axes (m, rad as for their drives). Lanes without an axis hold zeros.
struct ServoBlock {
  // constants
  LaneArray r, per_r;                    // m/rad, 1/r
  LaneArray motor_step, per_motor_step;  // rad
  LaneArray scale_step, per_scale_step;  // m or rad
  LaneArray reads_scale;                 // 1: the scale closes the position loop
  LaneArray feedback_gain;               // of controllers::position_feedback, otherwise
  LaneArray has_winding;                 // 1: behind the current command is a current loop
  LaneArray rigid;                       // 1: the motor turns as the slide moves
  LaneArray most_following_error;        // m or rad: beyond one of these the NC looks closer
  LaneArray most_speed;                  // m/s or rad/s, of the slide
  LaneArray most_motor_speed;            // rad/s
  controllers::CascadeLanes cascade;
  controllers::CurrentLoopLanes current;

  // inputs
  LaneArray Q_cmd, dQ_ff, ddQ_ff;  // setpoint
  LaneArray v_add, tau_add;        // m/s, N m: compensation of backlash and friction
  LaneArray virtual_displacement;  // m: a virtual encoder adds it to the scale
  LaneArray added_velocity, added_current, added_reading;  // injected from outside

  // state
  LaneArray phi;               // rad, motor encoder, read last
  LaneArray scale;             // m or rad, position encoder, read last
  LaneArray y_motor, y_scale;  // m or rad, as the position loop got them
  LaneArray difference;        // state of controllers::position_feedback
  LaneArray Q_fb;              // what the position loop reads
  controllers::CascadeLanesState cascade_state;
  controllers::CurrentLoopLanesState current_state;
  LaneArray beyond_limits;  // 1: beyond one of the above
};

/// Each function treats `count` blocks; drives[n] and inputs[n] belong to servos[n].
struct ServoKernel {
  /// phi of encoders that do nothing but quantise.
  void (*read_motors)(ServoBlock* servos, const plant::DriveBlock* drives, std::size_t count);
  /// scale, likewise; at the positions of drives, or at others, one array for each block.
  void (*read_scales)(ServoBlock* servos, const plant::DriveBlock* drives, std::size_t count);
  void (*read_scales_at)(ServoBlock* servos, const LaneArray* positions, std::size_t count);
  /// Q_fb from phi and scale.
  void (*sample_position_feedback)(ServoBlock* servos, std::size_t count);
  /// Also marks lanes beyond a limit; true if there are any.
  bool (*position_loops)(ServoBlock* servos, const plant::DriveBlock* drives, std::size_t count);
  void (*velocity_loops)(ServoBlock* servos, std::size_t count);
  /// The command that was computed before acts from now on.
  void (*current_loops)(ServoBlock* servos, const plant::DriveBlock* drives,
                        plant::DriveInputBlock* inputs, std::size_t count);

  /// The scales of eight runs, where blocks hold a joint of eight runs each: joints[n] lies in
  /// servos[n * stride], and goes to to[joints[n]].
  void (*get_scales)(const ServoBlock* servos, std::size_t stride, const int* joints,
                     std::size_t count, LaneArray* to);
  /// Likewise displaces the runs whose flags are set.
  void (*displace)(ServoBlock* servos, std::size_t stride, const int* joints, std::size_t count,
                   const LaneFlags& lanes, const LaneArray* displacement);
};

/// The functions for the instruction set of this machine.
const ServoKernel& servo_kernel();

/// Kernels of one level.
template <SimdLevel level>
ServoKernel make_servo_kernel();

}  // namespace servomill::sim::engine
