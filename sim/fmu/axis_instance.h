/// Life of one instance of an exported axis, as FMI 2.0 and 3.0 have it in common.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/fmu/axis_simulation.h"
#include "sim/fmu/axis_variables.h"

namespace servomill::sim::fmu {

enum class Stage : std::uint8_t { instantiated, initialising, stepping, terminated };

/// Result of a communication step.
enum class Step : std::uint8_t { done, stopped, refused };

/// Importance of a message.
enum class Severity : std::uint8_t { event, stop, error };

/// An instant closer than this to a tick is that tick (base periods): sums of steps such as 1 ms
/// miss a tick by their rounding, after a million of them by thousandths of a base period.
inline constexpr double kSameTick = 0.1;

/// Why a variable cannot be set to a value; empty if it can.
std::string set_fault(const Variable& variable, Stage stage, double value);

/// Functions return false where FMI has an error, after it was logged; the instance stays as it
/// was.
class AxisInstance {
 public:
  using Log = std::function<void(Severity severity, const std::string& message)>;

  /// @param log  takes the reason of every refusal, why the NC stops the machine, and events
  AxisInstance(std::shared_ptr<const AxisConstants> axis, Log log);

  bool set_up(double start_time);
  bool enter_initialization();
  bool exit_initialization();
  bool terminate();
  void reset();

  bool get(std::uint32_t reference, double& value);
  bool set(std::uint32_t reference, double value);

  /// Steps to current + step. Time counts in whole base periods since the start: an instant closer
  /// than a tenth of one to a tick is that tick; of others the ticks that have passed are counted.
  /// `stopped`: the NC has stopped the machine, at `time`; nothing moves any more.
  Step step(double current, double step);
  /// s: of the last communication point, or where the machine was stopped.
  double time() const;
  Stage stage() const { return stage_; }
  /// Base periods since the start; nullopt between two of them.
  std::optional<Tick> tick() const;
  /// s: of a tick since the start.
  double time_of(Tick tick) const;
  const model::LoopPeriods& periods() const { return axis_->machine.nc.periods; }
  bool is_stopped() const { return stopped_; }

  /// All that changes with time, for a step back.
  struct Memory {
    Stage stage = Stage::instantiated;
    bool stopped = false;
    double start_time = 0.0, time = 0.0;
    Values values{};
    std::optional<AxisSimulation::Memory> simulation;
  };
  Memory memory() const;
  bool restore(const Memory& memory);
  /// The same as bytes, for this library and these constants only, with a checksum.
  std::string bytes_of(const Memory& memory) const;
  /// nullopt if they are of another axis or damaged; the reason is logged.
  std::optional<Memory> memory_from(std::string_view bytes);

 private:
  bool refuse(const std::string& why) const;
  bool simulate_with_parameters();
  bool settle_if_needed();
  void update_outputs();

  std::shared_ptr<const AxisConstants> axis_;
  Log log_;
  Stage stage_ = Stage::instantiated;
  Values values_;
  std::optional<Values> simulated_;  // values with which simulation_ was constructed
  std::unique_ptr<AxisSimulation> simulation_;
  bool settled_ = false;  // the simulation agrees with the values
  bool stopped_ = false;
  double start_time_ = 0.0, time_ = 0.0;  // s
};

}  // namespace servomill::sim::fmu
