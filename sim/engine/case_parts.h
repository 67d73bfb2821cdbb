/// Parts of a case that cascade and ideal axes share: travel, cut, outcome, standstill.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "plant/geometry/reversal_memory.h"
#include "sim/engine/chip_regeneration.h"
#include "sim/engine/cutting_load.h"
#include "sim/engine/recorder.h"
#include "sim/engine/simulate.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {

/// Period of the error model of the feedback hardware (s).
double model_period_of(const CaseInputs& in);

/// Outcome of a case that is stopped from outside.
Outcome interrupted(double time);

/// Outcome of a case whose strategy cannot go on.
Outcome failed(std::string_view why, double time, int line);

/// Why a strategy cannot add these velocities (5; m/s, rad/s): one is not finite, or beyond ten
/// times the v_max of its axis; empty if it can.
std::string why_implausible(const PositionLoopTerm& term, const Joints& velocity,
                            const model::MachineSettings& machine);

/// Outcome of a case whose strategy has failed before it began.
Outcome stopped_at_begin(const std::string& why);

/// Directions in which the axes of the actual machine travelled.
class TravelDirections {
 public:
  TravelDirections(const plant::VolumetricModel& machine_errors, const Joints& Q)
      : memory_(machine_errors.plays(), Q), directions_(memory_.size()) {}
  /// False on most machines: none of their errors depends on the direction of travel.
  bool matters() const { return !memory_.empty(); }
  void go_to(const Joints& Q) { memory_.travel(Q); }
  /// Directions at Q, which is not remembered: recording changes nothing.
  std::span<const double> at(const Joints& Q) {
    memory_.directions(Q, directions_);
    return directions_;
  }

 private:
  plant::ReversalMemory memory_;
  std::vector<double> directions_;
};

/// Cutting along the path of a case. The average force acts on the drives once a position period,
/// that of single teeth once a tooth step.
class CutAlongPath {
 public:
  explicit CutAlongPath(const CaseInputs& in);

  void start(const controllers::Trajectory::Sample& reference) { load_.start(reference.s); }
  /// The path goes on at the time `at` (s).
  void advance(const controllers::Trajectory::Sample& reference, double at) {
    const model::NcSettings& nc = in_.machine.nc;
    const int tool = in_.path.tool_offset(in_.pieces[reference.move]);
    if (tool != tool_) p_ST_ = in_.tips.at(tool);
    tool_ = tool;
    forced_from_ = at;
    load_.advance(reference.s, nc.periods.seconds(nc.periods.position), reference.Q_ref, p_ST_);
  }
  /// The depth of cut follows the tool. @pre the case has displaced cuts
  /// @param bend  m, of the structure under inertia, in each linear axis
  void deviate(const controllers::Trajectory::Sample& reference, const Joints& Q_true,
               const Eigen::Vector3d& bend);
  /// Teeth turn for a tooth step from tick n on. @pre the case has teeth
  void turn(Tick n) {
    turns_from_ = forced_from_ = in_.machine.nc.periods.seconds(n);
    load_.turn(in_.machine.nc.periods.seconds(in_.tooth_step));
  }
  const Joints& load() const { return load_.load(); }
  double off_path() const { return load_.off_path(); }
  /// Why the cut cannot go on; empty if it can.
  std::string_view fault() const;
  /// W, at the edges: by the spindle and by the axes, which move at dQ (5; m/s, rad/s).
  double power(const Joints& dQ) { return load_.power() - load_.load().dot(dQ); }
  void note(Snapshot& now) const {
    now.cutting_force = load_.force();
    now.deflection = load_.deflection(now.time - forced_from_);
    now.spindle_angle = load_.spindle_angle(now.time - turns_from_);
  }

 private:
  const CaseInputs& in_;
  std::unique_ptr<ChipRegeneration> regeneration_;  // nullptr: chips are those of the feed
  CuttingLoad load_;
  int tool_ = 0;
  double turns_from_ = 0.0, forced_from_ = 0.0;  // s
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
};

/// Position at standstill: Q + d(Q) = Q_cmd, a contraction by the slope of the errors.
struct Standstill {
  Joints Q;                   // (5; m, rad)
  Joints d = Joints::Zero();  // virtual displacement there (5; m, rad)
};

/// @param displacement  d(Q), (5; m, rad)
template <class Displacement>
Standstill at_standstill(const Joints& Q_cmd, Displacement displacement) {
  Standstill out{Q_cmd};
  for (int k = 0; k < 50; ++k) {
    const Joints before = out.Q;
    out.d = displacement(before);
    out.Q = Q_cmd - out.d;
    if (out.Q == before) break;
  }
  return out;
}

}  // namespace servomill::sim::engine
