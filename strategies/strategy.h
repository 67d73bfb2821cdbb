/// Interface of every way of compensating a machine's geometric errors to a run.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/added_gain.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/joint_lanes.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/put_move.h"
#include "plant/vocabulary/setpoint_entry.h"
#include "strategies/residual.h"
#include "strategies/saturation.h"

namespace servomill::strategies {

/// `impose` adds the identified errors to the part, as paper [G] does; `compensate` removes
/// them.
enum class Action : std::int8_t { impose = 1, compensate = -1 };

struct IdentifiedHeat;   // strategies/identified_heat.h
struct IdentifiedLoops;  // strategies/identified_loops.h

/// Knowledge of a strategy. Never the actual errors: its errors are an identified model.
struct IdentifiedMachine {
  JointLayout layout;
  plant::VolumetricModel model;                    // machine and errors as identified
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, tool tip at the spindle nose
  Joints lower = Joints::Zero();                   // m, rad; travel of the machine
  Joints upper = Joints::Zero();
  Joints reference = Joints::Zero();  // m, rad; where the machine starts
  // m, rad; from where the program's work offset has the part to where the case has it
  Joints part_shift = Joints::Zero();
  Joints Kv = Joints::Zero();  // 1/s, position gains that the NC is set to;
                               // NaN unless the entry reads_gains
  // 1/s, the largest gain that leaves the position loops of X, Y and Z the margins that the entry
  // wants, 0 if none does; NaN if it wants none
  double added_gain = std::numeric_limits<double>::quiet_NaN();
  double position_period = 0.0;  // s, of the interpolation of setpoints
  // errors by temperature; nullptr: the entry does not correct them, or the machine has no heat
  std::shared_ptr<const IdentifiedHeat> heat = {};
  // position loops and friction as identified; nullptr unless the entry reads_loops and for ideal
  // axes
  std::shared_ptr<const IdentifiedLoops> loops = nullptr;
};

/// Reading of a run at one instant, as a strategy may see it.
struct Reading {
  double t = 0.0;                   // s, since the start of the program
  double s = 0.0;                   // m, arc length on the path of the original program
  Joints Q_ref = Joints::Zero();    // m, rad; as the NC interpolated it last
  Joints dQ_ref = Joints::Zero();   // per s
  Joints ddQ_ref = Joints::Zero();  // per s^2
  Joints Q_fb = Joints::Zero();     // m, rad; of a feedback strategy the scales, without its own
                                    // displacement; of others what the position loops read last
  Joints Q_cmd = Joints::Zero();    // m, rad; what the position loops followed last, the offsets of
                                    // all strategies in it
};

/// Temperatures at one instant, as a control knows them.
struct TemperatureReading {
  double period = 0.0;          // s, since the reading before; 0: the machine has been on for long
  std::vector<double> sensors;  // K, of each sensor
  std::vector<double> bodies;   // K, as the thermal network of the known machine has them; empty:
                                // the strategy knows none
};

/// Offset of the setpoints, added in the NC where `entry` says.
class SetpointPart {
 public:
  virtual ~SetpointPart() = default;
  virtual SetpointEntry entry() const = 0;
  /// @param Q_ref  interpolated position (5; m, rad)
  /// @return offset of all joints (5; m, rad)
  virtual Joints offset(const Joints& Q_ref) const = 0;
  /// The same in a run, once per position period, with a state of its own if it has one.
  virtual Joints advance(const Reading& now) { return offset(now.Q_ref); }
  /// New readings of a machine with heat: the first before anything else is asked for, with those
  /// of a machine that has been on for long.
  virtual void read_temperatures(const TemperatureReading& now) { (void)now; }
  /// Why it cannot go on, which ends the case; empty while it can.
  virtual std::string_view failure() const { return {}; }
};

/// Addition to the velocity commands in the position loops,
///
///     v_cmd = Kv (Q_cmd - Q_fb) + kvf dQ_ref + velocity(),   limited to +-v_max
///
/// Ideal axes have no such loop: there it does nothing.
class PositionLoopPart {
 public:
  virtual ~PositionLoopPart() = default;
  /// Has stood for long where `now` says: begins anew.
  virtual void settle(const Reading& now) = 0;
  /// Once per position period, with Q_cmd and Q_fb of this one.
  /// @return for all joints (5; m/s, rad/s). What is not finite, or beyond ten times the v_max
  ///         of an axis, ends the case
  virtual Joints velocity(const Reading& now) = 0;
  /// Why it cannot go on, which ends the case; empty while it can.
  virtual std::string_view failure() const { return {}; }
};

/// Offset of the position feedback: the NC reads x_measured + d, hence moves the axis by -d.
/// Advances once per model period of the feedback hardware. Has the state of up to eight runs,
/// side by side in lanes; a run gives the same bits in any lane, alone and among others.
class FeedbackPart {
 public:
  virtual ~FeedbackPart() = default;
  /// Settles one run at standstill in Q_meas, as if the hardware had been on for long. Where that
  /// saturates, it counts as one model period.
  virtual Joints settle(const Joints& Q_meas, std::size_t lane = 0) = 0;
  /// One model period after the other of one run, the only one that goes on: what was evaluated a
  /// period ago acts now, and the model is evaluated for the next period. Where only linear
  /// axes are displaced, eight periods take little longer than one.
  /// @param Q_meas   scale readings (m, rad) at the instants of the periods, side by side: from the
  ///                 first lane on; in other lanes any numbers
  /// @param periods  their number, at most eight
  /// @return d of all joints (5; m, rad), acting from the last of these instants on
  virtual Joints advance(const JointLanes& Q_meas, std::size_t periods, std::size_t lane) = 0;
  /// One model period of all runs that go on, in less time than of each.
  /// @param Q_meas  scale readings of the runs at this instant; of other lanes anything
  /// @param lanes   those of the runs
  /// @return d of the runs, until the next call; of other lanes anything
  virtual const JointLanes& advance(const JointLanes& Q_meas, const LaneFlags& lanes) = 0;
  /// Tells if `observe` is to be called before each `settle` and model period of a run, which then
  /// wait for `advance` in the order in which they were observed.
  virtual bool observes() const { return false; }
  virtual void observe(const Reading& now, std::size_t lane) {
    (void)now;
    (void)lane;
  }
  /// Why one run cannot go on, which ends its case; empty while it can.
  virtual std::string_view failure(std::size_t lane) const {
    (void)lane;
    return {};
  }
  /// Saturations of one run since it was settled; in the order of the joints.
  virtual std::vector<Saturation> saturations(std::size_t lane) const {
    (void)lane;
    return {};
  }
  /// One model period of one run, the only one that goes on.
  Joints advance(const Joints& Q_meas, std::size_t lane = 0) {
    JointLanes one{};
    for (int j = 0; j < kJoints; ++j) one[j][0] = Q_meas[j];
    return advance(one, 1, lane);
  }
};

/// Position at which a compensation table ends.
struct BeyondTable {
  int joint = 0;     // over which it runs
  double end = 0.0;  // m, its first or last point
};

class LearningStrategy;  // strategies/trial_runs.h

/// Up to four parts, each optional. A strategy is constant and may be shared by runs; the parts
/// that it makes have the state of one run.
class Strategy {
 public:
  virtual ~Strategy() = default;

  /// Rewrites the moves of a program; the line and arc length of the original are carried over.
  virtual bool rewrites() const { return false; }
  /// Goes through the moves in their order, as often as it needs them, and hands out the rewritten
  /// ones in theirs: both may be more than the memory holds.
  virtual void rewrite(const MoveRange& moves, const PutMove& put) const {
    for (const Move& move : moves) put(move);
  }
  /// True if it can rewrite moves under TCP control, with the tool of IdentifiedMachine::p_ST.
  virtual bool rewrites_tip_moves() const { return false; }

  virtual std::unique_ptr<SetpointPart> setpoint() const { return nullptr; }
  /// @param position_period  s, time between two calls of PositionLoopPart::velocity
  virtual std::unique_ptr<PositionLoopPart> position_loop(double position_period) const {
    (void)position_period;
    return nullptr;
  }
  /// Gain of its term in the position loops along some direction, for their margins; nullopt: it
  /// has no such term, or one that is no gain.
  virtual std::optional<AddedGain> added_gain() const { return std::nullopt; }
  /// The ends of tables beyond which Q (5; m, rad) lies: they hold their last value there.
  virtual std::vector<BeyondTable> beyond_tables(const Joints& Q) const {
    (void)Q;
    return {};
  }

  /// Itself, if it learns from runs of the program; nullptr: it acts as it is.
  virtual const LearningStrategy* learning() const { return nullptr; }

  /// Limits of the strategy that a user should know before a run, a sentence each.
  virtual std::vector<std::string> notes() const { return {}; }

  /// True if it has a part that displaces the feedback.
  virtual bool displaces_feedback() const { return false; }
  /// True if any of its parts displaces rotary axes, too.
  virtual bool displaces_rotary() const { return false; }
  /// Residual of the errors that it corrects because no axis that it displaces can remove it,
  /// lags and steps of its own left aside; nullopt if it corrects nothing.
  /// @param Q  programmed position (5; m, rad)
  virtual std::optional<Residual> uncorrectable(const Joints& Q) const {
    (void)Q;
    return std::nullopt;
  }
  /// @param model_period  s, time between two calls of FeedbackPart::advance
  virtual std::unique_ptr<FeedbackPart> feedback(double model_period) const {
    (void)model_period;
    return nullptr;
  }
};

}  // namespace servomill::strategies
