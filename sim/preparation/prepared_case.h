/// Everything that has to be done before a case can be simulated; finds every fault of the input.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/engine/simulate.h"
#include "sim/evaluation/comparison.h"
#include "sim/evaluation/part_fit.h"
#include "sim/evaluation/probed_part.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"

namespace servomill::sim {

struct PreparationCache;

struct CaseOutput {
  std::string name;
  CaseResult result;
  std::string program;    // the rewritten program; empty: the original one ran
  double duration = 0.0;  // s, of the program that the NC ran
  double blocks = 0.0;
  std::vector<std::string> notes;  // what the NC put right or could not do as programmed
  std::vector<std::string> sections;
  plant::MachineChain chain;           // the ideal machine
  std::optional<double> signal_delay;  // s, of the feedback hardware; none of an ideal servo
  std::vector<ProbedFeature> probes;   // empty: nothing is probed, or the case stopped
  std::optional<PartFit> part_fit;     // of them, where there is a nominal part
  CaseData data() const;
};

/// A case ready to be simulated. Preparing it finds every fault of the input.
class PreparedCase {
 public:
  /// @param scenario, spec  must outlive this
  /// @param cache           takes what earlier cases computed from the same inputs; may be nullptr
  /// @throws InputError
  PreparedCase(const Scenario& scenario, const CaseSpec& spec, PreparationCache* cache = nullptr);
  ~PreparedCase();
  PreparedCase(PreparedCase&&) noexcept;

  const CaseSpec& spec() const;
  /// Lets rows of its recording be left out, so that it takes about so many bytes of the file.
  void thin(double bytes);

  /// Duration of the planned motion, s.
  double duration() const;

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
  CaseInputs inputs(const std::string& scratch_folder = {}) const;
  /// Output of a run of `inputs()`, with its notes.
  CaseOutput output(CaseResult result) const;

  /// output(simulate(inputs())), and all notes of sim/run/case_notes.h
  CaseOutput run(const StopFlag& stop, std::atomic<float>& progress,
                 const std::string& scratch_folder = {}) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// All cases of a scenario.
/// @param scenario  must outlive them
/// @param cache     may be nullptr
/// @throws InputError with the faults of all cases: gains that are unstable included
std::vector<PreparedCase> prepare_cases(const Scenario& scenario,
                                        PreparationCache* cache = nullptr);

}  // namespace servomill::sim
