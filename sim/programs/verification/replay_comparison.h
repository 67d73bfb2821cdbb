/// Holds the actions of a written program against those of the original, in order.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "sim/programs/compensate/correction.h"
#include "sim/programs/verification/corrected_curve.h"
#include "sim/programs/verification/original.h"

namespace servomill::sim::programs {

/// A block that moves nothing but Z.
bool commands_only_Z(const controllers::MachineAction& action);
/// "X10 Y-2.5", mm and deg, of the machine.
std::string place_text(const AxisWords& position, const JointLayout& layout);

struct ComparisonLimits {
  double tolerance = 1e-6;        // m, of feeds
  double tolerance_turn = 1e-5;   // rad, of rotary axes
  double grid = 1e-6;             // m: resolution of the numbers in the written program
  double grid_turn = 1e-3;        // rad, of rotary axes
  double time_digit = 0.0;        // s: resolution of the time of a block
  bool corrects_rapids = false;   // on their way, not at their ends only
  bool is_linuxcnc = false;       // no state is lost at tool changes and stops
  std::optional<double> retract;  // m, machine: Z of the frames; nullopt: reference positions only
};

/// Why a written program does not do what the original does.
struct ReplayDifference {
  std::string why;
  int written_line = 0;  // 0: behind the end
};

/// Every motion, dwell, tool change, stop and end must come in the order of the original, with its
/// spindle and coolant. Allowed are the frames of safe programs: retracts to `retract` or to the
/// reference position before the first motion, a tool change and the end.
class ReplayComparison {
 public:
  /// @param replay, correction  must outlive this
  ReplayComparison(const std::vector<controllers::MachineAction>& replay,
                   const ComparisonLimits& limits, Correction& correction);

  /// Positions before the program.
  void start_at(const controllers::KnownPosition& start) { at_ = unmoved_ = start; }
  /// @throws ReplayDifference
  void match(const OriginalAction& action);
  void finish();

  double largest() const { return largest_; }  // m, between the path and the corrected one
  std::size_t blocks() const { return blocks_; }

 private:
  using Action = controllers::MachineAction;
  struct Targets;

  [[noreturn]] void fail(const std::string& why) const;
  const Action* peek();
  const Action& need(const std::string& what);
  bool is_still(const Action& action) const;
  void arrive(const Action& action);
  AxisWords known_position() const;
  std::string place(const AxisWords& position) const {
    return place_text(position, correction_.layout());
  }

  void take_auxiliary();
  void skip_retracts(const OriginalAction* before);
  void note_named(const Action& action);
  bool restates(const OriginalAction& action, const Action& one) const;
  void skip_restated(const OriginalAction& action);
  void check_lost_axes(const OriginalAction& action) const;
  OriginalAction as_known(const OriginalAction& action) const;
  void compare_auxiliary(const OriginalAction& action, bool is_strict) const;
  void match_motion(const OriginalAction& action);
  void compare_stop(const OriginalAction& action, const Action& one);
  void check_retract(const Action& action);
  void match_other(const OriginalAction& action);

  void match_place(const OriginalAction& action);
  void skip_via(const OriginalAction& action);
  void match_reference(const OriginalAction& action);
  bool is_return(const Action& one) const;
  bool is_at_height_of_frames() const;
  void match_rapid(const OriginalAction& action);
  void check_rapid_block(const OriginalAction& action, const Targets& targets, const Action& one);
  Targets targets_of(const OriginalAction& action);
  bool is_reached(const Targets& targets) const;
  bool is_at(std::size_t axis, double target) const;

  double path_tolerance(bool is_arc) const;
  static AxisFlags6 unmoved_axes(const OriginalAction& action);
  bool is_corrected_rapid(const OriginalAction& action) const;
  void match_path(const OriginalAction& action);
  bool admits(const OriginalAction& action, const Action* one) const;
  void check_piece(const OriginalAction& action, const CorrectedCurve& curve, const Action& one,
                   const AxisWords& from, double t_begin, double t_end);
  void check_feed(const OriginalAction& action, const CorrectedCurve& curve, const Action& one,
                  const AxisWords& from, double share) const;
  void check_path_mode(const OriginalAction& action, const Action& one) const;

  const std::vector<Action>& replay_;
  ComparisonLimits limits_;
  Correction& correction_;
  std::size_t next_ = 0;
  controllers::KnownPosition at_;
  controllers::KnownPosition unmoved_;  // if nobody has jogged at a stop
  AxisFlags6 is_lost_{};                // by a tool change or a stop, and not named since
  Directions directions_{};             // of travel, as the original has them
  AuxiliaryState auxiliary_, auxiliary_before_line_;  // before the line of the last change
  int auxiliary_line_ = 0;
  bool has_motion_ = false, is_retracted_ = false;  // the last motion of Z was a retract
  bool has_moved_since_stop_ = false, was_arc_ = false;
  bool is_behind_pallets_ = false;  // Z may be retracted there
  bool has_moved_ = false, has_ended_ = false;
  double largest_ = 0.0;
  std::size_t blocks_ = 0;
};

}  // namespace servomill::sim::programs
