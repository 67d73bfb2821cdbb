/// Results on disk: what a run leaves behind.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/model/forward.h"
#include "sim/records/output_file.h"
#include "sim/run/result_file.h"

namespace servomill::sim::records {
class Hdf5Group;
}  // namespace servomill::sim::records

namespace servomill::sim::evaluation {
struct ComparisonRow;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

struct CaseOutput;  // sim/run/run_case.h

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
  RunStore(RunStore&&) noexcept;
  ~RunStore();
  void add(const CaseOutput& one);
  /// Writes the comparison and gives the file its final name.
  void commit(const std::vector<evaluation::ComparisonRow>& comparison);
  /// Name under which complete cases are kept when there is no commit.
  const std::string& partial_path() const { return file_.partial_path(); }

 private:
  struct Signals;

  records::OutputFile file_;
  std::string shown_;  // first case of the scenario: that of the default plot
  bool has_case_ = false;
  std::unique_ptr<Signals> signals_;
};

}  // namespace servomill::sim::run
