/// The axes of a machine with drives, encoders and servo loops, without program or clock: what a
/// case, a frequency response and the stability check have in common.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plant/drives/cvode_bank.h"
#include "plant/drives/drive_bank.h"
#include "sim/machine.h"
#include "sim/schedule.h"

namespace servomill::sim {

/// When the loops of a machine are due.
/// @param reading_delay  ticks from the scale to what the position loop reads; kSample is due so
///                       much before the position loop
std::vector<Rate> loop_rates(const LoopPeriods& periods, Tick reading_delay);

/// Lengths of the steps of a schedule.
std::vector<Tick> steps_of(const std::vector<Instant>& schedule);

/// What the position loops follow, for all joints.
struct AxisSetPoint {
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

/// One function for each kind of instant of the schedule (sim/schedule.h), to be called in its
/// order when due; then `advance` to the next instant.
class ServoAxes {
 public:
  /// @param machine   must outlive this
  /// @param joints    those that take part; the others stand at zero
  /// @param schedule  its steps are what `advance` may be asked for
  ServoAxes(const MachineSettings& machine, std::vector<int> joints,
            const std::vector<Instant>& schedule);

  /// Has stood for long where the loops hold Q, which the NC reads as Q + displacement: there, or
  /// below it by what the load needs where no loop has an integral part.
  void settle(const Joints& Q, const Eigen::Vector3d& displacement);

  /// kSample: the reading that the next position period will use.
  /// @param displacement  of the linear joints (3; m), added by a virtual encoder
  void take_reading(const Eigen::Vector3d& displacement);
  /// kPositionLoop
  void run_position_loops(const AxisSetPoint& set);
  /// kCurrentLoop
  void run_current_loops();
  /// kVelocityLoop
  void run_velocity_loops();
  /// Moves the drives to the next instant.
  void advance(Tick step) {
    if (cvode_) {
      cvode_->advance(state_, input_, step);
    } else {
      drives_.advance(state_, input_, step);
    }
    now_ += step;
  }

  /// Readings of the position encoders at this moment.
  Joints scale_reading() const;
  /// What the position loops read last.
  const Joints& Q_read() const { return Q_read_; }
  Joints Q_true() const { return joints_of(drive().x); }
  Joints dQ_true() const { return joints_of(drive().v); }
  Joints current() const { return joints_of(drive().i); }
  const std::vector<int>& joints() const { return joints_; }

  /// Why the NC stops the machine for this joint in this position period, as it would say it
  /// ("following error beyond 10 mm"); nullopt as long as all is well.
  std::optional<std::string> supervise(int joint, const AxisSetPoint& set);

  Joints motor_speed() const;
  /// Motor speed as the velocity loop formed it last, and what it lacked (rad/s).
  const Joints& measured_speed() const { return speed_read_; }
  const Joints& speed_error() const { return speed_error_; }

  /// What is added to a joint from now on.
  void inject(int joint, const Injection& injection);

  /// Visits what of one axis changes with time, as double&: drive, loops, reading. States that
  /// cannot move (no integral part, no current lag, ...) are left out.
  template <class Visit>
  void each_state(int joint, Visit visit);

 private:
  static std::size_t lane(int joint) { return static_cast<std::size_t>(joint); }
  // The drives of all joints that take part lie in one block.
  plant::DriveBlock& drive() { return state_.blocks.front(); }
  const plant::DriveBlock& drive() const { return state_.blocks.front(); }
  std::size_t drive_lane(int joint) const { return drive_lane_[lane(joint)]; }
  Joints joints_of(const LaneArray& values) const {
    Joints Q = Joints::Zero();
    for (const int j : joints_) Q[j] = values[drive_lane(j)];
    return Q;
  }
  // State of the NC's functions of one axis.
  struct Loop {
    controllers::CascadeState cascade;
    controllers::CurrentLoopState current;
    controllers::PositionFeedbackState feedback;
    controllers::FrictionCompensationState friction;
    controllers::BacklashCompensationState backlash;
    controllers::SupervisionState supervision;
    std::optional<plant::MarkMonitor> marks;
    std::optional<plant::MarkFault> mark_fault;
    double y_motor = 0.0, y_scale = 0.0;  // m or rad, read last for the position loop
    double dq_ff = 0.0;                   // m/s or rad/s, fed forward in this position period
  };

  double motor_reading(int joint) const;
  double motor_speed(int joint) const;
  double scale_reading(int joint) const;
  void take_reading(int joint, double displacement);

  const MachineSettings& machine_;
  std::vector<int> joints_;
  std::array<std::size_t, kJoints> drive_lane_{};
  plant::DriveBank drives_;
  std::optional<plant::CvodeBank> cvode_;  // moves the drives instead, if asked for
  plant::DriveState state_;
  plant::DriveInput input_;
  std::array<Loop, kJoints> loops_;
  Tick now_ = 0;
  std::array<Injection, kJoints> injected_{};
  Joints Q_read_ = Joints::Zero();
  Joints speed_read_ = Joints::Zero(), speed_error_ = Joints::Zero();
};

template <class Visit>
void ServoAxes::each_state(int joint, Visit visit) {
  const std::size_t j = lane(joint);
  const plant::FeedDriveParams& params = machine_.drives[j];
  const controllers::CascadeParams& cascade = machine_.nc.cascade[j];
  const AxisFunctions& functions = machine_.nc.functions[j];
  Loop& loop = loops_[j];
  // the drive
  if (params.has_winding() || params.T_i > 0.0) visit(drive().i[drive_lane(joint)]);
  if (!params.is_rigid()) {
    visit(drive().w[drive_lane(joint)]);
    visit(drive().delta[drive_lane(joint)]);
  }
  visit(drive().v[drive_lane(joint)]);
  visit(drive().x[drive_lane(joint)]);
  visit(input_.blocks.front().command[drive_lane(joint)]);
  // the loops
  visit(loop.cascade.v_cmd);
  if (cascade.Ki > 0.0) visit(loop.cascade.integral);
  visit(loop.cascade.phi);
  visit(loop.cascade.i_next);
  for (std::size_t n = 0; n < 2 * cascade.filters.count; ++n) visit(loop.cascade.filters.z[n]);
  if (params.has_winding() && functions.current_loop.Ki > 0.0) visit(loop.current.integral);
  if (functions.position_feedback.kind == controllers::PositionFeedback::crossover) {
    visit(loop.feedback.difference);
  }
  visit(Q_read_[joint]);
}

}  // namespace servomill::sim
