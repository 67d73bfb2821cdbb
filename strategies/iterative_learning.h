/// Strategy that learns the offset of the setpoints from runs of the program, run after run.
#pragma once

#include <memory>

#include "plant/vocabulary/parameters.h"
#include "strategies/displaced_blocks.h"
#include "strategies/learning_filter.h"
#include "strategies/trial_runs.h"

namespace servomill::strategies {

/// The parameter `limits` as every strategy declares it that offsets the setpoints along a path.
extern const ParameterSpec kLimitsSpec;

struct LearningPlan {
  TrialSetup setup;
  LearningFilter filter;
  BlockLimits blocks;      // of the program, if the offset is written into it
  double tolerance = 0.0;  // m; it ends once the largest deviation is below
  // the run with the smallest rms decides, and it ends where runs no longer get better; else all
  // runs take place, and the offset is that after the last one
  bool takes_best = true;
};

/// The parameter `cutoff_Hz` as both strategies declare it.
extern const ParameterSpec kCutoffSpec;
/// The plan as far as both have the same parameters: axes, singular_deg, cutoff_Hz, limits.
LearningPlan learning_plan_of(const Parameters& parameters);

/// @throws InputError without a place if a run stops, or if the filter does not contract
Lesson learn(const LearningPlan& plan, const JointLayout& layout, TrialRuns& runs);

std::unique_ptr<LearningStrategy> iterative_learning(const LearningPlan& plan,
                                                     const IdentifiedMachine& identified);

}  // namespace servomill::strategies
