/// Results on disk: what a run leaves behind, and reading it back.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/run/run.h"

namespace servomill::sim::records {
struct SeriesLayout;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

/// Version of the layout of result files; a file of another one is refused.
inline constexpr int kSchemaVersion = 1;

/// Says which program writes a file: version and build (sim/run/build_identity.h).
void write_build(records::Hdf5Group& root);
/// The build that wrote it; only its version if it is older than that.
std::string build_of(const records::InputFile& file);

/// Header of every result file: build, kind, the instructions that compute
/// (plant/vocabulary/simd.h), and the scenario with all that it read.
void write_inputs(records::Hdf5Group& root, const model::Scenario& scenario, std::string_view kind);

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
  void write_series(records::Hdf5Group group, const records::Series& series) const;
  static void write_pages(records::Hdf5Group group, records::SeriesLayout layout,
                          const records::Series& series);

  records::OutputFile file_;
  int compression_;
  unsigned threads_;
};

/// A run read back.
struct StoredRun {
  std::string scenario_name, title;
  std::vector<std::unique_ptr<records::Series>> series;
  std::vector<std::unique_ptr<std::vector<evaluation::ProbedFeature>>> probes;
  std::vector<evaluation::CaseData> cases;      // point into `series` and `probes`
  std::vector<model::QuantitySpec> quantities;  // of the stored scenario
};

/// @throws InputError if the file is none of ours or of another schema version
StoredRun read_run(const std::string& path);

/// The lines of a text attribute: one more than it has line breaks.
std::vector<std::string> split_lines(const std::string& text);

/// True if a file begins as HDF5 does.
bool is_hdf5(const std::string& path);

/// The name under which a result file may be made (sim/system/output_name.h): neither it nor its
/// partial file exists, or `force` is set and it is a result file (anything else is never
/// overwritten).
/// @throws InputError, SystemError while another process writes it
std::string writable_name(const std::string& path, bool force);

}  // namespace servomill::sim::run
