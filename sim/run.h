/// A scenario, run: every case prepared, simulated on all cores, compared.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/comparison.h"
#include "sim/scenario.h"
#include "sim/simulate.h"

namespace servomill::sim {

struct CaseOutput {
  std::string name;
  CaseResult result;
  std::string program;    // the rewritten program; empty: the original one ran
  double duration = 0.0;  // s, of the program that the NC ran
  double blocks = 0.0;
  std::vector<std::string> sections;
  CaseData data() const;
};

/// A case ready to be simulated. Preparing it finds every fault of the input.
class PreparedCase {
 public:
  /// @throws InputError
  PreparedCase(const Scenario& scenario, const CaseSpec& spec);
  ~PreparedCase();
  PreparedCase(PreparedCase&&) noexcept;

  /// Names of the sections of the original program.
  const std::vector<std::string>& sections() const;

  /// Where the tool centre point of the ideal machine will be (in the workpiece, m) at the samples
  /// of feed motion in a section.
  std::vector<Eigen::Vector3d> nominal_positions(const std::string& section) const;

  CaseOutput run(const StopFlag& stop, std::atomic<float>& progress);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

struct RunControl {
  unsigned threads = 0;  // 0: as many as there are cores
  const StopFlag* stop = nullptr;
  std::function<void()> prepared;        // every fault of the input is found; called once
  std::function<void(double)> progress;  // share done, 0 to 1; called from one thread
  std::function<void(const CaseOutput&)>
      case_done;  // called from one thread, in order of the cases
};

struct RunOutput {
  std::vector<CaseOutput> cases;
  std::vector<ComparisonRow> comparison;
  double wall_time = 0.0;  // s
};

/// @throws InputError before anything is simulated
RunOutput run_scenario(const Scenario& scenario, const RunControl& control);

/// Prepares every case as for a run.
/// @throws InputError with the faults of all cases
void check_scenario(const Scenario& scenario);

/// Checks what reading a machine leaves open: whether its loops are stable.
/// @throws InputError
void check_machine(const MachineSettings& machine);

/// Interprets the program of a case as its machine would (work offset, tools, parameters).
std::vector<Move> read_program(const Scenario& scenario, const CaseSpec& spec);

}  // namespace servomill::sim
