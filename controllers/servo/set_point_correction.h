/// A correction on its way through the NC to the set point.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/set_point_entry.h"

namespace servomill::controllers {

/// Update period, dead time and response time of a set-point correction, advanced once per position
/// period Tp:
///   u_k = f(Q_ref,k) every n-th period, held between
///   y_k = y_{k-1} + (1 - exp(-Tp / T)) (u_{k-d} - y_{k-1})
class SetPointCorrection {
 public:
  /// @param position_period  s
  SetPointCorrection(const SetPointEntry& entry, double position_period);

  EntryPoint entry() const { return entry_; }

  /// True when `advance` wants a fresh value of the table in this position period.
  bool wants_value() const { return phase_ == 0; }

  /// Settled at `value` (3; m), as if the machine had stood there for long.
  void settle(const Eigen::Vector3d& value);

  /// @param value  what the table says now (3; m); only read when wants_value()
  /// @return offset of the linear set points in this period (3; m)
  Eigen::Vector3d advance(const Eigen::Vector3d& value);

 private:
  EntryPoint entry_;
  int periods_per_update_;
  double gain_;  // 1 - exp(-Tp / T); 1 without a response time
  int phase_ = 0;
  std::size_t oldest_ = 0;
  std::vector<Eigen::Vector3d> delayed_;  // ring of dead_time / Tp values, empty without dead time
  Eigen::Vector3d held_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d out_ = Eigen::Vector3d::Zero();
};

}  // namespace servomill::controllers
