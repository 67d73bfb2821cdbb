/// Records what a case knows at its record instants.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "sim/engine/program_path.h"
#include "sim/engine/recorded_rows.h"
#include "sim/engine/recording_windows.h"
#include "sim/engine/run_outputs.h"
#include "sim/engine/snapshot.h"
#include "sim/model/forward.h"
#include "sim/model/run_settings.h"
#include "sim/records/row_keeper.h"
#include "sim/records/series.h"
#include "sim/system/worker_thread.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

/// Whoever records only copies a Snapshot. Rows are made from blocks of them, in a thread of the
/// recorder unless its outputs say otherwise: then it waits only if that is slower than the
/// simulation.
class Recorder {
 public:
  /// All arguments must outlive it.
  /// @param imposed  model whose displacement at the programmed position is recorded; may be null
  /// @param rotary_displaced  the program that runs turns rotary axes elsewhere than `path` does:
  ///                          where s stands, they are compared with the nearest programmed place
  /// @param cuts  force of the cut and deflection are recorded; the deflection moves the tip
  /// @param keeping  where rows are kept
  /// @param teeth  the force is that of single teeth: the angle of the spindle is recorded
  /// @param correcting  strategies of which is recorded what they cannot correct, in all
  /// @param oriented  the direction of the tool across its axis is recorded
  /// @param windows  rows outside are left out but for the first and the last row of the case and
  ///                 those that enclose a window: what is interpolated inside it is complete
  /// @param outputs  signals that are recorded. @pre all, of rows that are thinned or have windows
  Recorder(const model::MachineSettings& machine, const plant::VolumetricModel& machine_errors,
           const plant::VolumetricModel* imposed, const ProgramPath& path,
           const std::map<int, Eigen::Vector3d>& tips, const model::RecordFormat& format = {},
           bool rotary_displaced = false, std::vector<const strategies::Strategy*> correcting = {},
           bool cuts = false, records::RowKeeping keeping = {}, bool teeth = false,
           bool oriented = false, RecordingWindows windows = {}, const RunOutputs& outputs = {});
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// False if of a Snapshot only Q_ref and Q_true are recorded, and what gives way.
  bool wants_axes() const { return wants_axes_; }
  /// From the next row on, the machine has these errors, and its bodies these temperatures (K).
  void use(std::shared_ptr<const plant::VolumetricModel> machine_errors,
           std::vector<double> temperatures);
  /// Says how many rows will come, about; before the first.
  void expect(std::size_t rows);
  /// @param directions  in which axes have travelled: of each of machine_errors.plays()
  void record(const Snapshot& now, std::span<const double> directions = {});
  /// All rows; once.
  records::Series take();
  /// Rows of feed motion outside the windows, by section; empty: none.
  const std::vector<std::size_t>& left_out() const { return left_out_; }

 private:
  struct Block;
  void add(const Snapshot& now, std::span<const double> directions, bool inside = true);
  void add_held();
  void count_outside(std::size_t piece);
  void hand_over();
  std::size_t block_rows() const;
  void make_rows(const Block& block);

  RecordedRows rows_;
  struct Block {
    std::vector<Snapshot> snapshots;
    std::vector<double> directions;  // of each snapshot, one behind the other
    std::shared_ptr<const plant::VolumetricModel> machine_errors;  // nullptr: those of the case
    std::vector<double> temperatures;                              // K
  };
  Block filling_;
  Block working_;  // what the thread turns into rows
  const ProgramPath& path_;
  const RecordingWindows windows_;
  const bool wants_axes_, makes_rows_beside_;
  Block held_;  // the row before this one, if it lies outside and has not been recorded
  bool was_inside_ = true, has_gap_ = false;
  double window_ = 0.0;
  std::vector<std::size_t> left_out_;
  system::WorkerThread background_;  // last: its thread uses the others
};

}  // namespace servomill::sim::engine
