/// Turns what a case knows at its record instants into rows of signals (the edge: SI becomes mm,
/// deg, um here and nowhere else).
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/inverse.h"
#include "plant/kinematics/linear_joints.h"
#include "sim/engine/program_path.h"
#include "sim/engine/recorded_row.h"
#include "sim/engine/run_outputs.h"
#include "sim/engine/snapshot.h"
#include "sim/model/machine.h"
#include "sim/model/run_settings.h"
#include "sim/records/row_keeper.h"
#include "sim/records/series.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

/// The rows of one case.
class RecordedRows {
 public:
  /// As those of Recorder, all of which must outlive it.
  RecordedRows(const model::MachineSettings& machine, const plant::VolumetricModel& machine_errors,
               const plant::VolumetricModel* imposed, const ProgramPath& path,
               const std::map<int, Eigen::Vector3d>& tips, const model::RecordFormat& format,
               bool rotary_displaced, std::vector<const strategies::Strategy*> correcting,
               bool cuts, records::RowKeeping keeping, bool teeth, bool oriented, bool windows,
               const RunOutputs& outputs);

  void expect(std::size_t rows) { keeper_.emplace(signals_, keeping_, rows); }
  /// All rows; once.
  records::Series take();
  /// @param errors  of the machine from here on
  void use(const plant::VolumetricModel& errors, const std::vector<double>& temperatures) {
    machine_errors_ = &errors;
    temperatures_ = temperatures;
  }

  /// @param directions  of each snapshot, one behind the other
  void add(const std::vector<Snapshot>& block, std::span<const double> directions);

 private:
  std::size_t find_places(const std::vector<Snapshot>& block, std::size_t first);
  Joints ideal_joints(const Joints& Q_true, int tool_offset) const;
  void find_actual(const Eigen::Vector3d& p_ST, std::span<const double> directions,
                   std::vector<ToolPose>& out) const;
  void find_sides(std::span<const double> directions);
  void find_poses(std::span<const double> directions);
  void choose(const RunOutputs& outputs, std::vector<records::Signal>& signals);
  void displace_tip(const Snapshot& now, Eigen::Vector3d& p_WT) const;
  void make_row(const Snapshot& now, std::size_t place, double* to);
  void put_axes(const Snapshot& now, RowWriter& row) const;
  double contour_error(std::size_t place);
  const plant::TipOfLinearJoints& tip_at(const Joints& Q_rotary);
  void put_structure(const Snapshot& now, RowWriter& row) const;
  void put_residual(std::size_t place, RowWriter& row) const;

  const model::MachineSettings& machine_;
  const plant::VolumetricModel* machine_errors_;
  std::vector<double> temperatures_;  // K
  const plant::VolumetricModel* imposed_;
  const ProgramPath& path_;
  const std::map<int, Eigen::Vector3d>& tips_;
  const bool rotary_displaced_;
  const std::vector<const strategies::Strategy*> correcting_;
  const bool cuts_;
  const bool teeth_;
  const bool bends_;    // under acceleration
  const bool has_bed_;  // that moves
  const plant::VolumetricModel ideal_{machine_.chain, {}};
  const plant::InverseKinematics inverse_{machine_.chain};
  std::vector<int> linear_, rotary_;  // joints that the machine has
  // of rows that follow each other with the same tool
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
  std::vector<std::size_t> pieces_;
  std::vector<Joints> Q_prog_, Q_true_;
  std::vector<ToolPose> nominal_, actual_;
  std::vector<Eigen::Vector3d> displacement_, side_;
  const records::RowKeeping keeping_;
  const bool oriented_;  // the direction across the tool axis is recorded
  const bool windows_;   // rows outside of some are left out
  const bool wants_axes_, wants_contour_error_;
  struct RotaryStand {
    Joints Q_rotary;
    Eigen::Vector3d p_ST;
    plant::TipOfLinearJoints tip;
  };
  std::optional<RotaryStand> stand_;   // of the row before: rotary axes mostly stand for long
  std::vector<std::size_t> chosen_;    // columns of a whole row that are recorded; empty: all
  std::vector<double> whole_row_;      // where some are chosen
  std::vector<std::string> left_out_;  // signals
  std::vector<records::Signal> signals_;
  std::size_t width_ = 0;
  Rounding rounding_{records::Series()};
  std::vector<double> rows_;  // of a block
  std::optional<records::RowKeeper> keeper_;
};

}  // namespace servomill::sim::engine
