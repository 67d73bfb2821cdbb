/// Deviation of the tool along a planned path, as probed points of the part show it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/preparation/cut_places.h"

namespace servomill::sim::preparation {

/// A probed point where it was cut.
struct ProbedCut {
  CutPlace place;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double deviation = 0.0;  // m along the normal
};

/// Feed motion of which no point was probed.
struct UnprobedRun {
  int first_line = 0, last_line = 0;
};

struct PartDeviations {
  std::vector<Eigen::Vector3d> tip;  // m, row by row, in the frame of the rows
  std::vector<UnprobedRun> unprobed;
};

/// Along each run the points that the same part of the cutter has made on the same face are put in
/// a row: the next point has a normal within 60 deg, as seen from the part or, where the path
/// turns, from the path. Between them the deviation is linear in the arc length and along the
/// normal of the face where the tool is, of what the tip has cut along the tool axis; before the
/// first and behind the last one it is constant. Points within 10 um count as one.
///
/// On a run with several faces the deviation is the shortest vector that fits theirs best:
/// opposite walls of a slot show where the tool was between them, not its diameter. Along the path
/// nothing is known. Runs without points deviate by nothing; in rapid moves the deviation goes
/// linearly from the run before to the one behind.
PartDeviations part_deviations(const std::vector<ToolRow>& rows,
                               const std::vector<ProbedCut>& cuts);

}  // namespace servomill::sim::preparation
