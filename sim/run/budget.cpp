#include "sim/run/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <ranges>
#include <set>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/engine/case_result.h"
#include "sim/evaluation/path_signal.h"
#include "sim/evaluation/statistic.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/at_places.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"

namespace servomill::sim::run {
namespace {

using Runs = std::map<std::string, std::shared_ptr<const CaseOutput>>;  // by case

// The budgets of all quantities, filled run by run.
class BudgetRun {
 public:
  BudgetRun(const model::Scenario& scenario, std::span<const model::QuantitySpec> quantities,
            const BudgetControl& control)
      : scenario_(scenario),
        control_(control),
        store_(std::make_shared<records::SignalStore>(control.scratch_folder)) {
    scenario_.quantities.assign(quantities.begin(), quantities.end());
    scenario_.day.reset();  // no signal of a budget is of it
    scenario_.record.windows = {};
    const Causes all = all_causes();
    for (const model::QuantitySpec& quantity : quantities) {
      Budget budget;
      budget.quantity = quantity;
      for (std::size_t c = 0; c < kCauses; ++c) budget.parts[c].cause = static_cast<Cause>(c);
      budgets_.push_back(std::move(budget));
      for (const std::string& name : {quantity.cases.front(), quantity.baseline}) {
        if (name.empty() || present_.contains(name)) continue;
        present_[name] = present(all, scenario, *scenario.find_case(name));
      }
    }
    asked_ = present_;
  }

  std::vector<Budget> find() {
    const Runs complete = run({}, {}, {});
    if (stopped()) return {};
    for (Budget& budget : budgets_) start(budget, complete);
    // what adds to the signal
    const Causes steps = {Cause::measurement};
    const Runs smooth = run(steps, {}, complete);
    subtract(Cause::measurement, complete, smooth);
    Causes removed = steps;
    for (const Cause cause : kAdding) {
      subtract(cause, smooth, run({Cause::measurement, cause}, steps, smooth));
      removed.insert(cause);
    }
    // what it goes through, from behind
    Runs with = run(removed, steps, smooth);
    for (const Cause cause : kChain | std::views::reverse) {
      const Causes already = removed;
      removed.insert(cause);
      Runs less = run(removed, already, with);
      subtract(cause, with, less);
      with = std::move(less);
    }
    for (Budget& budget : budgets_) finish(budget, with);
    find_pairs(smooth);
    return stopped() ? std::vector<Budget>{} : std::move(budgets_);
  }

 private:
  bool stopped() const { return control_.stop != nullptr && *control_.stop; }

  // Runs the cases that have a cause to be removed which `former` has not removed already; the
  // others are those of `former`.
  Runs run(const Causes& removed, const Causes& already, const Runs& former) {
    Runs out = former;
    const model::Scenario changed = without(scenario_, removed, already, asked_);
    if (!changed.cases.empty() && !stopped()) {
      RunControl control;
      control.threads = control_.threads;
      control.stop = control_.stop;
      control.cache = &cache_;
      control.scratch_folder = control_.scratch_folder;
      if (removed.empty() && control_.prepared) {
        control.prepared = [this](const preparation::RunEstimate& takes) {
          control_.prepared(budget_estimate(takes, present_, budgets_.size()));
        };
      }
      for (CaseOutput& one : run_scenario(changed, control).cases) {
        const std::string name = one.name;
        out[name] = std::make_shared<const CaseOutput>(std::move(one));
      }
    }
    if (stage_ != nullptr) stage_->advance();
    return out;
  }

  // The residual of a run; none and why in the note of the budget, otherwise.
  static std::optional<evaluation::PathSignal> residual(Budget& budget, const Runs& runs,
                                                        const char* stops) {
    const model::QuantitySpec& quantity = budget.quantity;
    std::vector<evaluation::CaseData> compared;
    for (const std::string& name : {quantity.cases.front(), quantity.baseline}) {
      if (name.empty()) continue;
      const CaseOutput& one = *runs.at(name);
      const engine::Outcome& outcome = one.result.outcome;
      if (!outcome.finished) {
        budget.note = fmt::format("case {} {}: {}", name, stops, outcome.reason);
        return std::nullopt;
      }
      compared.push_back(one.data());
    }
    const evaluation::CaseData* base = compared.size() > 1 ? &compared.back() : nullptr;
    evaluation::PathSignal found(quantity, compared.front(), base);
    if (found.size() > 0) return found;
    budget.note = "no samples";
    return std::nullopt;
  }

  void start(Budget& budget, const Runs& complete) {
    auto signal = residual(budget, complete, "stopped");
    if (!signal) return;
    const std::size_t size = signal->size();
    for (records::StoredSignal* one : {&budget.s, &budget.turned, &budget.residual.signal}) {
      *one = records::StoredSignal(store_, size);
    }
    evaluation::Statistic rms("rms");
    evaluation::PathSample sample;
    for (std::size_t n = 0; signal->next(sample); ++n) {
      budget.s.append(sample.s);
      budget.turned.append(sample.turned);
      budget.residual.signal.append(sample.value);
      rms.add(sample.value);
      if (n > 0 && !(std::abs(budget.residual.at_place) < std::abs(sample.value))) continue;
      budget.place = n;
      budget.place_s = sample.s;
      budget.residual.at_place = sample.value;
    }
    budget.residual.rms = rms.value();
  }

  // The residual of a run without some causes, at the places of the budget.
  static std::optional<AtPlaces> at_places(Budget& budget, const Runs& runs) {
    auto signal = residual(budget, runs, "stops when a cause is removed");
    if (!signal) return std::nullopt;
    return AtPlaces(std::move(*signal), budget);
  }

  bool has(const Budget& budget, Cause cause) const {
    const std::string& base = budget.quantity.baseline;
    return present_.at(budget.quantity.cases.front()).contains(cause) ||
           (!base.empty() && present_.at(base).contains(cause));
  }

  // part = residual of `with` - residual of `less`
  void subtract(Cause cause, const Runs& with, const Runs& less) {
    for (Budget& budget : budgets_) {
      if (!budget.note.empty() || !has(budget, cause)) continue;
      auto one = at_places(budget, with), other = at_places(budget, less);
      if (!one || !other) continue;
      add(budget, cause, [&] { return one->next() - other->next(); });
    }
  }

  // Adds values, one a place, to what a cause has.
  template <class Next>
  void add(Budget& budget, Cause cause, Next next) const {
    BudgetPart& part = budget.parts[static_cast<std::size_t>(cause)];
    const records::StoredSignal before = part.signal;
    records::StoredSignal::Reader values(before);
    fill(budget, part, [&] { return (part.present ? values.next() : 0.0) + next(); });
    part.present = true;
  }

  template <class Next>
  void fill(const Budget& budget, BudgetSignal& signal, Next next) const {
    records::StoredSignal out(store_, budget.s.size());
    evaluation::Statistic rms("rms");
    for (std::size_t n = 0; n < budget.s.size(); ++n) {
      const double value = next();
      out.append(value);
      rms.add(value);
      if (n == budget.place) signal.at_place = value;
    }
    signal.signal = std::move(out);
    signal.rms = rms.value();
  }

  void finish(Budget& budget, const Runs& none) const {
    if (!budget.note.empty()) return;
    const model::QuantitySpec& quantity = budget.quantity;
    const auto rest = rest_of(quantity, *scenario_.find_case(quantity.cases.front()),
                              scenario_.find_case(quantity.baseline));
    if (rest) {
      auto left = at_places(budget, none);
      if (!left) return;
      add(budget, *rest, [&] { return left->next(); });
    }
    records::StoredSignal::Reader residual(budget.residual.signal);
    std::vector<records::StoredSignal::Reader> parts;
    for (const BudgetPart& part : budget.parts) {
      if (part.present) parts.emplace_back(part.signal);
    }
    fill(budget, budget.remainder, [&] {
      double left = residual.next();
      for (records::StoredSignal::Reader& part : parts) left -= part.next();
      return left;
    });
  }

  // Pairs of causes that make large remainders, by runs of the cases that have them alone.
  void find_pairs(const Runs& smooth) {
    stage_ = nullptr;
    asked_.clear();
    std::set<std::pair<Cause, Cause>> wanted;
    for (const Budget& budget : budgets_) {
      if (!budget.has_large_remainder()) continue;
      for (const std::string& name : {budget.quantity.cases.front(), budget.quantity.baseline}) {
        if (!name.empty()) asked_[name] = present_.at(name);
      }
      for (const auto& pair : pairs_of(budget)) wanted.insert(pair);
    }
    if (wanted.empty()) return;
    Stage stage("pairs of causes", static_cast<double>(wanted.size()));
    for (const auto& [a, b] : wanted) {
      if (stopped()) return;
      const Runs less = run({Cause::measurement, a, b}, {Cause::measurement}, smooth);
      for (Budget& budget : budgets_) {
        if (budget.has_large_remainder() && pairs_of(budget).contains({a, b})) {
          add_pair(budget, {a, b}, smooth, less);
        }
      }
      stage.advance();
    }
    for (Budget& budget : budgets_) sum_pairs(budget);
  }

  // Also of causes that have nothing alone: a limit that is not reached, say.
  static std::set<std::pair<Cause, Cause>> pairs_of(const Budget& budget) {
    std::set<std::pair<Cause, Cause>> out;
    const auto has = [&](Cause cause) {
      return budget.parts[static_cast<std::size_t>(cause)].present;
    };
    for (const Cause a : kAdding) {
      for (const Cause b : kAdding) {
        if (a < b && has(a) && has(b)) out.insert({a, b});
      }
    }
    return out;
  }

  // A run that stops without both says nothing of them.
  void add_pair(Budget& budget, std::array<Cause, 2> causes, const Runs& with,
                const Runs& less) const {
    auto one = at_places(budget, with), other = at_places(budget, less);
    budget.note.clear();
    if (!one || !other) return;
    BudgetPair pair;
    pair.causes = causes;
    const auto& parts = budget.parts;
    records::StoredSignal::Reader a(parts[static_cast<std::size_t>(causes[0])].signal);
    records::StoredSignal::Reader b(parts[static_cast<std::size_t>(causes[1])].signal);
    fill(budget, pair, [&] { return one->next() - other->next() - a.next() - b.next(); });
    budget.pairs.push_back(std::move(pair));
  }

  void sum_pairs(Budget& budget) const {
    if (budget.pairs.empty()) return;
    std::sort(budget.pairs.begin(), budget.pairs.end(),
              [](const BudgetPair& x, const BudgetPair& y) { return x.rms > y.rms; });
    records::StoredSignal::Reader remainder(budget.remainder.signal);
    std::vector<records::StoredSignal::Reader> pairs;
    for (const BudgetPair& pair : budget.pairs) pairs.emplace_back(pair.signal);
    fill(budget, budget.unexplained, [&] {
      double left = remainder.next();
      for (records::StoredSignal::Reader& pair : pairs) left -= pair.next();
      return left;
    });
    for (BudgetPart& part : budget.parts) {
      if (part.present) share_pairs(budget, part);
    }
  }

  // A cause with half of each of its pairs.
  void share_pairs(const Budget& budget, BudgetPart& part) const {
    constexpr double kHalf = 0.5;
    records::StoredSignal::Reader alone(part.signal);
    std::vector<records::StoredSignal::Reader> pairs;
    for (const BudgetPair& pair : budget.pairs) {
      if (pair.causes[0] == part.cause || pair.causes[1] == part.cause) {
        pairs.emplace_back(pair.signal);
      }
    }
    fill(budget, part.share, [&] {
      double value = alone.next();
      for (records::StoredSignal::Reader& pair : pairs) value += kHalf * pair.next();
      return value;
    });
  }

  // complete, without measurement, each that adds, all of these, each of the chain
  static constexpr double kRuns = 3.0 + std::size(kAdding) + std::size(kChain);

  model::Scenario scenario_;
  const BudgetControl& control_;
  preparation::PreparationCache cache_;
  std::shared_ptr<records::SignalStore> store_;
  std::map<std::string, Causes> present_;  // by case
  std::map<std::string, Causes> asked_;    // those of the cases that are run
  std::vector<Budget> budgets_;
  Stage runs_{"runs", kRuns};
  Stage* stage_ = &runs_;
};

}  // namespace

std::vector<Budget> find_budgets(const model::Scenario& scenario,
                                 std::span<const model::QuantitySpec> quantities,
                                 const BudgetControl& control) {
  return BudgetRun(scenario, quantities, control).find();
}

bool Budget::has_large_remainder() const {
  constexpr double kShare = 0.1, kSmallest = 0.05;  // of the residual; um
  return note.empty() && remainder.rms > std::max(kShare * residual.rms, kSmallest);
}

namespace {

// Sum of the present parts of a group; which of their values, the caller says.
template <class ValueOf>
std::optional<double> sum_of_group(const Budget& budget, CauseGroup group, ValueOf value_of) {
  std::optional<double> sum;
  for (const BudgetPart& part : budget.parts) {
    if (part.present && info_of(part.cause).group == group) {
      sum = sum.value_or(0.0) + value_of(part);
    }
  }
  return sum;
}

}  // namespace

std::optional<double> Budget::group_at_place(CauseGroup group) const {
  return sum_of_group(*this, group, [](const BudgetPart& part) { return part.at_place; });
}

std::optional<double> Budget::group_share_at_place(CauseGroup group) const {
  return sum_of_group(*this, group, [](const BudgetPart& part) { return part.share.at_place; });
}

}  // namespace servomill::sim::run
