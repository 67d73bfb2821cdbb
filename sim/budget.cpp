#include "sim/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/preparation_cache.h"

namespace servomill::sim {
namespace {

constexpr std::array<CauseInfo, kCauses> kInfos = {{
    {"lag", "servo loops and drives follow late"},
    {"table", "points and form of compensation tables"},
    {"delay", "response and update of tables, signal delay, model period"},
    {"saturation", "limits of virtual displacements"},
    {"one_step", "errors evaluated at a displaced position"},
    {"identification", "believed errors, or origin, are not the true ones"},
    {"friction", "dry friction, backlash, cogging, and their compensation"},
    {"measurement", "encoders and, where the motor is read, screws"},
    {"cutting", "forces of the cut"},
    {"interpolation", "chords, path tolerance and filter of the NC"},
    {"kinematics", "what is left without all others"},
}};

constexpr double kFine = 0.01;        // share of tolerances that are taken away
constexpr double kLeastChord = 1e-9;  // m
constexpr double kOutOfReach = 1e3;   // m, rad and these per s

using Causes = std::set<Cause>;
const Causes kThroughLoops = {Cause::friction, Cause::measurement, Cause::cutting, Cause::delay};

MachineSettings& own_machine(const Scenario& scenario, CaseSpec& one) {
  if (!one.machine) one.machine = scenario.machine;
  return *one.machine;
}

// Sets a parameter; whether it had another value.
bool set(Parameters& parameters, std::string_view name, std::string_view word) {
  if (parameters.is_word(name) && parameters.word(name) == word) return false;
  parameters.set(name, word);
  return true;
}
bool set(Parameters& parameters, std::string_view name, double value) {
  if (parameters.number(name) == value) return false;
  parameters.set(name, value);
  return true;
}

bool remove_friction(MachineSettings& machine) {
  bool any = false;
  for (const int joint : machine.joints()) {
    const auto j = static_cast<std::size_t>(joint);
    plant::FeedDriveParams& drive = machine.drives[j];
    AxisFunctions& functions = machine.nc.functions[j];
    any |=
        !drive.is_linear() || functions.friction.compensates() || functions.backlash.width != 0.0;
    drive.friction = {};
    drive.gap = 0.0;
    drive.cogging = {};
    functions.friction = {};
    functions.backlash = {};
  }
  return any;
}

bool remove_measurement(MachineSettings& machine) {
  bool any = false;
  for (const int joint : machine.joints()) {
    const auto j = static_cast<std::size_t>(joint);
    for (plant::Encoder* encoder : {&machine.scale[j], &machine.motor[j]}) {
      any |= !encoder->is_plain() || encoder->step() > 0.0;
      *encoder = {};
    }
    any |= machine.marks[j].has_value() || !machine.screw[j].is_zero();
    machine.marks[j].reset();
    machine.screw[j] = {};
  }
  return any;
}

bool remove_delay(Scenario& scenario, CaseSpec& one) {
  constexpr Tick kNone = 0, kLeast = 1;
  const bool has_feedback = one.has_feedback();
  MachineSettings& machine = own_machine(scenario, one);
  bool any = machine.scale_delay != kNone ||
             (one.feedback_hardware && scenario.hardware.signal_delay != kNone) ||
             (has_feedback && scenario.hardware.model_period != kLeast);
  machine.scale_delay = kNone;
  for (StrategySpec& strategy : one.strategies) {
    if (strategy.entry->name != "table") continue;
    for (const char* key : {"response_time_ms", "dead_time_ms", "update_period_ms"}) {
      any |= set(strategy.parameters, key, 0.0);
    }
  }
  return any;
}

bool remove_saturation(CaseSpec& one) {
  bool any = false;
  for (StrategySpec& strategy : one.strategies) {
    if (strategy.entry->name != "feedback") continue;
    for (const char* key : {"max_um", "max_rate_mm_per_s", "max_mrad", "max_rate_mrad_per_s"}) {
      any |= set(strategy.parameters, key, kOutOfReach);
    }
  }
  return any;
}

// Cases know forces of the cut only where there is a model of them.
template <class Case>
bool remove_cutting(Case& one) {
  if constexpr (requires { one.cutting; }) {
    return std::exchange(one.cutting, false);
  } else {
    return false;
  }
}

// A word of a parameter, in all strategies that know it.
bool set_word(CaseSpec& one, std::string_view name, std::string_view word) {
  bool any = false;
  for (StrategySpec& strategy : one.strategies) {
    const auto known =
        std::any_of(strategy.entry->parameters.begin(), strategy.entry->parameters.end(),
                    [&](const ParameterSpec& spec) { return spec.name == name; });
    if (known) any |= set(strategy.parameters, name, word);
  }
  return any;
}

bool remove_identification(const Scenario& scenario, CaseSpec& one) {
  bool any = set_word(one, "rewritten_for", "case");
  const std::string& truth = one.truth ? *one.truth : scenario.truth;
  for (StrategySpec& strategy : one.strategies) {
    if (!strategy.entry->reads_errors) continue;
    const bool corrects_truth = strategy.sign == strategies::Sign::correct && !truth.empty();
    const std::string& right = corrects_truth ? truth : scenario.imposed;
    if (right.empty() || strategy.model == right) continue;
    strategy.model = right;
    any = true;
  }
  return any;
}

bool remove_interpolation(const Scenario& scenario, CaseSpec& one) {
  NcSettings& nc = own_machine(scenario, one).nc;
  nc.path_tolerance *= kFine;
  nc.rotary_tolerance *= kFine;
  nc.tolerance_share *= kFine;
  nc.filter = {};
  nc.block_time = 0.0;
  for (StrategySpec& strategy : one.strategies) {
    if (strategy.entry->name != "gcode") continue;
    Parameters& p = strategy.parameters;
    p.set("tolerance_um", std::max(kLeastChord, kFine * p.number("tolerance_um")));
    p.set("tolerance_urad", std::max(kLeastChord, kFine * p.number("tolerance_urad")));
  }
  return true;  // there is always a tolerance
}

// Takes a cause away from a case, but for what is the scenario's; whether it had it.
bool remove(Cause cause, Scenario& scenario, CaseSpec& one) {
  switch (cause) {
    case Cause::lag: {
      const bool had = one.servo != ServoModel::ideal;
      one.servo = ServoModel::ideal;
      return had;
    }
    case Cause::table:
      return set_word(one, "form", "exact");
    case Cause::delay:
      return remove_delay(scenario, one);
    case Cause::saturation:
      return remove_saturation(one);
    case Cause::one_step:
      return set_word(one, "iterations", "converged");
    case Cause::identification:
      return remove_identification(scenario, one);
    case Cause::friction:
      return remove_friction(own_machine(scenario, one));
    case Cause::measurement:
      return remove_measurement(own_machine(scenario, one));
    case Cause::cutting:
      return remove_cutting(one);
    case Cause::interpolation:
      return remove_interpolation(scenario, one);
    case Cause::kinematics:
      break;
  }
  return false;
}

Causes without_kinematics() {
  Causes out;
  for (std::size_t c = 0; c < kCauses; ++c) out.insert(static_cast<Cause>(c));
  out.erase(Cause::kinematics);
  return out;
}

// Of these, what a case has. An ideal servo has nothing that goes through loops.
Causes present(const Causes& causes, const Scenario& scenario, const CaseSpec& one) {
  Causes out;
  for (const Cause cause : causes) {
    Scenario trial = scenario;
    CaseSpec spec = one;
    if (remove(cause, trial, spec)) out.insert(cause);
  }
  if (one.servo == ServoModel::ideal) {
    for (const Cause cause : {Cause::friction, Cause::measurement}) out.erase(cause);
  }
  return out;
}

// The cases that a variation changes, changed; the others are as they were.
// @param already  causes that are taken away of a run that is known: alone, they make no other one
Scenario without(const Scenario& scenario, const Causes& removed, const Causes& already,
                 const std::map<std::string, Causes>& present_in) {
  Scenario out = scenario;
  out.quantities.clear();
  out.cases.clear();
  for (const CaseSpec& one : scenario.cases) {
    const auto found = present_in.find(one.name);
    if (found == present_in.end()) continue;  // nobody asks for it
    CaseSpec changed = one;
    bool any = removed.empty();
    for (const Cause cause : removed) {
      if (!found->second.contains(cause)) continue;
      remove(cause, out, changed);
      any |= !already.contains(cause);
    }
    if (any) out.cases.push_back(std::move(changed));
  }
  if (removed.contains(Cause::delay)) {  // of the scenario, hence after the cases were asked
    out.hardware.signal_delay = 0;
    out.hardware.model_period = 1;
  }
  return out;
}

const CaseOutput* find(const RunOutput& run, const std::string& name) {
  const auto found = std::find_if(run.cases.begin(), run.cases.end(),
                                  [&](const CaseOutput& one) { return one.name == name; });
  return found == run.cases.end() ? nullptr : &*found;
}

// Values of a signal at other places; constant beyond its ends.
std::vector<double> at_places(const PathSignal& signal, const std::vector<double>& s) {
  std::vector<double> out;
  out.reserve(s.size());
  std::size_t k = 0;
  const std::size_t last = signal.s.size() - 1;
  for (const double at : s) {
    while (k < last && signal.s[k + 1] <= at) ++k;
    if (k == last || at <= signal.s[k]) {
      out.push_back(signal.value[k]);
      continue;
    }
    const double share = (at - signal.s[k]) / (signal.s[k + 1] - signal.s[k]);
    out.push_back(signal.value[k] + share * (signal.value[k + 1] - signal.value[k]));
  }
  return out;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

// The budgets of all quantities, filled run by run.
class Accounts {
 public:
  Accounts(const Scenario& scenario, std::span<const QuantitySpec> quantities,
           const BudgetControl& control)
      : scenario_(scenario), control_(control) {
    const Causes all = without_kinematics();
    for (const QuantitySpec& quantity : quantities) {
      Budget budget;
      budget.quantity = quantity;
      for (std::size_t c = 0; c < kCauses; ++c) budget.parts[c].cause = static_cast<Cause>(c);
      budgets_.push_back(std::move(budget));
      for (const std::string& name : {quantity.cases.front(), quantity.base}) {
        if (name.empty() || present_.contains(name)) continue;
        present_[name] = present(all, scenario, *scenario.find_case(name));
      }
    }
  }

  std::vector<Budget> find() {
    const Causes all = without_kinematics();
    total_ = static_cast<double>(all.size() + 2);
    if (!run_complete()) return {};
    const Causes steps = {Cause::measurement};
    RunOutput smooth;
    if (!run(steps, {}, smooth)) return {};
    subtract(Cause::measurement, complete_, smooth);
    for (const Cause cause : all) {
      if (cause == Cause::lag || cause == Cause::measurement) continue;
      if (!take_away(cause, steps, smooth)) return {};
    }
    // the lag, of loops through which nothing else acts
    RunOutput loops;
    if (!run(kThroughLoops, steps, loops)) return {};
    add_missing(loops, smooth);
    if (!take_away(Cause::lag, kThroughLoops, loops)) return {};
    // what is left
    RunOutput none;
    if (!run(all, {}, none)) return {};
    for (Budget& budget : budgets_) {
      if (!budget.note.empty()) continue;
      take(budget, Cause::kinematics, signal(budget, none, complete_), true);
    }
    for (Budget& budget : budgets_) close(budget);
    return std::move(budgets_);
  }

 private:
  // Runs the cases that have a cause to be removed which another run has not removed already.
  bool run(const Causes& removed, const Causes& already, RunOutput& out) {
    const Scenario changed = without(scenario_, removed, already, present_);
    if (!changed.cases.empty()) {
      RunControl control;
      control.threads = control_.threads;
      control.stop = control_.stop;
      control.cache = &cache_;
      control.progress = [&](double share) {
        if (control_.progress) control_.progress((runs_ + share) / total_);
      };
      out = run_scenario(changed, control);
    }
    runs_ += 1.0;
    return control_.stop == nullptr || !*control_.stop;
  }

  // Cases that a run did not change, as another one has them.
  static void add_missing(RunOutput& run, const RunOutput& other) {
    for (const CaseOutput& one : other.cases) {
      if (sim::find(run, one.name) == nullptr) run.cases.push_back(one);
    }
  }

  bool run_complete() {
    if (!run({}, {}, complete_)) return false;
    for (Budget& budget : budgets_) {
      const auto of_case = outputs(budget, complete_, complete_);
      for (const CaseOutput* one : {of_case.first, of_case.second}) {
        if (one == nullptr || one->result.outcome.finished || !budget.note.empty()) continue;
        budget.note = fmt::format("case {} stopped: {}", one->name, one->result.outcome.reason);
      }
      if (!budget.note.empty()) continue;
      const CaseData one = of_case.first->data();
      const std::optional<CaseData> base = data_of(of_case.second);
      PathSignal residual = path_signal(budget.quantity, one, base ? &*base : nullptr);
      if (residual.value.empty()) {
        budget.note = "no samples";
        continue;
      }
      budget.s = std::move(residual.s);
      budget.residual = std::move(residual.value);
      const auto largest =
          std::max_element(budget.residual.begin(), budget.residual.end(),
                           [](double a, double b) { return std::abs(a) < std::abs(b); });
      budget.place = static_cast<std::size_t>(largest - budget.residual.begin());
    }
    return true;
  }

  // The case and the one that it is compared with: of a run, or of another one where the run did
  // not change it.
  std::pair<const CaseOutput*, const CaseOutput*> outputs(const Budget& budget,
                                                          const RunOutput& run,
                                                          const RunOutput& unchanged) const {
    const auto one = [&](const std::string& name) -> const CaseOutput* {
      if (name.empty()) return nullptr;
      const CaseOutput* changed = sim::find(run, name);
      if (changed != nullptr) return changed;
      const CaseOutput* as_before = sim::find(unchanged, name);
      return as_before != nullptr ? as_before : sim::find(complete_, name);
    };
    return {one(budget.quantity.cases.front()), one(budget.quantity.base)};
  }

  static std::optional<CaseData> data_of(const CaseOutput* one) {
    if (one == nullptr) return std::nullopt;
    return one->data();
  }

  // The residual of a run at the places of the budget; with a note if there is none.
  std::vector<double> signal(Budget& budget, const RunOutput& run, const RunOutput& unchanged) {
    const auto [one, base] = outputs(budget, run, unchanged);
    for (const CaseOutput* output : {one, base}) {
      if (output == nullptr || output->result.outcome.finished) continue;
      budget.note = fmt::format("case {} stops where a cause is taken away: {}", output->name,
                                output->result.outcome.reason);
      return {};
    }
    const CaseData data = one->data();
    const std::optional<CaseData> of_base = data_of(base);
    const PathSignal found = path_signal(budget.quantity, data, of_base ? &*of_base : nullptr);
    if (found.value.empty()) {
      budget.note = "no samples where a cause is taken away";
      return {};
    }
    return at_places(found, budget.s);
  }

  bool has(const Budget& budget, Cause cause) const {
    const std::string& base = budget.quantity.base;
    return present_.at(budget.quantity.cases.front()).contains(cause) ||
           (!base.empty() && present_.at(base).contains(cause));
  }

  // part = residual of `with` - residual of `less`
  void subtract(Cause cause, const RunOutput& with, const RunOutput& less) {
    for (Budget& budget : budgets_) {
      if (!budget.note.empty() || !has(budget, cause)) continue;
      std::vector<double> part = signal(budget, with, complete_);
      const std::vector<double> left = signal(budget, less, with);
      if (!budget.note.empty()) continue;
      for (std::size_t n = 0; n < part.size(); ++n) part[n] -= left[n];
      take(budget, cause, std::move(part), true);
    }
  }

  // A cause, from a run without others; false if stopped.
  bool take_away(Cause cause, Causes removed, const RunOutput& with) {
    const bool any = std::any_of(budgets_.begin(), budgets_.end(),
                                 [&](const Budget& budget) { return has(budget, cause); });
    if (!any) {
      runs_ += 1.0;
      return true;
    }
    const Causes already = removed;
    removed.insert(cause);
    RunOutput less;
    if (!run(removed, already, less)) return false;
    subtract(cause, with, less);
    return true;
  }

  static void take(Budget& budget, Cause cause, std::vector<double> signal, bool present) {
    if (!budget.note.empty()) return;
    BudgetPart& part = budget.parts[static_cast<std::size_t>(cause)];
    part.present = present;
    part.at_place = signal.at(budget.place);
    part.rms = rms(signal);
    part.signal = std::move(signal);
  }

  static void close(Budget& budget) {
    if (!budget.note.empty()) return;
    budget.remainder = budget.residual;
    for (BudgetPart& part : budget.parts) {
      part.signal.resize(budget.s.size(), 0.0);
      for (std::size_t n = 0; n < budget.s.size(); ++n) budget.remainder[n] -= part.signal[n];
    }
    budget.remainder_rms = rms(budget.remainder);
  }

  const Scenario& scenario_;
  const BudgetControl& control_;
  PreparationCache cache_;
  std::map<std::string, Causes> present_;  // by case
  RunOutput complete_;
  std::vector<Budget> budgets_;
  double runs_ = 0.0, total_ = 1.0;
};

}  // namespace

const CauseInfo& info_of(Cause cause) { return kInfos[static_cast<std::size_t>(cause)]; }

double Budget::residual_rms() const { return rms(residual); }

std::vector<QuantitySpec> budget_quantities(const Scenario& scenario) {
  std::vector<QuantitySpec> out;
  for (const QuantitySpec& asked : scenario.quantities) {
    QuantitySpec one = asked;
    if (one.name == "brought_out" || one.name == "response_time") {
      one.name = "imposed_curve_residual";
    }
    if (!has_path_signal(one.name)) continue;
    one.statistic = "max";
    one.reference.clear();
    one.kind.clear();
    for (const std::string& name : asked.cases) {
      one.cases = {name};
      const bool known = std::any_of(out.begin(), out.end(), [&](const QuantitySpec& other) {
        return other.name == one.name && other.axis == one.axis && other.base == one.base &&
               other.sections == one.sections && other.cases == one.cases;
      });
      if (!known) out.push_back(one);
    }
  }
  return out;
}

std::vector<Budget> find_budgets(const Scenario& scenario, std::span<const QuantitySpec> quantities,
                                 const BudgetControl& control) {
  return Accounts(scenario, quantities, control).find();
}

}  // namespace servomill::sim
