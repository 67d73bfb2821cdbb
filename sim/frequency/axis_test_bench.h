/// One axis with its loops on a test stand: fed from outside, looked at every base tick.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/engine/servo_axes.h"
#include "sim/frequency/axis_signals.h"

namespace servomill::sim::frequency {

/// Due bit of the loop at whose instants a signal exists; 0: at any time.
constexpr std::uint8_t sampled_by(AxisSignal signal) {
  if (signal == AxisSignal::reading || signal == AxisSignal::position_error)
    return model::kPositionLoop;
  if (signal == AxisSignal::measured_speed || signal == AxisSignal::speed_error)
    return model::kVelocityLoop;
  return 0;
}

/// Excitation of one tick.
struct StandInput {
  double q = 0.0;              // m, rad: setpoint
  double dq = 0.0, ddq = 0.0;  // m/s, m/s^2: fed forward
  engine::Injection added = {};
};

/// The axis moves tick by tick, so that inputs may change and signals be seen at each of them; of a
/// linear drive that gives what longer steps give.
class AxisTestBench {
 public:
  /// @param reading_delay  ticks between the scale and what the position loop reads
  AxisTestBench(const model::MachineSettings& machine, int joint, Tick reading_delay,
                PositionLoop loop);
  AxisTestBench(const AxisTestBench&) = delete;
  AxisTestBench& operator=(const AxisTestBench&) = delete;

  const model::MachineSettings& machine() const { return machine_; }
  int joint() const { return joint_; }
  double base() const { return machine_.nc.periods.base; }                      // s
  Tick hyperperiod() const { return static_cast<Tick>(schedule_.size()); }      // ticks
  double period() const { return machine_.nc.periods.seconds(hyperperiod()); }  // s

  /// Stands at a position for long, nothing is injected.
  void settle(double position);

  /// Why a run would stop here, in the NC's words, since the axis was settled ("friction too stiff
  /// for the exact step; ..."); following errors and differences of encoders are not supervised.
  const std::optional<std::string>& fault() const { return fault_; }
  /// True if the current command is on its limit, that of the torque included.
  bool at_current_limit();

  /// Error of the position encoder at this moment (m, rad).
  double scale_error() {
    axes_.read_scales();
    return axes_.Q_meas()[joint_] - axes_.Q_true()[joint_];
  }

  int states() const { return states_; }
  void set_states(const Eigen::VectorXd& x);
  Eigen::VectorXd get_states();

  /// Runs one hyperperiod from the tick `begin` on, a multiple of it.
  /// @param input  StandInput input(Tick n)
  /// @param look   look(Tick n, uint8_t due, const AxisSignals&), after the loops of the tick n,
  /// before
  ///               the drive moves on
  template <class Input, class Look>
  void run(Tick begin, const Input& input, const Look& look);

 private:
  void run_loops(std::uint8_t due, const StandInput& in);
  AxisSignals signals() const;

  const model::MachineSettings machine_;
  int joint_;
  std::vector<model::Instant> schedule_;
  engine::ServoAxes axes_;
  engine::AxisSetpoint set_;
  std::optional<std::string> fault_;
  double current_limit_;  // A
  int states_ = 0;
};

template <class Input, class Look>
void AxisTestBench::run(Tick begin, const Input& input, const Look& look) {
  Tick n = begin;
  for (const model::Instant& instant : schedule_) {
    run_loops(instant.due, input(n));
    look(n, instant.due, signals());
    axes_.advance(instant.step);
    ++n;
  }
  if (const auto fault = axes_.supervise(); fault && !fault_) fault_ = fault->reason;
}

}  // namespace servomill::sim::frequency
