#include "sim/servo_axes.h"

#include <utility>

namespace servomill::sim {
namespace {

std::array<bool, kJoints> present(const std::vector<int>& joints) {
  std::array<bool, kJoints> out{};
  for (const int j : joints) out[static_cast<std::size_t>(j)] = true;
  return out;
}

}  // namespace

std::vector<Rate> loop_rates(const LoopPeriods& p, Tick reading_delay) {
  const Tick phase = (p.position - reading_delay % p.position) % p.position;
  return {{kSample, p.position, phase},
          {kPositionLoop, p.position, 0},
          {kVelocityLoop, p.velocity, 0},
          {kCurrentLoop, p.current, 0}};
}

std::vector<Tick> steps_of(const std::vector<Instant>& schedule) {
  std::vector<Tick> steps;
  for (const Instant& instant : schedule) steps.push_back(instant.step);
  return steps;
}

ServoAxes::ServoAxes(const MachineSettings& machine, std::vector<int> joints,
                     const std::vector<Instant>& schedule)
    : machine_(machine),
      joints_(std::move(joints)),
      drives_(machine.drives, present(joints_), machine.nc.periods.base, steps_of(schedule)) {}

void ServoAxes::settle(const Joints& Q_true, const Eigen::Vector3d& displacement) {
  state_ = drives_.at_rest(Q_true);
  for (const int j : joints_) {
    controllers::CascadeState& loop = loops_[lane(j)];
    loop = {};
    loop.phi = motor_reading(j);
    loop.i_next = loop.i_cmd = input_.command[lane(j)] = state_.i[lane(j)];
    loop.integral = state_.i[lane(j)] * machine_.nc.cascade[lane(j)].Kt;
  }
  take_reading(displacement);
}

double ServoAxes::motor_reading(int joint) const {
  return machine_.motor[lane(joint)].read(drives_.motor_angle(state_, lane(joint)));
}

Joints ServoAxes::scale_reading() const {
  Joints Q = Joints::Zero();
  for (const int j : joints_) Q[j] = machine_.scale[lane(j)].read(state_.x[lane(j)]);
  return Q;
}

void ServoAxes::take_reading(const Eigen::Vector3d& displacement) {
  Q_read_ = scale_reading();
  Q_read_.head<3>() += displacement;
}

void ServoAxes::run_position_loops(const AxisSetPoint& set) {
  for (const int j : joints_) {
    controllers::position_loop(machine_.nc.cascade[lane(j)], loops_[lane(j)], set.Q_cmd[j],
                               Q_read_[j], set.dQ_ff[j], set.ddQ_ff[j]);
  }
}

void ServoAxes::run_current_loops() {
  for (const int j : joints_) {
    controllers::latch_current_command(loops_[lane(j)]);
    input_.command[lane(j)] = loops_[lane(j)].i_cmd;
  }
}

void ServoAxes::run_velocity_loops() {
  for (const int j : joints_) {
    controllers::velocity_loop(machine_.nc.cascade[lane(j)], loops_[lane(j)], motor_reading(j));
  }
}

}  // namespace servomill::sim
