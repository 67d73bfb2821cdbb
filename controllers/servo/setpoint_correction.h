/// A correction on its way through the NC to the setpoint.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/setpoint_entry.h"

namespace servomill::controllers {

/// Update period, dead time and response time of a setpoint correction, advanced once per position
/// period Tp:
///   u_k = f(Q_ref,k) every n-th period, held between
///   y_k = y_{k-1} + (1 - exp(-Tp / T)) (u_{k-d} - y_{k-1})
class SetpointCorrection {
 public:
  /// @param position_period  s
  SetpointCorrection(const SetpointEntry& entry, double position_period);

  EntryPoint entry() const { return entry_; }

  /// True when `advance` wants a fresh value of the table in this position period.
  bool wants_value() const { return phase_ == 0; }

  /// Settled at `value` (5; m, rad), as if the machine had stood there for long.
  void settle(const Joints& value);

  /// @param value  what the table says now (5; m, rad); only read when wants_value()
  /// @return offset of the setpoints in this period (5; m, rad)
  Joints advance(const Joints& value);

 private:
  EntryPoint entry_;
  int periods_per_update_;
  double gain_;  // 1 - exp(-Tp / T); 1 without a response time
  int phase_ = 0;
  std::size_t oldest_ = 0;
  std::vector<Joints> delayed_;  // ring of dead_time / Tp values, empty without dead time
  Joints held_ = Joints::Zero();
  Joints out_ = Joints::Zero();
};

}  // namespace servomill::controllers
