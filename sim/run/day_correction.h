/// Strategies of a case that follow temperatures, over a day.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/heat/thermal_network.h"
#include "plant/vocabulary/axes.h"
#include "sim/engine/heat_run.h"
#include "sim/run/cycle_powers.h"
#include "strategies/strategy.h"

namespace servomill::sim::preparation {
struct PreparedParts;
}  // namespace servomill::sim::preparation

namespace servomill::sim::run {

/// They read the mean of their sensors over each step of the day, and what the thermal network that
/// they know has reached by its end.
class DayCorrection {
 public:
  /// @param parts        must outlive this
  /// @param known_cycle  powers of a cycle in the network that the strategies know; or none
  DayCorrection(const preparation::PreparedParts& parts, std::vector<PowerStep> known_cycle);

  /// The machine has been on for long.
  /// @param T  of each body (K)
  void begin(const Eigen::VectorXd& T);

  /// Powers from here on: of causes, or of a step of the cycle.
  void use(const engine::HeatInputs& causes);
  void use(std::size_t step);

  /// From time t of the day (s) on, for h (s).
  /// @param T  of each body at the end (K)
  void advance(double t, double h, const Eigen::VectorXd& T);

  /// Offset of the axes that stand at Q (5; m, rad).
  Joints offset(const Joints& Q);
  /// Why a strategy cannot go on; empty while all can.
  std::string failure() const;

 private:
  struct Known {
    engine::HeatSources sources;
    plant::ThermalNetwork network;
    Eigen::VectorXd power;
  };
  void read(const Eigen::VectorXd& T, double h);

  const model::HeatSettings& heat_;
  std::vector<std::unique_ptr<strategies::SetpointPart>> parts_;
  std::optional<Known> known_;
  std::vector<PowerStep> cycle_;
  Tick readings_ = 0;
};

}  // namespace servomill::sim::run
