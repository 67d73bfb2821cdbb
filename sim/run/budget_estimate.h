/// Estimate of what budgets take, made before their first run ends.
#pragma once

#include <map>
#include <string>

#include "sim/preparation/estimate.h"
#include "sim/run/budget_causes.h"

namespace servomill::sim::run {

/// Runs one after the other: memory is that of a run.
struct BudgetEstimate {
  preparation::RunEstimate run;  // of all causes
  int runs = 0;                  // with all causes and without some, at most
  int pairs = 0;                 // more of them at most, where remainders are large
  double disk = 0.0;             // bytes at the same time: recordings and signals, pairs included

  double computing() const { return runs * run.computing; }         // s
  double computing_pairs() const { return pairs * run.computing; }  // s
};

/// @param run      of all cases
/// @param present  causes of the cases
/// @param budgets  number of quantities, of one case each
/// @pre there are cases
BudgetEstimate budget_estimate(const preparation::RunEstimate& run,
                               const std::map<std::string, Causes>& present, std::size_t budgets);

/// "14 runs, each 373 s of motion, ... computing; up to 21 runs more where remainders are large:
/// pairs of causes; 2 GB of disk space"
std::string to_string(const BudgetEstimate& estimate);

/// True above a minute of all runs or a gigabyte on the disk.
bool is_worth_telling(const BudgetEstimate& estimate);

}  // namespace servomill::sim::run
