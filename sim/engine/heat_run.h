/// Heat of the drives and the spindle in one run: temperatures, and the errors of the machine at
/// them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/heat/thermal_network.h"
#include "plant/vocabulary/ticks.h"
#include "sim/engine/case_result.h"
#include "sim/model/forward.h"
#include "sim/model/heat.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

/// Causes of heat at one instant.
struct HeatInputs {
  Joints current = Joints::Zero();  // A
  Joints torque = Joints::Zero();   // N m (N of a linear motor)
  Joints dQ = Joints::Zero();       // m/s, rad/s
  Joints load = Joints::Zero();     // N, N m, of the cut, towards + of each joint
  double spindle = 0.0;             // rad/s
  double cut = 0.0;                 // W, at the edges
};

/// Power (W) of each source.
class HeatSources {
 public:
  explicit HeatSources(const model::MachineSettings& machine);
  /// @param out  power of each body (W); set
  void powers(const HeatInputs& now, Eigen::VectorXd& out) const;

 private:
  const model::HeatSettings& heat_;
  Joints ratio_;  // m/rad or 1: travel of each joint per angle of its motor
};

/// The thermal network of a machine. The powers of the position periods are averaged over its
/// steps.
class HeatBalance {
 public:
  static constexpr double kStep = 0.1;  // s

  /// @param machine  with heat; must outlive this
  explicit HeatBalance(const model::MachineSettings& machine);

  /// A position period has passed. True if the temperatures have changed.
  bool advance(const HeatInputs& now);

  const Eigen::VectorXd& temperatures() const { return network_.temperatures(); }  ///< K
  double step() const { return step_; }                                            ///< s
  Tick steps() const { return steps_; }
  /// Powers of the run, step after step; of a run of more than an hour over so many steps together
  /// that they take no more memory.
  HeatCourse course() &&;

 private:
  static constexpr std::size_t kMaxRows = 36'000;  // of the course: an hour of steps; even

  void add_to_course();

  HeatSources sources_;
  plant::ThermalNetwork network_;
  int steps_per_row_ = 1, steps_in_row_ = 0;  // of the course
  Eigen::VectorXd row_;                       // W, sum over the steps in it
  int periods_per_step_, periods_ = 0;
  Tick steps_ = 0;
  double t_;           // s, of the day
  double step_ = 0.0;  // s
  Eigen::VectorXd power_, sum_;
  HeatCourse course_;
};

/// After each step of its network the machine has the errors of its new temperatures. Between two
/// steps an error lags by at most its rate times HeatBalance::kStep: 3 nm for 60 um in half an
/// hour.
class HeatRun {
 public:
  /// @param machine  with heat; must outlive this
  /// @param errors   of the machine at its reference temperature
  /// @param known    whose network a strategy computes, likewise; nullptr: none does
  HeatRun(const model::MachineSettings& machine, const plant::ErrorModel& errors,
          const model::MachineSettings* known);

  /// A position period has passed. True if temperatures and errors have changed.
  bool advance(const HeatInputs& now);

  /// Errors of the machine at its temperatures.
  const std::shared_ptr<const plant::VolumetricModel>& errors() const { return at_; }
  /// K, of each body, and the readings of each sensor.
  std::vector<double> temperatures() const;
  /// As a strategy sees them; the first is that of a machine that has been on for long.
  const strategies::TemperatureReading& reading() const { return reading_; }
  /// Empty, or why the machine stops: a body is beyond its limits.
  std::string fault() const;
  /// Powers of the run, step after step.
  void take_courses(CaseResult& out) &&;

 private:
  std::shared_ptr<const plant::VolumetricModel> errors_now() const;

  const model::MachineSettings& machine_;
  const plant::ErrorModel& errors_;
  HeatBalance balance_;
  std::unique_ptr<HeatBalance> known_;
  std::shared_ptr<const plant::VolumetricModel> at_;
  strategies::TemperatureReading reading_;
};

/// Empty, or which body is colder or warmer than it may be.
/// @param T  of each body (K)
std::string fault_of(const model::HeatSettings& heat, const Eigen::VectorXd& T);

/// Readings of the sensors (K).
/// @param T     of each body (K)
/// @param step  number of the reading; equal ones of a stream have equal noise
/// @param stream  of the noise of the first sensor
/// @param noise   of the reading, as a share of that of a single one
std::vector<double> readings_of(const model::HeatSettings& heat, const Eigen::VectorXd& T,
                                Tick step, std::uint32_t stream = 0, double noise = 1.0);

/// A network at the temperatures at which runs begin.
plant::ThermalNetwork network_at_start(const model::MachineSettings& machine);

}  // namespace servomill::sim::engine
