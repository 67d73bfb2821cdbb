/// Feeds of LinuxCNC blocks that have to keep the time of a programmed move.
#pragma once

#include <string>

#include "sim/programs/compensate/edited_line.h"
#include "sim/programs/compensate/motion_printer.h"
#include "sim/programs/compensate/program_corrector.h"

namespace servomill::sim::programs {

/// Corrected blocks have other ways in X, Y and Z than their share of a move on which rotary axes
/// turn, and F counts that way as soon as there is one. Their F keeps the time: under G94 beside
/// moves of X, Y and Z, under G93 where rotary axes turned alone. LinuxCNC takes G93 for at least
/// 0.1 mm (inch) a minute (rs274ngc, inverse_time_rate_straight), by which a correction of 10 um
/// would turn a table within 6 ms: slower blocks go under G94.
class TimedFeed {
 public:
  TimedFeed(const Step& step, const EditedLine& line);

  /// Adds F, and the feed mode where another is needed, to the words of a block.
  /// @param begin  work coordinates, where the output stands
  void set(MotionWords& words, const MotionPrinter& printer, const FittedBlock& block,
           const AxisWords& begin);
  /// True if the mode or F of the program is not in force.
  bool is_changed() const { return is_changed_; }
  /// Brings them back.
  std::string restored() const;

 private:
  double rate(double share, double way) const;
  void set_mode(MotionWords& words, FeedMode mode);

  const Step& step_;
  const EditedLine& line_;
  bool is_rapid_ = false, is_inverse_ = false, only_turns_ = false, is_mixed_ = false;
  FeedMode mode_;   // in force in the output
  double F_ = 0.0;  // in force under G94
  bool is_changed_ = false;
};

}  // namespace servomill::sim::programs
