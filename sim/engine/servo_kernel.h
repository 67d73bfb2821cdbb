/// The servo loops of eight axes at once, with the encoders that they read.
#pragma once

#include <cstddef>

#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"
#include "plant/drives/drive_state.h"
#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::sim::engine {

/// Constants of eight axes (m, rad as for their drives). Lanes without an axis hold zeros.
struct ServoConstants {
  LaneArray r, per_r;                    // m/rad, 1/r
  LaneArray motor_step, per_motor_step;  // rad
  LaneArray scale_step, per_scale_step;  // m or rad
  LaneArray reads_scale;                 // 1: the scale closes the position loop
  LaneArray feedback_gain;               // of controllers::position_feedback, otherwise
  LaneArray has_winding;                 // 1: behind the current command is a current loop
  LaneArray rigid;                       // 1: the motor turns as the slide moves
  controllers::CascadeLanes cascade;
  controllers::CurrentLoopLanes current;
};

/// Their inputs from outside of the loops.
struct ServoInputs {
  LaneArray Q_cmd, dQ_ff, ddQ_ff;  // setpoint
  LaneArray v_add, tau_add;        // m/s, N m: compensation of backlash and friction
  LaneArray virtual_displacement;  // m: a virtual encoder adds it to the scale
  LaneArray added_velocity, added_current, added_reading;  // injected from outside
  // beyond one of these the NC looks closer; none once a run has ended
  LaneArray most_following_error;  // m or rad
  LaneArray most_speed;            // m/s or rad/s, of the slide
  LaneArray most_motor_speed;      // rad/s
};

/// Their state: readings and what the loops compute.
struct ServoState {
  LaneArray phi;               // rad, motor encoder, read last
  LaneArray scale;             // m or rad, position encoder, read last
  LaneArray y_motor, y_scale;  // m or rad, as the position loop got them
  LaneArray difference;        // state of controllers::position_feedback
  LaneArray Q_fb;              // what the position loop reads
  controllers::CascadeLanesState cascade_state;
  controllers::CurrentLoopLanesState current_state;
  LaneArray beyond_limits;  // 1: beyond one of the limits
};

/// Each function treats `count` blocks of eight axes; constants[n], inputs[n], states[n], drives[n]
/// and commands[n] belong together.
struct ServoKernel {
  /// phi of encoders that do nothing but quantise.
  void (*read_motors)(const ServoConstants* constants, ServoState* states,
                      const plant::DriveBlock* drives, std::size_t count);
  /// scale, likewise; at the positions of drives, or at others, one array for each block.
  void (*read_scales)(const ServoConstants* constants, ServoState* states,
                      const plant::DriveBlock* drives, std::size_t count);
  void (*read_scales_at)(const ServoConstants* constants, ServoState* states,
                         const LaneArray* positions, std::size_t count);
  /// Q_fb from phi and scale.
  void (*sample_position_feedback)(const ServoConstants* constants, const ServoInputs* inputs,
                                   ServoState* states, std::size_t count);
  /// Also marks lanes beyond a limit; true if there are any.
  bool (*position_loops)(const ServoConstants* constants, const ServoInputs* inputs,
                         ServoState* states, const plant::DriveBlock* drives, std::size_t count);
  void (*velocity_loops)(const ServoConstants* constants, const ServoInputs* inputs,
                         ServoState* states, std::size_t count);
  /// The command that was computed before acts from now on.
  void (*current_loops)(const ServoConstants* constants, const ServoInputs* inputs,
                        ServoState* states, const plant::DriveBlock* drives,
                        plant::DriveInputBlock* commands, std::size_t count);

  /// The scales of eight runs, where blocks hold a joint of eight runs each: joints[n] lies in
  /// states[n * stride], and goes to to[joints[n]].
  void (*get_scales)(const ServoState* states, std::size_t stride, const int* joints,
                     std::size_t count, LaneArray* to);
  /// Likewise displaces the runs whose flags are set.
  void (*displace)(ServoInputs* inputs, std::size_t stride, const int* joints, std::size_t count,
                   const LaneFlags& lanes, const LaneArray* displacement);
};

/// The functions for the instruction set of this machine.
const ServoKernel& servo_kernel();

/// Kernels of one level.
template <SimdLevel level>
ServoKernel make_servo_kernel();

}  // namespace servomill::sim::engine
