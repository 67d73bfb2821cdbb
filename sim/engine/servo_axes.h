/// The axes of one or several machines with drives, encoders and servo loops, without program or
/// clock: what cases, a frequency response and the stability check have in common.
#pragma once

#include <array>
#include <cassert>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/drives/cvode_bank.h"
#include "plant/drives/drive_bank.h"
#include "plant/vocabulary/joint_lanes.h"
#include "sim/engine/drive_steps.h"
#include "sim/engine/servo_kernel.h"
#include "sim/model/machine.h"
#include "sim/model/schedule.h"

namespace servomill::sim::engine {

/// Setpoints of the position loops, for all joints.
struct AxisSetpoint {
  Joints Q_ref = Joints::Zero();  // interpolated, filtered
  Joints Q_cmd = Joints::Zero();  // with corrections: what the position loop follows
  Joints dQ_ff = Joints::Zero();  // velocity that is fed forward
  Joints ddQ_ff = Joints::Zero();
};

/// Added from outside to the signals of one axis, to measure how it responds; zero in a case.
struct Injection {
  double force = 0.0;     // N, N m: on the slide, along +x
  double velocity = 0.0;  // m/s, rad/s: to the velocity command, as the velocity loop reads it
  double current = 0.0;   // A: to the current command, as the current loop reads it
  double reading = 0.0;   // m, rad: to the reading of the position encoder, as it is taken
};

/// One function for each kind of instant of the schedule (sim/model/schedule.h), to be called in
/// its order when due, from the schedule's beginning on; then `advance` to the next instant. They
/// treat all runs in lockstep, eight axes at once; a run gives the same bits alone and among
/// others, and goes on as it is if another one ends.
///
/// Runs are numbered from 0; functions that concern one of them take its number last, and the
/// first if it is left out.
class ServoAxes {
 public:
  /// @param machines  one a run; must outlive this. All have the same periods and integrator
  /// @param joints    those that take part, in rising order; the others stand at zero
  /// @param schedule  its steps are what `advance` will be asked for
  /// @param kept      drives prepared for other axes, and where those of these are kept
  ServoAxes(std::vector<const model::MachineSettings*> machines, std::vector<int> joints,
            const std::vector<model::Instant>& schedule, plant::PreparedDrives* kept = nullptr);
  ServoAxes(const model::MachineSettings& machine, std::vector<int> joints,
            const std::vector<model::Instant>& schedule)
      : ServoAxes(std::vector{&machine}, std::move(joints), schedule) {}

  std::size_t runs() const { return machines_.size(); }

  /// Has stood for long where the loops hold Q, which the NC reads as Q + displacement: there, or
  /// below it by what the load needs where no loop has an integral part.
  void settle(const Joints& Q, const Joints& displacement, std::size_t run = 0);
  /// Sets the virtual displacement that is added to the readings (5; m, rad), from now on.
  void displace(const Joints& displacement, std::size_t run = 0);
  /// The same for some of eight runs side by side, from run `first` on, a multiple of eight.
  /// @param rotary  false: only the linear joints
  void displace(const JointLanes& displacement, const LaneFlags& lanes, bool rotary,
                std::size_t first = 0);
  /// Sets the setpoints that the position loops follow, from now on.
  void follow(const AxisSetpoint& set, std::size_t run = 0);
  /// Sets what is added to the velocity commands (5; m/s, rad/s), from now on; to be called in each
  /// position period once it was called.
  void add_velocity(const Joints& velocity, std::size_t run = 0);
  /// Sets what is added to a joint, from now on.
  void inject(int joint, const Injection& injection, std::size_t run = 0);
  /// External forces on the slides from now on (5; N, N m), towards +, in place of an injected one.
  void load(const Joints& forces, std::size_t run = 0);
  /// The run has ended: its drives stay where they are.
  void end(std::size_t run);

  /// kErrorModel and kRecord need this first: the position encoders are read.
  void read_scales();
  /// kFeedbackSample: the reading that the next position period will use.
  void sample_position_feedback();
  /// kPositionLoop, in this order. Between the two, add_velocity may be called.
  void compensate_backlash();
  void close_position_loops();
  /// kCurrentLoop
  void latch_current_commands();
  /// kVelocityLoop
  void close_velocity_loops();
  /// Moves the drives to the next instant. @pre step is that of the schedule
  /// @param at_stop  called at each stop on the way, when the scales have been read there. Nothing
  ///                 else is known of a stop: it may ask for Q_meas and displace, no more
  template <class AtStop>
  void advance(Tick step, AtStop at_stop) {
    for (const Tick end = now_ + step;;) {
      const DriveSteps::Leg& leg = drive_steps_.legs[leg_];
      leg_ = leg_ == last_leg_ ? 0 : leg_ + 1;
      assert(now_ + leg.step <= end);
      if (leg.stretch < 0) {
        move(leg.step);
      } else {
        move_past_stops(static_cast<std::size_t>(leg.stretch), at_stop);
      }
      now_ += leg.step;
      if (now_ == end) return;
      read_scales();
      at_stop();
    }
  }
  /// The same for a schedule without stops.
  void advance(Tick step) {
    advance(step, [] { assert(false); });
  }

  /// Moves the drives by a step that the schedule contains, wherever it stands there: for a caller
  /// with a clock of its own. Not to be mixed with `advance`.
  void advance_by(Tick step) {
    move(step);
    now_ += step;
  }

  /// Everything that changes with time: axes that restore it go on with the same bits.
  struct Memory;
  Memory memory() const;
  /// @pre the memory is that of axes constructed from the same arguments, without CVODE
  void restore(const Memory& memory);

  /// Positions as read_scales read them.
  Joints Q_meas(std::size_t run = 0) const { return joints_of(&ServoState::scale, run); }
  /// The same of eight runs side by side, from run `first` on, a multiple of eight. Joints that do
  /// not take part and runs beyond the last are left as they are.
  void get_readings(JointLanes& Q_meas, std::size_t first = 0) const;
  /// Positions as the position loops read them last.
  Joints Q_fb(std::size_t run = 0) const { return joints_of(&ServoState::Q_fb, run); }
  /// Virtual displacements that act on the readings (5; m, rad).
  Joints virtual_displacement(std::size_t run = 0) const {
    return gathered(servo_inputs_, &ServoInputs::virtual_displacement, run);
  }
  Joints Q_true(std::size_t run = 0) const { return drives_of(&plant::DriveBlock::x, run); }
  Joints dQ_true(std::size_t run = 0) const { return drives_of(&plant::DriveBlock::v, run); }
  /// Accelerations by all forces on the slides at this instant (5; m/s^2, rad/s^2).
  Joints ddQ_true(std::size_t run = 0) const;
  /// Displacement of the machine bed along each axis (5; m).
  Joints bed(std::size_t run = 0) const { return drives_of(&plant::DriveBlock::bed_x, run); }
  Joints current(std::size_t run = 0) const { return drives_of(&plant::DriveBlock::i, run); }
  /// Command to the drives: A, with a winding V.
  Joints command(std::size_t run = 0) const {
    return gathered(input_.blocks, &plant::DriveInputBlock::command, run);
  }
  Joints motor_angle(std::size_t run = 0) const;
  Joints motor_speed(std::size_t run = 0) const;
  /// Motor speed as the velocity loop formed it last, and what it lacked (rad/s).
  Joints measured_speed(std::size_t run = 0) const;
  Joints speed_error(std::size_t run = 0) const;
  const std::vector<int>& joints() const { return joints_; }

  /// Why the NC stops a machine in this position period: the joint, and the reason as it would say
  /// it ("following error beyond 10 mm"); nullopt as long as all is well.
  struct Fault {
    int joint;
    std::string reason;
  };
  std::optional<Fault> supervise(std::size_t run = 0);
  /// After the position loops: supervise() has nothing to say of any run.
  bool within_limits() const;

  /// Visits what of one axis of the first run changes with time, as double&: drive, loops, reading.
  /// States that cannot move (no integral part, no current lag, ...) are left out.
  template <class Visit>
  void each_state(int joint, Visit visit);

 private:
  // Functions of the NC for an axis beside its loops.
  struct Functions {
    controllers::FrictionCompensationState friction;
    controllers::BacklashCompensationState backlash;
    double backlash_velocity = 0.0;  // m/s or rad/s, that it adds in this position period
    controllers::SupervisionState supervision;
    std::optional<plant::MarkMonitor> marks;
    std::optional<plant::MarkFault> mark_fault;

    template <class Visit>
    void each_part(Visit visit) {
      visit(std::span(&friction, 1));
      visit(std::span(&backlash.farthest, 1));
      visit(std::span(&backlash.direction, 1));
      visit(std::span(&backlash.offset, 1));
      visit(std::span(&backlash_velocity, 1));
      visit(std::span(&supervision, 1));
      if (!marks) return;
      marks->each_part(visit);
      bool any_fault = mark_fault.has_value();
      visit(std::span(&any_fault, 1));
      if (!any_fault) mark_fault.reset();
      if (any_fault && !mark_fault) mark_fault.emplace();
      if (any_fault) visit(std::span(&*mark_fault, 1));
    }
  };
  struct Axis {
    std::size_t run;
    int joint;
  };

  // Place of a joint's lane; arbitrary for a joint that does not take part.
  struct Place {
    std::size_t block = 0, place = 0;
    bool present = false;
  };

  std::size_t lane(std::size_t run, int joint) const {
    return first_lane_[static_cast<std::size_t>(joint)] + run;
  }
  static std::size_t block(std::size_t lane) { return lane / kLaneWidth; }
  static std::size_t place(std::size_t lane) { return lane % kLaneWidth; }
  // All joints without a question in between, so that they go through registers.
  template <class Value>
  Joints each_joint(std::size_t run, Value value) const {
    const std::array<Place, kJoints>& at = places_[run];
    Joints Q;
    for (int j = 0; j < kJoints; ++j) {
      const Place& p = at[static_cast<std::size_t>(j)];
      const double there = value(p);
      Q[j] = p.present ? there : 0.0;
    }
    return Q;
  }
  template <class Blocks, class Member>
  Joints gathered(const Blocks& blocks, Member member, std::size_t run) const {
    if (in_a_row_) return Joints((blocks.front().*member).data());
    if (blocks_of_joint_ > 0) {
      Joints Q;
      for (std::size_t j = 0; j < kJoints; ++j) {
        Q[static_cast<int>(j)] = (blocks[block_of(j, run)].*member)[run % kLaneWidth];
      }
      return Q;
    }
    return each_joint(run, [&](const Place& p) { return (blocks[p.block].*member)[p.place]; });
  }
  Joints joints_of(LaneArray ServoState::*member, std::size_t run) const {
    return gathered(servo_state_, member, run);
  }
  Joints drives_of(LaneArray plant::DriveBlock::*member, std::size_t run) const {
    return gathered(state_.blocks, member, run);
  }
  // In a row only: the joints of the only run.
  auto row(LaneArray ServoInputs::*member) {
    return Joints::Map((servo_inputs_.front().*member).data());
  }
  // Blocks hold one joint of eight runs each.
  bool fills_blocks() const { return runs() % kLaneWidth == 0; }
  // Block if the runs share lanes and all joints take part.
  std::size_t block_of(std::size_t joint, std::size_t run) const {
    return joint * blocks_of_joint_ + run / kLaneWidth;
  }
  // what(n, joint, place) for the joints of the runs first + n, up to eight.
  template <class What>
  void each_of_eight(std::size_t first, What what) const {
    for (std::size_t n = 0; n < kLaneWidth && first + n < runs(); ++n) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (const Place& p = places_[first + n][j]; p.present) what(n, j, p);
      }
    }
  }
  double& at(LaneArray ServoConstants::*member, std::size_t lane) {
    return (constants_[block(lane)].*member)[place(lane)];
  }
  double& at(LaneArray ServoInputs::*member, std::size_t lane) {
    return (servo_inputs_[block(lane)].*member)[place(lane)];
  }
  double& at(LaneArray ServoState::*member, std::size_t lane) {
    return (servo_state_[block(lane)].*member)[place(lane)];
  }

  const model::MachineSettings& machine_of(std::size_t lane) const {
    return *machines_[axes_[lane].run];
  }
  void move(Tick step) {
    if (cvode_) {
      cvode_->advance(state_, input_, step);
    } else {
      drives_.advance(state_, input_, step);
    }
  }
  template <class AtStop>
  void move_past_stops(std::size_t stretch, AtStop at_stop) {
    drives_.advance_with_stops(state_, input_, stretch, positions_);
    const LaneArray* positions = positions_.data();
    for (const Tick stop : drive_steps_.stretches[stretch].stops) {
      kernel_.read_scales_at(constants_.data(), servo_state_.data(), positions, blocks_);
      if (!own_scale_reading_.empty()) read_own_scales_at(positions, now_ + stop);
      positions += blocks_;
      at_stop();
    }
  }
  void describe(std::size_t lane);
  void settle(std::size_t lane, double Q, double displacement);
  // Reads the encoders that do more than quantise, at positions of the drives.
  void read_own_scales_at(const LaneArray* positions, Tick now);
  void read_motors();
  double motor_reading(std::size_t lane) const;
  double scale_reading(std::size_t lane, double x, Tick now) const;
  std::optional<std::string> fault_of(std::size_t lane);

  std::vector<const model::MachineSettings*> machines_;
  std::vector<int> joints_;        // in rising order
  std::size_t linear_joints_ = 0;  // of them
  std::vector<Axis> axes_;         // by lane: joint by joint
  std::array<std::size_t, kJoints> first_lane_{};
  std::vector<std::array<Place, kJoints>> places_;  // by run
  bool in_a_row_ = false;  // one run only, and all joints take part: they lie side by side
  std::size_t blocks_of_joint_ = 0;             // if the runs fill blocks and all joints take part
  std::vector<plant::FeedDriveParams> params_;  // by lane
  DriveSteps drive_steps_;
  std::size_t leg_ = 0, last_leg_;    // the next one, the last of a round
  std::vector<LaneArray> positions_;  // at the stops of a stretch
  plant::DriveBank drives_;
  std::optional<plant::CvodeBank> cvode_;  // moves the drives instead, if asked for
  std::size_t blocks_;                     // that the lanes fill
  plant::DriveState state_;
  plant::DriveInput input_;
  std::vector<ServoConstants> constants_;
  std::vector<ServoInputs> servo_inputs_;
  std::vector<ServoState> servo_state_;
  std::vector<Functions> functions_;  // by lane
  // lanes that need more than the kernel does
  std::vector<bool> always_checked_lanes_;  // by supervision
  std::vector<std::size_t> in_sub_steps_;   // lanes; a drive may fail to resolve them
  // of some lane: the kernel cannot tell that all is well; it is beyond a limit
  bool always_checked_ = false, beyond_limits_ = false;
  std::vector<std::size_t> own_motor_reading_, own_scale_reading_, marked_, with_backlash_,
      with_friction_;
  const ServoKernel& kernel_;
  Tick now_ = 0;
};

struct ServoAxes::Memory {
  plant::DriveState drives;
  plant::DriveInput inputs;
  std::vector<ServoInputs> servo_inputs;
  std::vector<ServoState> servo_state;
  std::vector<Functions> functions;
  std::size_t leg = 0;
  bool beyond_limits = false;
  Tick now = 0;

  /// Visits the parts as spans of values without pointers and gaps, which may be copied byte by
  /// byte; into a memory of the same axes, too.
  template <class Visit>
  void each_part(Visit visit) {
    visit(std::span(drives.blocks));
    visit(std::span(inputs.blocks));
    visit(std::span(servo_inputs));
    visit(std::span(servo_state));
    for (Functions& own : functions) own.each_part(visit);
    visit(std::span(&leg, 1));
    visit(std::span(&beyond_limits, 1));
    visit(std::span(&now, 1));
  }
};

template <class Visit>
void ServoAxes::each_state(int joint, Visit visit) {
  const std::size_t l = lane(0, joint), k = place(l);
  const plant::FeedDriveParams& drive = params_[l];
  const auto j = static_cast<std::size_t>(joint);
  const controllers::CascadeParams& cascade = machines_[0]->nc.cascade[j];
  const model::AxisFunctions& functions = machines_[0]->nc.functions[j];
  plant::DriveBlock& state = state_.blocks[block(l)];
  ServoState& servo = servo_state_[block(l)];
  // the drive
  if (drive.has_winding() || drive.T_i > 0.0) visit(state.i[k]);
  if (!drive.is_rigid()) {
    visit(state.w[k]);
    visit(state.delta[k]);
  }
  visit(state.v[k]);
  visit(state.x[k]);
  if (drive.on_bed()) {
    visit(state.bed_x[k]);
    visit(state.bed_v[k]);
  }
  visit(input_.blocks[block(l)].command[k]);
  // the loops
  controllers::CascadeLanesState& loops = servo.cascade_state;
  visit(loops.v_cmd[k]);
  if (cascade.Ki > 0.0) visit(loops.integral[k]);
  visit(loops.phi[k]);
  visit(loops.i_next[k]);
  for (std::size_t n = 0; n < 2 * cascade.filters.count; ++n) visit(loops.filters.z[n][k]);
  if (drive.has_winding() && functions.current_loop.Ki > 0.0)
    visit(servo.current_state.integral[k]);
  if (functions.position_feedback.kind == controllers::PositionFeedback::crossover) {
    visit(servo.difference[k]);
  }
  visit(servo.Q_fb[k]);
}

}  // namespace servomill::sim::engine
