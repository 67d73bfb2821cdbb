#include "tools/servomill/kept_cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/run/run_case.h"
#include "tools/servomill/interrupt.h"

namespace servomill::tools {

void KeptCases::in(const std::string& partial_path) {
  const std::scoped_lock lock(mutex_);
  partial_path_ = partial_path;
}

void KeptCases::add(const sim::run::CaseOutput& one) {
  const std::scoped_lock lock(mutex_);
  if (one.result.outcome.interrupted) return;
  std::erase(incomplete_, one.name);
  complete_.push_back(one.name);
}

bool KeptCases::all_complete() const {
  const std::scoped_lock lock(mutex_);
  return incomplete_.empty();
}

std::string KeptCases::said() const {
  const std::scoped_lock lock(mutex_);
  if (partial_path_.empty()) return {};
  std::string text = complete_.empty()
                         ? "no complete case"
                         : fmt::format("complete cases {}", fmt::join(complete_, ", "));
  if (!incomplete_.empty()) {
    text += fmt::format("; interrupted {}", fmt::join(incomplete_, ", "));
  }
  return kept_in(partial_path_, text);
}

}  // namespace servomill::tools
