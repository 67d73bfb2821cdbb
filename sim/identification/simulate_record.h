/// A recording simulated: the axis with its drive under the loop that the recording was made with.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "plant/drives/feed_drive.h"
#include "sim/identification/record.h"
#include "sim/identification/sampled_loop.h"
#include "sim/model/forward.h"

namespace servomill::sim::identification {

/// Everything that estimation may vary of one axis in one recording.
struct AxisModel {
  plant::FeedDriveParams drive;
  LoopSettings loop;
  double position = 0.0, speed = 0.0;  // m or rad, m/s: when the recording begins
  double step = 0.0;                   // m or rad, of the encoders; 0: not quantised
  std::shared_ptr<const model::MachineSettings> machine =
      nullptr;    // its NC closes the loops: LoopKind::nc
  int joint = 0;  // the same
};

/// Signals of the recording as the model gives them.
struct Simulated {
  std::vector<double> feedback;  // m or rad
  std::vector<double> scale;     // m or rad: of the slide
  std::vector<double> force;     // N or N m, computed by the loop
  bool resolved = true;          // false: friction too stiff for the exact step, not to be trusted
  bool diverges = false;         // it leaves the possible positions: not to be trusted either
};

/// Simulates models under one recording's command and disturbance, eight at a time, on the exact
/// drives (plant/drives/drive_bank.h). Models are independent: each gives the same bits alone.
/// @param models   of one loop kind and period, that of the record
/// @param threads  0: one a core
/// @return one for each model
std::vector<Simulated> simulate(const Record& record, std::span<const AxisModel> models,
                                unsigned threads = 0);

}  // namespace servomill::sim::identification
