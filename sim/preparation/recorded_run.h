/// Recording of an actual run of a program, against the path as it is planned.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/model/scenario.h"
#include "sim/readings/part_readings.h"

namespace servomill::sim::preparation {

/// Readings and setpoints of one run, sample by sample (5; m, rad; 0 of joints without); of a part
/// its points alone.
struct RecordedRun {
  std::string file;
  model::SeenBy sees = model::SeenBy::scales;
  std::vector<double> t;  // s, ascending
  std::vector<Joints> reference;
  std::vector<int> joints;  // whose reference is recorded, in rising order
  /// Readings of the scales of these joints; of a tip its X, Y, Z in the workpiece, first of all.
  std::vector<Joints> measured;
  std::vector<int> seen = {};  // 0 to 2: X, Y, Z of the tip that are recorded
  std::vector<readings::PartPoint> points = {};
};

/// @throws InputError: no such channel, no unit of length or angle, another base than the others,
///         a sample that is missing, an axis that the machine lacks; what is wrong with a part
RecordedRun read_recorded_run(const model::RecordedRunSpec& spec, const JointLayout& layout);

/// A path as it is planned, position period after position period.
struct PlannedInstants {
  double h = 0.0;            // s
  std::vector<Joints> Q;     // (5; m, rad), as the NC interpolates and filters it
  std::vector<bool> feeds;   // in feed motion
  std::vector<int> lines;    // of the program
  std::size_t end = 0;       // instant at which the motion ends; it stands behind
  std::string program = {};  // its file
};

/// Finds the planned instant of each sample by the position of its reference: the nearest around
/// the instant that its time would give after the sample before, never before that one; farther
/// ahead where none is near, as after a dwell of another length.
/// @throws InputError if it is not a recording of this path, at this feed, from its start to its
///         end
std::vector<double> instants_of(const RecordedRun& run, const PlannedInstants& path,
                                const JointLayout& layout);

/// Deviations at the instants 0, every, 2 every, ..., linear between samples; behind the last
/// sample that of it.
/// @param deviation  of the samples (5)
/// @param instants   of the samples
std::vector<Joints> deviations_at(const std::vector<Joints>& deviation,
                                  const std::vector<double>& instants, std::size_t every,
                                  std::size_t rows);

}  // namespace servomill::sim::preparation
