/// Machines with their loops, advanced together from instant to instant of one static schedule.
#pragma once

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sim/engine/case_run.h"
#include "sim/engine/feedback_lanes.h"
#include "sim/engine/reference.h"
#include "sim/engine/servo_axes.h"
#include "sim/engine/simulate.h"
#include "sim/model/schedule.h"

namespace servomill::sim::engine {

/// Rates of all that is due in a case.
std::vector<model::Rate> rates_of(const CaseInputs& in);

class Lockstep {
 public:
  /// @param together  at least one; share_lanes holds for each with the first
  /// @param kept      drives prepared for other runs, and where those of these are kept
  Lockstep(std::span<CaseInputs* const> together, plant::PreparedDrives* kept);

  /// Results in the order of the cases.
  std::vector<CaseResult> run(const StopFlag& stop, std::atomic<float>& progress);

 private:
  void tick(std::uint8_t due, Tick n);
  void evaluate_error_models();
  void apply_virtual_displacements();
  void command_axes(Tick n);
  void add_velocities(Tick n);
  void stop_faulty_axes(Tick n);
  void track_axis_reversals();
  void turn_teeth(Tick n);
  void record(Tick n);
  void bend_structures(Tick step);
  bool take_out_those_done(Tick n, std::vector<CaseResult>& results);

  template <class Do>
  void each(Do what) {
    for (auto& run : runs_) {
      if (run) what(*run);
    }
  }

  std::vector<model::Instant> schedule_;
  ServoAxes axes_;
  References references_;
  std::vector<std::unique_ptr<CaseRun>> runs_;
  std::vector<FeedbackLanes> feedbacks_;  // of eight runs each
  bool any_remembers_travel_ = false;
  bool any_adds_velocity_ = false;
  bool any_bends_ = false;
  Tick longest_ = 0;
  Tick next_end_ = 0;  // no run ends before it
};

}  // namespace servomill::sim::engine
