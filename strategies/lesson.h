/// Lesson of a strategy: the offset that it has learnt from runs of the program.
#pragma once

#include <memory>
#include <vector>

namespace servomill::strategies {

struct PathOffset;  // strategies/path_offset.h

/// Deviation in one run.
struct TrialFigures {
  double rms = 0.0;      // m, of the linear joints in feed motion
  double largest = 0.0;  // m
};

/// The offset that was learnt.
struct Lesson {
  std::shared_ptr<const PathOffset> offset;
  std::vector<TrialFigures> trials;  // run after run
};

}  // namespace servomill::strategies
