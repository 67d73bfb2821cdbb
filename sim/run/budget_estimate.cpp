#include "sim/run/budget_estimate.h"

#include <fmt/format.h>

#include <algorithm>

namespace servomill::sim::run {
namespace {

// Recordings on the disk at the same time: complete, without measurement, of the step before and of
// this one.
constexpr double kRecordings = 4.0;

double pairs_among(std::size_t causes) {
  return 0.5 * static_cast<double>(causes) * (static_cast<double>(causes) - 1.0);
}

}  // namespace

BudgetEstimate budget_estimate(const preparation::RunEstimate& run,
                               const std::map<std::string, Causes>& present, std::size_t budgets) {
  Causes all;
  for (const auto& [name, causes] : present) all.insert(causes.begin(), causes.end());
  const auto has = [&](Cause cause) { return all.contains(cause) ? 1 : 0; };
  std::size_t adding = 0;
  for (const Cause cause : kAdding) adding += static_cast<std::size_t>(has(cause));
  BudgetEstimate out{.run = run};
  const int together = adding > 1 ? 1 : 0;  // what adds, all taken away
  out.runs = 1 + has(Cause::measurement) + static_cast<int>(adding) + together;
  for (const Cause cause : kChain) out.runs += has(cause);
  const double pairs = pairs_among(adding);
  out.pairs = static_cast<int>(pairs);
  // s, turns, residual, remainder, what pairs leave; parts and shares; pairs
  constexpr double kOfBudget = 5.0;
  const double signals = kOfBudget + 2.0 * static_cast<double>(all.size() + 1) + pairs;
  const double columns = run.rows > 0.0 ? run.size / (run.rows * sizeof(double)) : 1.0;
  const double of_case = run.file / static_cast<double>(present.size());
  out.disk = kRecordings * run.file + static_cast<double>(budgets) * of_case * signals / columns;
  return out;
}

std::string to_string(const BudgetEstimate& estimate) {
  constexpr double kGigabyte = 1e9;
  std::string text =
      fmt::format("{} runs, each {}", estimate.runs, preparation::to_string(estimate.run));
  if (estimate.pairs > 0) {
    text += fmt::format("; up to {} runs more, of pairs of causes, where remainders are large",
                        estimate.pairs);
  }
  return text + fmt::format("; {:.2g} GB of disk space while running", estimate.disk / kGigabyte);
}

bool is_worth_telling(const BudgetEstimate& estimate) {
  constexpr double kMinute = 60.0, kGigabyte = 1e9;
  return estimate.computing() + estimate.computing_pairs() > kMinute || estimate.disk > kGigabyte;
}

}  // namespace servomill::sim::run
