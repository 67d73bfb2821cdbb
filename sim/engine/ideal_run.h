/// Run of one case on ideal axes: actual position equals commanded position. The residual is the
/// strategy's own error.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "controllers/path/trajectory.h"
#include "plant/structure/inertial_deflection.h"
#include "sim/engine/axis_demands.h"
#include "sim/engine/case_parts.h"
#include "sim/engine/heat_run.h"
#include "sim/engine/recorder.h"
#include "sim/engine/sampled_motion.h"
#include "sim/engine/setpoint.h"
#include "sim/engine/simulate.h"

namespace servomill::sim::engine {

class IdealRun {
 public:
  /// @param in  all but `setpoints` must outlive this
  explicit IdealRun(CaseInputs& in);

  CaseResult run(const StopFlag& stop, std::atomic<float>& progress);

 private:
  controllers::Trajectory::Sample reference_at(Tick n);
  bool goes_on(int line, Outcome& outcome) const;
  void add_saturations(double time);
  void record(Tick n, const AxisSetpoint& set, const Joints& Q_true);
  void bend(const Joints& Q_true);
  bool cut(Tick n, const AxisSetpoint& set, int line, Outcome& outcome);
  bool heat(const controllers::Trajectory::Sample& sample, Outcome& outcome);
  Joints Q_true_of(const AxisSetpoint& set);

  CaseInputs& in_;
  const model::LoopPeriods& periods_;
  Setpoint setpoint_;
  std::unique_ptr<strategies::FeedbackPart> feedback_;
  strategies::Reading now_;
  Recorder recorder_;
  TravelDirections travel_;
  std::optional<CutAlongPath> cut_;
  SampledMotion motion_;
  DemandMeter demands_;
  std::optional<plant::InertialDeflection> structure_;
  std::unique_ptr<HeatRun> heat_;  // nullptr: at its reference temperature
  std::vector<strategies::Saturation> saturations_;
  controllers::Trajectory::Cursor cursor_, record_cursor_;
};

}  // namespace servomill::sim::engine
