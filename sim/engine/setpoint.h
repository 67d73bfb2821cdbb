/// The NC's setpoint of one case: interpolated reference, nominal-position filter, corrections,
/// feed-forward. Advanced once per position period.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "controllers/path/nominal_filter.h"
#include "controllers/path/trajectory.h"
#include "controllers/servo/setpoint_correction.h"
#include "sim/engine/servo_axes.h"
#include "sim/model/forward.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

class Setpoint {
 public:
  Setpoint(const model::NcSettings& nc, const controllers::Trajectory& reference,
           std::vector<std::unique_ptr<strategies::SetpointPart>> parts);

  /// New temperatures of a machine with heat, for strategies that read them.
  void read_temperatures(const strategies::TemperatureReading& now);
  bool corrects() const { return !corrections_.empty(); }
  /// Setpoint of this position period.
  const AxisSetpoint& now() const { return out_; }
  /// Standing at the start of the trajectory for long; corrections settled.
  const AxisSetpoint& settle();
  /// Time by which the filter delays the reference (s).
  double delay() const { return delay_; }
  /// Offsets of strategies in the setpoint that are fed forward (5; m, rad).
  const Joints& fed_forward() const { return fed_forward_; }

  /// Setpoint for what the trajectory asks for, one position period after the call before.
  /// @param t, Q_fb  s, and what the position loops read last: for strategies that look
  const AxisSetpoint& advance(const controllers::Trajectory::Sample& sample, double t = 0.0,
                              const Joints& Q_fb = Joints::Zero());
  /// Why a correction cannot go on; empty while all can.
  std::string_view failure() const;

 private:
  struct Correction {
    std::unique_ptr<strategies::SetpointPart> part;
    controllers::SetpointCorrection in_nc;
  };
  struct Filters {  // one for each signal that passes
    controllers::NominalFilter Q, dQ, ddQ, offset;
  };
  struct Offsets {  // of all joints (5; m, rad), by where they enter
    Joints before_filter = Joints::Zero();
    Joints position_command = Joints::Zero();
    Joints feed_forward = Joints::Zero();
    Joints& of(EntryPoint entry);
  };
  Offsets corrections_at(strategies::Reading now);
  void feed_forward(const Joints& offset);

  const controllers::Trajectory& reference_;
  std::vector<Correction> corrections_;
  double Tp_;
  double delay_ = 0.0;
  std::optional<Filters> filters_;
  AxisSetpoint out_;
  Joints fed_forward_ = Joints::Zero();  // corrections, one period ago
  Joints fed_forward_rate_ = Joints::Zero();
};

}  // namespace servomill::sim::engine
