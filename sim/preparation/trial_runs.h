/// Runs of a case's program before the case itself: for strategies that learn from them.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/tool_pose.h"
#include "sim/model/scenario.h"
#include "sim/preparation/offset_limits.h"
#include "sim/preparation/offset_response.h"
#include "sim/preparation/part_deviations.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/recorded_run.h"
#include "strategies/trial_runs.h"

namespace servomill::sim::engine {
struct CaseInputs;
}  // namespace servomill::sim::engine
namespace servomill::sim::records {
class Series;
}  // namespace servomill::sim::records

namespace servomill::sim::preparation {

/// Common to all runs of a case.
struct TrialSetting {
  strategies::TrialSetup setup;
  const model::Scenario& scenario;
  const model::CaseSpec& spec;
  const model::MachineSettings& known;  // the machine as the strategy knows it
  const InterpretedProgram& program;
  const PlannedMotion& motion;    // as it is planned
  const PlannedMotion* original;  // of the original program, where that is another; else nullptr
  /// Inputs of a run on a machine with an offset.
  std::function<engine::CaseInputs(const model::MachineSettings&,
                                   std::shared_ptr<const strategies::PathOffset>)>
      inputs;
};

/// The deviation is that of tip and tool axis, or of the scales, from the interpolated path of the
/// ideal machine at the same instant.
class CaseTrials final : public strategies::TrialRuns {
 public:
  /// @param setting  must outlive this
  /// @param recordings  that take the place of runs; empty: none
  explicit CaseTrials(const TrialSetting& setting, std::vector<RecordedRun> recordings = {});
  ~CaseTrials() override;

  std::shared_ptr<const strategies::PathTimes> times() const override { return times_; }
  const std::vector<bool>& in_feed() const override { return in_feed_; }
  const std::vector<int>& joints() const override { return joints_; }
  int recorded() const override { return static_cast<int>(recordings_.size()); }
  std::complex<double> known_response(int joint, double f) const override;
  std::complex<double> response(int joint, double f) const override;
  std::vector<Joints> admissible(std::vector<Joints> offset) const override;
  const OffsetLimits& limits() const { return *limits_; }
  /// Sentences on recordings: what parts do not show.
  const std::vector<std::string>& notes() const { return notes_; }
  strategies::TrialRun run(const std::shared_ptr<const strategies::PathOffset>& offset) override;

 private:
  struct Wanted {
    Joints Q;
    Eigen::Vector3d p_ST;
    std::size_t piece = 0;  // of the program
    bool rapid = false;
  };
  const model::MachineSettings& actual() const {
    return setting_.scenario.machine_of(setting_.spec);
  }
  const model::MachineSettings& machine() const {
    return setting_.setup.on_actual ? actual() : setting_.known;
  }
  bool sees_tip() const {
    return recordings_.empty() ? setting_.setup.sees_tip
                               : recordings_.front().sees != model::SeenBy::scales;
  }
  bool sees_part() const {
    return !recordings_.empty() && recordings_.front().sees == model::SeenBy::part;
  }
  void find_times();
  void take_recorded_joints();
  PlannedInstants planned_instants() const;
  bool is_seen(const RecordedRun& run, int joint, const PlannedInstants& path) const;
  strategies::TrialRun recorded_run(const RecordedRun& run) const;
  std::vector<Joints> read_by_scales(const RecordedRun& run,
                                     const std::vector<double>& instants) const;
  std::vector<Joints> read_at_tip(const RecordedRun& run, const std::vector<double>& instants,
                                  const PlannedInstants& path) const;
  void find_wanted(double delay);
  std::vector<PathRange> followed_path() const;
  double between_rows_at(double f) const;
  Joints mean_position() const;
  std::vector<Joints> seen_by_scales(const records::Series& rows,
                                     const std::vector<double>& places) const;
  std::vector<Joints> seen_at_tip(const records::Series& rows,
                                  const std::vector<double>& places) const;
  std::vector<double> places_of(const controllers::Trajectory& run, std::size_t rows) const;
  Joints in_joints(const Wanted& wanted, const ToolPose& seen) const;
  Joints in_linear_joints(const Wanted& wanted, const Eigen::Vector3d& off) const;
  void take_parts();
  std::vector<ToolRow> tool_rows() const;
  std::vector<ProbedCut> probed_cuts(const RecordedRun& run,
                                     const std::vector<ToolRow>& rows) const;
  void note_unprobed(const RecordedRun& run, const std::vector<UnprobedRun>& unprobed);
  void add_noise(std::vector<Joints>& deviation) const;

  const TrialSetting& setting_;
  std::vector<RecordedRun> recordings_;
  Tick row_period_ = 1;
  std::shared_ptr<strategies::PathTimes> times_;
  std::vector<Wanted> wanted_;  // row by row
  std::vector<bool> in_feed_;
  std::vector<int> joints_;
  OffsetResponses known_, running_;
  std::optional<OffsetLimits> limits_;
  std::vector<std::vector<Joints>> of_parts_;  // deviations, recording by recording
  std::vector<std::string> notes_;
  int runs_ = 0;
};

}  // namespace servomill::sim::preparation
