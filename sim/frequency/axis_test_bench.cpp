#include "sim/frequency/axis_test_bench.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::frequency {
namespace {

// The loops of the axis, and every tick.
std::vector<model::Rate> stand_rates(const model::LoopPeriods& periods, Tick reading_delay,
                                     PositionLoop loop) {
  std::vector<model::Rate> rates = engine::loop_rates(periods, reading_delay);
  if (loop == PositionLoop::open) {
    std::erase_if(rates, [](const model::Rate& rate) {
      return rate.due & (model::kFeedbackSample | model::kPositionLoop);
    });
  }
  rates.push_back({model::kRecord, 1, 0});
  return rates;
}

// A setpoint that jumps is no following error.
model::MachineSettings without_supervision(model::MachineSettings machine) {
  for (model::AxisFunctions& functions : machine.nc.functions) functions.supervision = {};
  return machine;
}

double current_limit_of(const controllers::CascadeParams& c) {
  return std::min(c.i_max, c.tau_max / c.Kt);
}

}  // namespace

AxisTestBench::AxisTestBench(const model::MachineSettings& machine, int joint, Tick reading_delay,
                             PositionLoop loop)
    : machine_(without_supervision(machine)),
      joint_(joint),
      schedule_(model::make_schedule(stand_rates(machine_.nc.periods, reading_delay, loop))),
      axes_(machine_, {joint}, schedule_),
      current_limit_(current_limit_of(machine_.nc.cascade[static_cast<std::size_t>(joint)])) {
  settle(0.0);
  axes_.each_state(joint_, [&](double&) { ++states_; });
}

void AxisTestBench::settle(double position) {
  set_ = {};
  fault_.reset();
  Joints Q = Joints::Zero();
  Q[joint_] = position;
  axes_.inject(joint_, {});
  axes_.settle(Q, Joints::Zero());
}

void AxisTestBench::set_states(const Eigen::VectorXd& x) {
  Eigen::Index k = 0;
  axes_.each_state(joint_, [&](double& state) { state = x[k++]; });
}

Eigen::VectorXd AxisTestBench::get_states() {
  Eigen::VectorXd x(states_);
  Eigen::Index k = 0;
  axes_.each_state(joint_, [&](double& state) { x[k++] = state; });
  return x;
}

bool AxisTestBench::at_current_limit() {
  // the command is clamped to exactly that value, and nothing else that moves is
  bool limited = false;
  axes_.each_state(joint_,
                   [&](double& state) { limited = limited || std::abs(state) == current_limit_; });
  return limited;
}

void AxisTestBench::run_loops(std::uint8_t due, const StandInput& in) {
  axes_.inject(joint_, in.added);
  if (due & model::kFeedbackSample) axes_.sample_position_feedback();
  if (due & model::kPositionLoop) {
    set_.Q_ref[joint_] = set_.Q_cmd[joint_] = in.q;
    set_.dQ_ff[joint_] = in.dq;
    set_.ddQ_ff[joint_] = in.ddq;
    axes_.follow(set_);
    axes_.compensate_backlash();
    axes_.close_position_loops();
  }
  if (due & model::kCurrentLoop) axes_.latch_current_commands();
  if (due & model::kVelocityLoop) axes_.close_velocity_loops();
}

AxisSignals AxisTestBench::signals() const {
  AxisSignals out{};
  const auto set = [&](AxisSignal signal, double value) { out[index_of(signal)] = value; };
  set(AxisSignal::position, axes_.Q_true()[joint_]);
  set(AxisSignal::velocity, axes_.dQ_true()[joint_]);
  set(AxisSignal::motor_speed, axes_.motor_speed()[joint_]);
  set(AxisSignal::current, axes_.current()[joint_]);
  set(AxisSignal::reading, axes_.Q_fb()[joint_]);
  set(AxisSignal::position_error, set_.Q_cmd[joint_] - axes_.Q_fb()[joint_]);
  set(AxisSignal::measured_speed, axes_.measured_speed()[joint_]);
  set(AxisSignal::speed_error, axes_.speed_error()[joint_]);
  return out;
}

}  // namespace servomill::sim::frequency
