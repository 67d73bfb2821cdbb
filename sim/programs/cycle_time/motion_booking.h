/// From the moves of a program to the accounts of its time.
#pragma once

#include <optional>
#include <vector>

#include "sim/model/forward.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/programs/cycle_time/raised_limits.h"
#include "sim/programs/cycle_time/time_account.h"
#include "sim/programs/program_duration.h"

namespace servomill::sim::programs {

/// Plans moves part by part and books each part.
class MotionBooking {
 public:
  /// @param machine  must outlive this
  /// @param raise    share by which limits are raised for comparison; 0: none is
  MotionBooking(const model::MachineSettings& machine, const DurationSettings& settings,
                double raise, unsigned threads);
  MotionBooking(const MotionBooking&) = delete;
  MotionBooking& operator=(const MotionBooking&) = delete;

  /// Takes the moves.
  ProgramDuration& duration() { return duration_; }

  /// Plans the moves that are left and completes the report.
  /// @param warns_of_travel  if the machine coordinates of all positions are known
  void finish(CycleTimeReport& report, bool warns_of_travel);

 private:
  DurationSettings with_booking(const DurationSettings& settings);
  void book(const PlannedPart& part);

  const model::MachineSettings& machine_;
  double raise_;
  std::string file_;
  std::vector<Fault> slowed_, travel_;
  ProgramDuration duration_;
  TimeAccountant accountant_;
  std::optional<RaisedLimits> raised_;
};

}  // namespace servomill::sim::programs
