/// A scenario run at the points of its [sweep] table.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/input/scenario_source.h"
#include "sim/model/design.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/run/batch.h"
#include "sim/sweep/selection.h"

namespace servomill::sim {

/// A scenario with a sweep. Constant: threads may share it.
class Sweep {
 public:
  /// @param changes  what --set says, at all points
  /// @throws InputError if the scenario cannot be read or has no [sweep] table
  Sweep(std::string scenario_path, std::vector<std::string> changes);

  /// The scenario as it is without its sweep. Its `swept_files` are those that values of the sweep
  /// name, one line each: "CHECKSUM NAME", or "unreadable NAME"; sorted. They belong to what the
  /// sweep is: a table of it is not gone on with when they have changed.
  const Scenario& base() const { return base_; }
  const SweepDesign& design() const { return base_.sweep; }

  /// Reads the scenario with the values of a point set as --set would. Names of files among the
  /// values are relative to the scenario that holds the list.
  /// @throws InputError at the values that are refused
  Scenario at(std::uint64_t point) const;

  /// The rows of the comparison at any point, without their values.
  std::vector<ComparisonRow> quantities() const;

  /// Refuses what is wrong at every point, such as a key that there is not: points are read and
  /// prepared, from the first to the last in equal steps, until one is found right. A point at
  /// which the system fails is not wrong.
  /// @throws InputError
  /// @return what the first right point takes on one thread, where one was found
  std::optional<RunEstimate> refuse_hopeless() const;

  /// Reads and prepares all points, of more than 256 so many in equal steps.
  /// @throws InputError at the first point that is refused
  void check() const;

 private:
  InputError at_the_list(const InputError& error, const std::vector<std::string>& values) const;
  std::string assignment(std::size_t key, const std::string& value) const;
  std::optional<std::string> named_file(std::size_t key, const std::string& value) const;
  std::string swept_files() const;

  std::string path_;
  std::vector<std::string> changes_;
  ScenarioSource source_;
  Scenario base_;
};

/// One point that was run.
struct SweepPoint {
  std::uint64_t index = 0;          // counted from 0
  std::vector<std::string> values;  // TOML, for each key
  BatchResult result;
};

/// Most points that are run together.
inline constexpr std::size_t kBatchPoints = 16;

struct SweepControl {
  unsigned threads = 0;              // 0: as many as there are cores
  std::size_t batch = kBatchPoints;  // at least 1
  const StopFlag* stop = nullptr;
  Keep keep = Keep::comparison;
  std::function<void(double)> progress;  // share done, 0 to 1; called from one thread
  /// Points that ended, as soon and in the order in which they do; called from one thread. What it
  /// throws ends the sweep.
  std::function<void(std::vector<SweepPoint>&&)> batch_done;
};

/// Runs the points of a selection that are not done, in batches of neighbours. The result of a
/// point depends neither on the batches nor on the number of threads. A fault at a point is its
/// result.
/// @param done  by place in the selection
void run_sweep(const Sweep& sweep, const Selection& selection, const std::vector<bool>& done,
               const SweepControl& control);

}  // namespace servomill::sim
