/// Results on disk: what a run leaves behind, and reading it back.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/hdf5/hdf5_file.h"
#include "sim/run.h"
#include "sim/sweep.h"

namespace servomill::sim {

/// Version of the layout of result files; a file of another one is refused.
inline constexpr int kSchemaVersion = 1;

/// Writes a run case by case, so that complete cases can be read even if it ends early. Layout:
/// DESIGN in README, section "The result file".
class RunStore {
 public:
  /// @throws InputError if the file exists and `force` is not set, SystemError
  RunStore(const std::string& path, bool force, const Scenario& scenario);
  void add(const CaseOutput& one);
  /// Writes the comparison and gives the file its final name.
  void commit(const std::vector<ComparisonRow>& comparison);
  /// Name under which complete cases are kept when there is no commit.
  const std::string& partial_path() const { return file_.partial_path(); }

 private:
  OutputFile file_;
};

/// A run read back.
struct StoredRun {
  std::string scenario_name, title;
  std::vector<std::unique_ptr<Series>> series;
  std::vector<CaseData> cases;           // point into `series`
  std::vector<QuantitySpec> quantities;  // of the stored scenario
};

/// @throws InputError if the file is none of ours or of another schema version
StoredRun read_run(const std::string& path);

/// @throws InputError if a result file of that name exists and `force` is not set
void refuse_existing(const std::string& path, bool force);

/// Table of a sweep: one list for each key and each quantity, over the points.
void write_sweep(const std::string& path, bool force, const Scenario& scenario,
                 const std::vector<SweepPoint>& points);

}  // namespace servomill::sim
