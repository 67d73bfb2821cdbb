/// Comparison of cycle times: the same motion with one limit raised.
#pragma once

#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/programs/program_duration.h"

namespace servomill::sim::programs {

/// Plans every part again with each of the limits raised by one share, and adds up what that saves.
class RaisedLimits {
 public:
  /// @param share     0.1: by 10 %
  /// @param settings  with which the parts were planned
  RaisedLimits(const model::MachineSettings& machine, const ProgramDuration& planned,
               const DurationSettings& settings, double share, unsigned threads);

  void add(const PlannedPart& part);
  /// The largest saving first.
  std::vector<RaisedLimit> result() const;

 private:
  struct Variant {
    std::string what;
    controllers::JointLimits limits;
    controllers::PathOptions options;
    double saved = 0.0;  // s
  };
  Variant& add_variant(std::string what);

  const JointLayout& layout_;
  DurationSettings settings_;
  controllers::JointLimits limits_;
  controllers::PathOptions options_;
  unsigned threads_;
  std::vector<Variant> variants_;
};

}  // namespace servomill::sim::programs
