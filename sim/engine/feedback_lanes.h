/// Feedback parts of runs in lockstep.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "plant/vocabulary/joint_lanes.h"
#include "sim/engine/servo_axes.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

/// The feedback hardware of eight runs that lie side by side in ServoAxes. Runs with one strategy
/// advance together, in the lanes in which they lie; what other lanes hold is left aside. Of a run
/// that is the only one with its strategy up to eight model periods wait, and then advance
/// together: the axes get to know what acts when they read it.
class FeedbackLanes {
 public:
  /// @param axes   must outlive this
  /// @param first  run in the first lane
  FeedbackLanes(ServoAxes& axes, std::size_t first) : axes_(axes), first_(first) {}

  /// A run has the feedback of a strategy from now on, and displacements of 0 (5; m, rad).
  /// @param model_period  s, of all runs
  void add(std::size_t run, const strategies::Strategy& strategy, double model_period);
  /// Sets the command of the NC of a run from now on, for strategies that observe it.
  void set_reference(std::size_t run, const AxisSetpoint& set, double s);
  /// Settles at standstill in Q_meas; d of all joints (5; m, rad).
  Joints settle(std::size_t run, const Joints& Q_meas);
  /// The run goes on no longer; where it has been saturated.
  std::vector<strategies::Saturation> drop(std::size_t run);
  /// Why the strategy of a run cannot go on; empty while it can.
  std::string_view failure(std::size_t run);
  /// To be called once a model period, after ServoAxes::read_scales.
  void evaluate_error_models();
  /// To be called before ServoAxes::sample_position_feedback: what acts now acts on the axes.
  void apply_virtual_displacements();

 private:
  struct Together {
    const strategies::Strategy* strategy;
    std::unique_ptr<strategies::FeedbackPart> part;
    LaneFlags lanes = {};
    std::size_t count = 0, last = 0;  // of the lanes in use
    const JointLanes* d = nullptr;    // of several runs: acts, but the axes do not know yet
    JointLanes Q_waiting = {};        // readings of the only run, period by period
    std::size_t waiting = 0;          // periods
  };
  Together& of(std::size_t run);
  void use(Together& together, std::size_t lane, bool used);
  void wait(Together& one);
  void observe(Together& together);
  void apply_virtual_displacements(Together& together);

  ServoAxes& axes_;
  std::size_t first_;
  std::vector<Together> all_;
  std::array<std::size_t, kLaneWidth> place_ = {};  // in all_, of each lane
  bool observes_ = false;                           // some strategy does
  JointLanes Q_meas_{};
  std::array<strategies::Reading, kLaneWidth> readings_ = {};
  double model_period_ = 0.0;  // s
  std::size_t periods_ = 0;    // that have begun
};

}  // namespace servomill::sim::engine
