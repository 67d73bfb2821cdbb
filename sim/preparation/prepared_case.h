/// Everything that has to be done before a case can be simulated; finds every fault of the input.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "strategies/strategy.h"
#include "strategies/trial_runs.h"

namespace servomill::sim::engine {
struct CaseInputs;
}  // namespace servomill::sim::engine

namespace servomill::sim::preparation {

struct InterpretedProgram;
struct PlannedCutting;
struct PlannedMotion;
struct PreparationCache;
struct RewrittenProgram;

/// A case as it was prepared; refers to the PreparedCase and to its scenario.
struct PreparedParts {
  const model::Scenario& scenario;
  const model::CaseSpec& spec;
  const InterpretedProgram& program;
  const PlannedMotion& motion;
  std::span<const std::shared_ptr<const strategies::Strategy>> strategies;  // those of spec
  const RewrittenProgram* rewritten;      // nullptr: the original program runs
  const PlannedCutting* cutting;          // nullptr: it runs in air
  const plant::VolumetricModel* imposed;  // nullptr: no errors are imposed
  double distance_of_plan;                // m, of nominal points from the part
  std::span<const std::string> warnings;  // of margins that strategies leave
  // of each strategy the runs that it has learnt from, and its offset
  std::span<const strategies::Lesson> lessons;
};

/// Runs of the program of a case from which its strategies have yet to learn.
struct TrialRunsToCome {
  int number = 0;       // at most, unless the path has to be planned anew
  double motion = 0.0;  // s, of all of them
};

/// A case that has to learn before it can be simulated, if its strategies do. Preparing it finds
/// every fault of the input that shows without a run.
class PreparedCase {
 public:
  /// @param scenario, spec  must outlive this
  /// @param cache           takes what earlier cases computed from the same inputs; may be nullptr
  /// @throws InputError
  PreparedCase(const model::Scenario& scenario, const model::CaseSpec& spec,
               PreparationCache* cache = nullptr);
  ~PreparedCase();
  PreparedCase(PreparedCase&&) noexcept;

  const model::CaseSpec& spec() const;
  TrialRunsToCome trial_runs() const;
  /// True until teach() was called, if a strategy learns: from runs or from recordings of them.
  bool has_to_learn() const;
  /// Has the strategies learn from runs of its program, which may take long.
  /// @param cache  as that of the constructor
  /// @throws InputError
  void teach(PreparationCache* cache = nullptr);

  /// Lets rows of its recording be left out, so that it takes about so many bytes of the file.
  void thin(double bytes);

  /// Why the case stops where it begins, as a plug-in could not rewrite its program; empty: it
  /// runs.
  const std::string& stops_with() const;

  /// Duration of the planned motion, s.
  double duration() const;
  /// Time recorded of it and of the standstill afterwards, s; about, if there are windows.
  double recorded_duration() const;

  /// Step of the teeth of its cut, s; 0: no single teeth cut.
  double tooth_step() const;

  /// Names of the sections of the original program.
  const std::vector<std::string>& sections() const;

  /// Tool centre point of the ideal machine (in the workpiece, m) at the samples
  /// of feed motion in each of the sections.
  std::map<std::string, std::vector<Eigen::Vector3d>> nominal_positions(
      const std::set<std::string>& sections) const;

  /// Faults of the scenario's quantities of circular tests.
  std::vector<Fault> circular_faults(PreparationCache* cache = nullptr) const;

  /// Inputs of one run; refers to this and to the scenario.
  /// @param scratch_folder  of recordings that are long; empty: that of temporary files
  engine::CaseInputs inputs(const std::string& scratch_folder = {}) const;
  PreparedParts parts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace servomill::sim::preparation
