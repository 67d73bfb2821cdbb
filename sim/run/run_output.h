/// Result of a run.
#pragma once

#include <vector>

#include "sim/evaluation/comparison_row.h"
#include "sim/run/run_case.h"

namespace servomill::sim::run {

struct RunOutput {
  std::vector<CaseOutput> cases;
  std::vector<evaluation::ComparisonRow> comparison;
  double wall_time = 0.0;  // s
};

}  // namespace servomill::sim::run
