#include "sim/fmu/axis_simulation.h"

#include <algorithm>
#include <cassert>

#include "sim/engine/drive_steps.h"

namespace servomill::sim::fmu {
namespace {

std::vector<model::Instant> schedule_of(const AxisConstants& axis) {
  std::vector<model::Rate> rates = engine::loop_rates(axis.machine.nc.periods, axis.reading_delay);
  rates.push_back({model::kRecord, axis.record_period, 0});
  return model::make_schedule(rates);
}

// Steps of every length up to the longest between two instants: a communication point may split
// any.
std::vector<model::Instant> all_steps(const std::vector<model::Instant>& schedule) {
  Tick longest = 0;
  for (const model::Instant& instant : schedule) longest = std::max(longest, instant.step);
  std::vector<model::Instant> steps;
  for (Tick step = 1; step <= longest; ++step) steps.push_back({.step = step});
  return steps;
}

}  // namespace

AxisSimulation::AxisSimulation(const AxisConstants& axis)
    : machine_(axis.machine),
      joint_(axis.joint),
      schedule_(schedule_of(axis)),
      axes_(machine_, {joint_}, all_steps(schedule_)),
      initial_(axes_.memory()) {}

Joints AxisSimulation::only(double value) const {
  Joints Q = Joints::Zero();
  Q[joint_] = value;
  return Q;
}

void AxisSimulation::load(double force) {
  state_.load = force;
  axes_.load(only(force));
}

void AxisSimulation::settle(const AxisInputs& in) {
  state_ = {};
  fault_.clear();
  axes_.restore(initial_);
  load(0.0);
  axes_.settle(only(in.setpoint - in.feedback_displacement), only(in.feedback_displacement));
  state_.setpoint = in.setpoint;
}

// The loops of the instant `now`, in the order of Lockstep::tick.
bool AxisSimulation::run_loops(const AxisInputs& in) {
  const std::uint8_t due = schedule_[state_.instant].due;
  if (due & model::kFeedbackSample) {
    axes_.displace(only(in.feedback_displacement));
    axes_.sample_position_feedback();
  }
  if (due & model::kPositionLoop) {
    state_.setpoint = in.setpoint;
    axes_.follow({only(in.setpoint), only(in.setpoint), only(in.velocity), only(in.acceleration)});
    axes_.compensate_backlash();
    axes_.close_position_loops();
    if (!axes_.within_limits()) {
      if (const auto fault = axes_.supervise()) {
        fault_ = fault->reason;
        return false;
      }
    }
  }
  if (due & model::kCurrentLoop) axes_.latch_current_commands();
  if (due & model::kVelocityLoop) axes_.close_velocity_loops();
  return true;
}

bool AxisSimulation::advance(Tick to, const AxisInputs& in) {
  assert(to >= state_.now && fault_.empty());
  while (state_.now < to) {
    if (state_.now == state_.next) {
      if (!run_loops(in)) return false;
      state_.last = state_.now;
      state_.next += schedule_[state_.instant].step;
      state_.instant = state_.instant + 1 == schedule_.size() ? 0 : state_.instant + 1;
    } else if (in.load == state_.load) {
      axes_.restore(before_);
    } else {
      state_.last = state_.now;
    }
    if (in.load != state_.load) load(in.load);
    const Tick end = std::min(to, state_.next);
    state_.on_the_way = end < state_.next;
    if (state_.on_the_way) before_ = axes_.memory();
    axes_.advance_by(end - state_.last);
    state_.now = end;
  }
  return true;
}

AxisOutputs AxisSimulation::outputs() {
  axes_.read_scales();
  AxisOutputs out;
  out.position = axes_.Q_true()[joint_];
  out.position_measured = axes_.Q_meas()[joint_];
  out.velocity = axes_.dQ_true()[joint_];
  out.current = axes_.current()[joint_];
  out.torque = machine_.drives[static_cast<std::size_t>(joint_)].Kt * out.current;
  out.position_feedback = axes_.Q_fb()[joint_];
  out.following_error = state_.setpoint - out.position_feedback;
  return out;
}

AxisSimulation::Memory AxisSimulation::memory() const {
  return {state_, axes_.memory(), state_.on_the_way ? before_ : engine::ServoAxes::Memory()};
}

void AxisSimulation::restore(const Memory& memory) {
  state_ = memory.clock;
  fault_.clear();
  axes_.restore(memory.axes);
  if (state_.on_the_way) before_ = memory.before;
}

}  // namespace servomill::sim::fmu
