/// Turns what a case knows at a record instant into a row of signals (the edge: SI becomes mm, deg,
/// um here and nowhere else).
#pragma once

#include <map>

#include "plant/geometry/volumetric.h"
#include "sim/machine.h"
#include "sim/program_path.h"
#include "sim/series.h"

namespace servomill::sim {

/// Everything that is recorded of one instant, SI.
struct Snapshot {
  double time = 0.0;
  double s = 0.0;
  Joints Q_ref = Joints::Zero();   // interpolated
  Joints Q_cmd = Joints::Zero();   // after set-point corrections
  Joints Q_read = Joints::Zero();  // what the NC reads (virtual encoder)
  Joints Q_meas = Joints::Zero();  // what the scale says
  Joints Q_true = Joints::Zero();
  Joints dQ_true = Joints::Zero();
  Joints current = Joints::Zero();
  Joints torque = Joints::Zero();
};

class Recorder {
 public:
  /// @param imposed  model whose displacement at the programmed position is recorded; may be null
  Recorder(const MachineSettings& machine, const plant::VolumetricModel& truth,
           const plant::VolumetricModel* imposed, const ProgramPath& path,
           const std::map<int, Eigen::Vector3d>& tips);

  void reserve(std::size_t rows) { series_.reserve(rows); }
  void record(const Snapshot& now);
  Series take() { return std::move(series_); }

 private:
  const MachineSettings& machine_;
  const plant::VolumetricModel& truth_;
  const plant::VolumetricModel* imposed_;
  const ProgramPath& path_;
  const std::map<int, Eigen::Vector3d>& tips_;
  std::vector<int> linear_, rotary_;  // joints that the machine has
  std::size_t piece_ = 0;
  Series series_;
};

}  // namespace servomill::sim
