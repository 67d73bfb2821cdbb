/// The result table of a sweep on disk: one row a point, filled in any order, resumed after a kill.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/simd.h"
#include "sim/model/forward.h"
#include "sim/records/output_file.h"
#include "sim/sweep/run_sweep.h"
#include "sim/sweep/selection.h"
#include "sim/sweep/table_columns.h"

namespace servomill::sim::records {
class Hdf5Dataset;
class InputFile;
}  // namespace servomill::sim::records

namespace servomill::sim::sweep {

/// Number of points of each status.
using StatusCounts = std::array<std::uint64_t, run::kPointStatuses>;

/// The table under construction. Layout of the file: README, section "Sweeps".
///
/// The file has its full length from the beginning and nothing in it moves. A row is written before
/// its status says so, both flushed: whenever the process is killed, rows whose status says so are
/// whole.
class SweepTable {
 public:
  /// Makes `path`, goes on with what a sweep of the same scenario, version and selection left of
  /// it, or finds it complete.
  /// @throws InputError if there are files that are none of that and `force` does not allow to
  /// replace them
  SweepTable(const std::string& path, bool force, const model::Scenario& base,
             std::vector<TableColumn> columns, const Selection& selection);

  /// How points ended, by place in the selection.
  const std::vector<run::PointStatus>& statuses() const { return statuses_; }
  const StatusCounts& counts() const { return counts_; }
  /// The file has its final name and nothing is left to be done.
  bool is_complete() const { return !file_; }

  /// Forgets points of a status, so that they are not_run; a complete table with such points is
  /// one under construction again.
  void forget(run::PointStatus status);
  /// Adds points that were not run. @pre !is_complete()
  void write(std::span<const SweepPoint> points);
  /// Copies rows of another table of the same scenario, those with a status. @pre !is_complete()
  void copy(const records::InputFile& from);
  /// Gives the file its final name and writes the CSV file beside it. @pre !is_complete()
  void commit();
  /// From here on nothing stays without a commit.
  void remove_unless_committed() {
    if (file_) file_->remove_unless_committed();
  }
  std::string partial_path() const { return path_ + ".partial"; }
  /// Levels of instructions that points were computed with, in rising order. Where there are
  /// baseline among others, results differ in their last bits.
  std::vector<SimdLevel> simd_levels() const;

 private:
  void make(const model::Scenario& base);
  void take_over(const std::string& name, const model::Scenario& base);
  void take_statuses(const records::InputFile& file);
  void set_status(std::uint64_t row, run::PointStatus status);
  void write_runs(std::span<const std::uint64_t> rows, records::Hdf5Dataset& to,
                  std::span<const double> values);

  std::string path_;
  Selection selection_;
  std::vector<TableColumn> columns_;
  std::vector<run::PointStatus> statuses_;
  StatusCounts counts_{};
  std::set<SimdLevel> levels_;
  std::optional<records::OutputFile> file_;
};

}  // namespace servomill::sim::sweep
