/// One case of a scenario, run: NC, drives, encoders, feedback hardware, recorder, on one clock.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controllers/path/trajectory.h"
#include "plant/drives/prepared_drives.h"
#include "plant/geometry/volumetric.h"
#include "sim/engine/case_result.h"
#include "sim/engine/cutting_load.h"
#include "sim/engine/program_path.h"
#include "sim/engine/recording_windows.h"
#include "sim/engine/run_outputs.h"
#include "sim/model/forward.h"
#include "sim/model/run_settings.h"
#include "sim/records/row_keeper.h"
#include "strategies/strategy.h"

namespace servomill::sim::engine {

/// Part of a strategy in the position loops of one run.
struct PositionLoopTerm {
  std::string strategy;  // its name, for messages
  std::unique_ptr<strategies::PositionLoopPart> part;
};

/// Inputs of one case. References are shared with other cases; parts belong to this run.
struct CaseInputs {
  const model::MachineSettings& machine;
  const plant::VolumetricModel& machine_errors;  // the machine as it is
  const plant::VolumetricModel* imposed;         // displacement to be recorded, or nullptr
  const controllers::Trajectory& reference;      // of the program that the NC runs
  const ProgramPath& path;                       // of the original program
  const std::map<int, Eigen::Vector3d>& tips;    // p_ST (m) by tool offset number
  model::ServoModel servo = model::ServoModel::cascade;
  model::FeedbackHardware hardware;
  std::vector<std::unique_ptr<strategies::SetpointPart>> setpoints;
  const strategies::Strategy* feedback = nullptr;  // the one that displaces it, if any
  std::vector<PositionLoopTerm> position_loop_terms = {};
  Tick record_period = 100;
  double settle_time = 0.1;  // s, recorded after the program's end
  model::RecordFormat format = {};
  records::RowKeeping keeping = {};
  bool program_displaces_rotary = false;  // the NC runs another program than `path` also there
  // of which is recorded what they cannot correct
  std::vector<const strategies::Strategy*> recorded_corrections = {};
  ProgramPath::Indices pieces = {};       // of `path`, for each move that the NC runs
  const CuttingTable* cutting = nullptr;  // along `path`; nullptr: in air
  const EngagedTeeth* teeth = nullptr;    // of `cutting`; nullptr: the average force acts
  // cuts beside `cutting`; nullptr: the depth of cut is the nominal one
  const std::vector<DisplacedCut>* displaced_cuts = nullptr;
  bool regeneration = false;  // of the chips of `teeth`, by the tool-point modes of the machine
  Tick tooth_step = 0;        // period of the force of the teeth
  model::CuttingWear wear = {};
  // of a machine with heat: its errors at the reference temperature, and the speed of the spindle
  // (rad/s) during each move that the NC runs
  const plant::ErrorModel* component_errors = nullptr;
  std::vector<double> spindle_speeds = {};
  // whose thermal network a strategy computes during the run; nullptr: none does
  const model::MachineSettings* known_heat = nullptr;
  bool records_orientation = false;  // of the tool about its axis
  RecordingWindows windows = {};
  std::string stops_with = {};  // why the case stops where it begins; empty: it does not
  RunOutputs outputs = {};
};

/// True if two cases can run in lockstep: the same axes, moved at the same instants. Everything
/// else may differ: program, feed, strategy, any number of the machine.
bool share_lanes(const CaseInputs& a, const CaseInputs& b);

/// Runs cases in lockstep, eight axes at a time. Each result is that of the case run alone, bit for
/// bit.
/// @param together  at least one; share_lanes holds for each with the first. An ideal machine runs
///                  alone
/// @param stop      looked at once a hyperperiod
/// @param progress  set to the simulated share, 0 to 1, as often
/// @param kept      drives prepared for other runs, and where those of these are kept
std::vector<CaseResult> simulate(std::span<CaseInputs* const> together, const StopFlag& stop,
                                 std::atomic<float>& progress,
                                 plant::PreparedDrives* kept = nullptr);
CaseResult simulate(CaseInputs& inputs, const StopFlag& stop, std::atomic<float>& progress);

}  // namespace servomill::sim::engine
