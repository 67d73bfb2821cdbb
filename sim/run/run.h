/// A scenario, run: every case prepared, simulated on all cores, compared.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/engine/stop_flag.h"
#include "sim/model/forward.h"
#include "sim/preparation/estimate.h"

namespace servomill::sim::preparation {
struct PreparationCache;
}  // namespace servomill::sim::preparation

namespace servomill::sim::evaluation {
struct ComparisonRow;  // sim/evaluation/comparison_row.h
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

struct CaseOutput;  // sim/run/run_case.h
struct RunOutput;   // sim/run/run_output.h

struct RunControl {
  unsigned threads = 0;  // 0: as many as there are cores
  const engine::StopFlag* stop = nullptr;
  preparation::PreparationCache* cache = nullptr;  // shared with other runs, may be null
  std::string scratch_folder;  // of long recordings until they are compared; empty: that of
                               // temporary files
  // what the run takes is known, also its trial runs, which come next; called once, if there are
  // any
  std::function<void(const preparation::RunEstimate&)> trials_come;
  // every fault of the input is found, and what the run takes is known; called once
  std::function<void(const preparation::RunEstimate&)> prepared;
  bool stores_signals = false;  // in a file: they are encoded while a case runs
  std::function<void(const CaseOutput&)>
      case_done;  // called from one thread, in order of the cases
};

/// @throws InputError before anything is simulated
RunOutput run_scenario(const model::Scenario& scenario, const RunControl& control);

/// The same for callers that need no complete RunOutput.
std::shared_ptr<const RunOutput> shared_run(const model::Scenario& scenario,
                                            const RunControl& control);

/// Its comparison.
const std::vector<evaluation::ComparisonRow>& comparison_of(const RunOutput& output);

/// Prepares every case as for a run, but for runs from which strategies learn, and returns what it
/// would take on one thread.
/// @throws InputError with the faults of all cases, as far as they show without these runs
preparation::RunEstimate check_scenario(const model::Scenario& scenario);

/// Checks what reading a machine leaves open: whether its loops are stable.
/// @throws InputError
void check_machine(const model::MachineSettings& machine);

}  // namespace servomill::sim::run
