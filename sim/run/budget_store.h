/// Error budgets on disk, for figures and other programs.
#pragma once

#include <cstddef>
#include <string>

#include "sim/model/forward.h"
#include "sim/records/output_file.h"
#include "sim/run/budget.h"

namespace servomill::sim::run {

/// A file of the kind "budget": /budget/NNN with s, residual, remainder and one signal for each
/// cause that the case has; attributes case, quantity, axis, sections, base, place, and of each
/// signal at_place and rms. Where pairs of causes were looked for: /budget/NNN/pairs with one
/// signal a pair ("friction_with_cutting") and unexplained, and /budget/NNN/shares with each cause
/// and half of its pairs, and the remainder of these.
/// @throws InputError if the file cannot be had under that name, SystemError
class BudgetStore {
 public:
  BudgetStore(const std::string& path, bool force, const model::Scenario& scenario);
  void add(const Budget& budget);
  void commit() { file_.commit(); }

 private:
  records::OutputFile file_;
  std::size_t count_ = 0;
};

}  // namespace servomill::sim::run
