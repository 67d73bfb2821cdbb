/// Results on disk: what a run leaves behind, and reading it back.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/output_file.h"
#include "sim/run/day_comparison.h"
#include "sim/run/result_file.h"
#include "sim/run/run.h"
#include "sim/run/store_series.h"

namespace servomill::sim::run {

/// Header of every result file: build, kind, the instructions that compute
/// (plant/vocabulary/simd.h), and the scenario with all that it read.
void write_inputs(records::Hdf5Group& root, const model::Scenario& scenario, std::string_view kind,
                  const std::string& shown);

/// Writes a run case by case, so that complete cases can be read even if it ends early. Layout:
/// README, section "The result file".
class RunStore {
 public:
  /// @param threads  that compress; 0: one a core; the file does not depend on it
  /// @throws InputError if the file exists and `force` is not set, SystemError
  RunStore(const std::string& path, bool force, const model::Scenario& scenario,
           unsigned threads = 0);
  void add(const CaseOutput& one);
  /// Writes the comparison and gives the file its final name.
  void commit(const std::vector<evaluation::ComparisonRow>& comparison);
  /// Name under which complete cases are kept when there is no commit.
  const std::string& partial_path() const { return file_.partial_path(); }

 private:
  records::OutputFile file_;
  std::string shown_;  // first case of the scenario: that of the default plot
  bool has_case_ = false;
  SeriesFormat format_;
};

/// A run read back.
struct StoredRun {
  std::string scenario_name, title;
  std::vector<std::unique_ptr<records::Series>> series;
  std::vector<std::unique_ptr<std::vector<evaluation::ProbedFeature>>> probes;
  std::vector<evaluation::CaseData> cases;      // point into `series` and `probes`
  std::vector<model::QuantitySpec> quantities;  // of the stored scenario
  std::vector<NamedDay> days;                   // of the cases that have one
};

/// @throws InputError if the file is none of ours or of another schema version
StoredRun read_run(const std::string& path);

}  // namespace servomill::sim::run
