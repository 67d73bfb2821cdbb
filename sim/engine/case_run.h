/// Run of one case on cascade loops, in lockstep with others.
#pragma once

#include <memory>
#include <optional>

#include "plant/structure/inertial_deflection.h"
#include "sim/engine/axis_demands.h"
#include "sim/engine/case_parts.h"
#include "sim/engine/feedback_lanes.h"
#include "sim/engine/heat_run.h"
#include "sim/engine/last_ticks.h"
#include "sim/engine/recorder.h"
#include "sim/engine/reference.h"
#include "sim/engine/servo_axes.h"
#include "sim/engine/setpoint.h"
#include "sim/model/schedule.h"

namespace servomill::sim::engine {

/// One case among those that run in lockstep: setpoint, feedback hardware, recorder.
class CaseRun {
 public:
  /// @param in        all but `setpoints` must outlive this
  /// @param schedule  of the axes
  CaseRun(CaseInputs& in, ServoAxes& axes, FeedbackLanes& feedback, std::size_t run,
          References& references, const std::vector<model::Instant>& schedule);

  /// Last tick of the case.
  Tick end() const { return end_; }
  bool goes_on_at(Tick n) const { return n <= end_ && result_.outcome.finished; }

  /// Interpolates the setpoint of this position period and commands the axes. False if a strategy
  /// cannot go on.
  bool command_axes(Tick n);
  bool adds_velocity() const { return !in_.position_loop_terms.empty(); }
  /// Adds to the velocity commands of this position period what strategies compute. False if one
  /// cannot go on.
  bool add_velocity(Tick n);
  /// False if the machine stops: an axis is beyond one of its limits.
  bool supervise(Tick n);
  void record(Tick n);

  /// False if the average cutting force acts, or none.
  bool has_teeth() const { return in_.teeth != nullptr; }
  /// Loads the axes with the force of the teeth until the next tooth step. @pre has_teeth()
  void turn_teeth(Tick n);

  /// False for a structure that is rigid under acceleration.
  bool bends() const { return structure_.has_value(); }
  /// The drives have moved by `step`: so does the structure. @pre bends()
  void bend(Tick step) { structure_->advance(axes_.Q_true(run_), axes_.dQ_true(run_), step); }

  bool remembers_travel() const { return travel_.matters(); }
  void track_axis_reversals() { travel_.go_to(axes_.Q_true(run_)); }
  void interrupt(Tick n);

  /// Result of the case, which ends before tick n.
  CaseResult finish(Tick n);

 private:
  Joints lagging_offset() const;
  void note_demands(double t);
  void note_axes(Snapshot& now) const;
  void apply_cutting_force(Tick n);
  Eigen::Vector3d inertial_deflection() const;
  bool heat(Tick n);
  void initialise_at_rest();
  strategies::Reading reading_at(double t);
  bool stop_with(std::string_view why, double t);

  CaseInputs& in_;
  const model::NcSettings& nc_;
  ServoAxes& axes_;
  FeedbackLanes& feedback_;
  std::size_t run_;
  Setpoint setpoint_;
  Reference &reference_, &recorded_;
  Recorder recorder_;
  TravelDirections travel_;
  std::optional<LastTicks> last_ticks_;
  std::optional<CutAlongPath> cut_;
  std::optional<plant::InertialDeflection> structure_;
  bool on_bed_;
  std::unique_ptr<HeatRun> heat_;  // nullptr: at its reference temperature
  Tick end_ = 0;
  const AxisSetpoint& set_ = setpoint_.now();
  Snapshot snapshot_;  // of the latest row
  DemandMeter demands_;
  LoopDisplacement by_loops_;               // without feed-forward
  Joints added_velocity_ = Joints::Zero();  // by strategies, in the position period before
  CaseResult result_;
};

}  // namespace servomill::sim::engine
