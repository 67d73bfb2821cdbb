/// A case with a plug-in, simulated in a process of its own (`run --isolate`).
#pragma once

#include <atomic>
#include <memory>

#include "sim/engine/simulate.h"
#include "sim/model/forward.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/run_case.h"
#include "strategies/plugin_child.h"

namespace servomill::sim::run {

/// True if a strategy of the case comes from a shared library.
bool uses_plugin(const model::CaseSpec& spec);

/// A child process that waits until its case is to be simulated. The result is that of simulate(),
/// bit for bit. Where a plug-in crashes, calls exit() or does not return, the case has stopped for
/// that reason, and its recording ends where it began.
class IsolatedCase {
 public:
  /// @param prepared  must outlive this; uses_plugin() holds
  IsolatedCase(const preparation::PreparedCase& prepared, SignalStorage storage);

  /// Simulates, on any thread; once.
  engine::CaseResult simulate(const engine::StopFlag& stop, std::atomic<float>& progress);

 private:
  using Progress = std::atomic<float>;  // in memory of both processes

  engine::CaseResult wait(const engine::StopFlag& stop, std::atomic<float>& progress);
  engine::CaseResult stopped(std::string why) const;

  const preparation::PreparedCase& prepared_;
  SignalStorage storage_;
  std::shared_ptr<Progress> progress_;
  strategies::PluginChild child_;
};

}  // namespace servomill::sim::run
