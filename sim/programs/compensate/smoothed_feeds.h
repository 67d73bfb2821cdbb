/// Feeds of a corrected program as a control runs them that smooths short blocks: their time, and
/// by how much the path leaves the corrected one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move.h"
#include "sim/model/machine.h"

namespace servomill::sim::programs {

struct Step;

/// Runs of feeds between rapids and stops, from rest to rest.
class SmoothedFeeds {
 public:
  /// @param machine  with v_max, a_max and j_max of every axis, if anything is to be simulated
  SmoothedFeeds(const model::MachineSettings& machine, double smoothing, double tolerance);

  void add(const Step& step);
  void end_run();

  /// One sentence.
  std::string text() const;

 private:
  struct Plan {
    double time = 0.0, distance = 0.0;  // s, m
  };
  Plan plan(double tolerance) const;

  model::MachineSettings machine_;
  double smoothing_, tolerance_;  // m
  bool has_limits_ = true;
  bool is_cut_short_ = false;  // the program is longer than what is simulated
  std::size_t blocks_ = 0;
  AxisWords begin_ = AxisWords::Zero(), at_ = AxisWords::Zero();  // of the run, machine coordinates
  std::vector<Move> run_;
  Plan smoothed_, held_;
};

}  // namespace servomill::sim::programs
