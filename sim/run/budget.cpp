#include "sim/run/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <ranges>
#include <set>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/evaluation/path_quantities.h"
#include "sim/preparation/preparation_cache.h"

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
    {"uncorrected", "errors that no strategy of the case corrects, or brings out"},
    {"uncorrectable", "what the axes of the strategies cannot do"},
    {"imposed", "what strategies bring out on purpose"},
}};

constexpr double kFine = 0.01;        // share of tolerances that are taken away
constexpr double kLeastChord = 1e-9;  // m

using Causes = std::set<Cause>;
// What the signal goes through, in this order.
constexpr std::array kChain = {Cause::interpolation, Cause::lag, Cause::delay};
// What adds to it, beside measurement.
constexpr std::array kAdding = {Cause::table,          Cause::saturation, Cause::one_step,
                                Cause::identification, Cause::friction,   Cause::cutting,
                                Cause::uncorrected};

MachineSettings& own_machine(const Scenario& scenario, CaseSpec& one) {
  if (!one.machine) one.machine = scenario.machine;
  return *one.machine;
}

// Sets a parameter to its ideal; whether it had another value.
bool idealise(const ParameterSpec& spec, Parameters& parameters) {
  const bool is_word =
      std::find(spec.words.begin(), spec.words.end(), spec.ideal) != spec.words.end();
  if (is_word) {
    if (parameters.is_word(spec.name) && parameters.word(spec.name) == spec.ideal) return false;
    parameters.set(spec.name, spec.ideal);
    return true;
  }
  const ParsedUnit unit = parse_unit(spec.unit);
  const double ideal = std::stod(std::string(spec.ideal)) * (unit.unit ? unit.unit->factor : 1.0);
  if (!parameters.is_word(spec.name) && parameters.number(spec.name) == ideal) return false;
  parameters.set(spec.name, ideal);
  return true;
}

// Takes a shortcoming away from all strategies that have it; whether any had.
bool idealise(CaseSpec& one, Shortcoming shortcoming) {
  bool any = false;
  for (StrategySpec& strategy : one.strategies) {
    for (const ParameterSpec& spec : strategy.entry->parameters) {
      if (spec.shortcoming != shortcoming || spec.ideal.empty()) continue;
      any |= idealise(spec, strategy.parameters);
    }
  }
  return any;
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
  const bool needs_hardware = one.needs_feedback_hardware();
  MachineSettings& machine = own_machine(scenario, one);
  bool any = machine.scale_delay != kNone ||
             (one.feedback_hardware && scenario.hardware.signal_delay != kNone) ||
             (needs_hardware && scenario.hardware.model_period != kLeast);
  machine.scale_delay = kNone;
  any |= idealise(one, Shortcoming::delay);
  return any;
}

const std::string& truth_of(const Scenario& scenario, const CaseSpec& one) {
  return one.truth ? *one.truth : scenario.truth;
}

// Whether strategies of a case know errors, to correct or to generate them.
bool has_strategy(const CaseSpec& one, strategies::Sign sign) {
  return std::any_of(one.strategies.begin(), one.strategies.end(), [&](const StrategySpec& spec) {
    return spec.entry->reads_errors && spec.sign == sign;
  });
}

bool remove_identification(const Scenario& scenario, CaseSpec& one) {
  bool any = idealise(one, Shortcoming::identification);
  const std::string& truth = truth_of(scenario, one);
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

bool remove_uncorrected(const Scenario& scenario, CaseSpec& one) {
  if (truth_of(scenario, one).empty() || has_strategy(one, strategies::Sign::correct)) return false;
  one.truth = "";
  return true;
}

bool remove_interpolation(const Scenario& scenario, CaseSpec& one) {
  NcSettings& nc = own_machine(scenario, one).nc;
  nc.path_tolerance *= kFine;
  nc.rotary_tolerance *= kFine;
  nc.tolerance_share *= kFine;
  nc.filter = {};
  nc.block_time = 0.0;
  for (StrategySpec& strategy : one.strategies) {
    for (const ParameterSpec& spec : strategy.entry->parameters) {
      if (spec.shortcoming != Shortcoming::chord_tolerance) continue;
      Parameters& p = strategy.parameters;
      p.set(spec.name, std::max(kLeastChord, kFine * p.number(spec.name)));
    }
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
      return idealise(one, Shortcoming::points);
    case Cause::delay:
      return remove_delay(scenario, one);
    case Cause::saturation:
      return idealise(one, Shortcoming::saturation);
    case Cause::one_step:
      return idealise(one, Shortcoming::one_step);
    case Cause::identification:
      return remove_identification(scenario, one);
    case Cause::friction:
      return remove_friction(own_machine(scenario, one));
    case Cause::measurement:
      return remove_measurement(own_machine(scenario, one));
    case Cause::cutting:
      return std::exchange(one.cutting, false);
    case Cause::interpolation:
      return remove_interpolation(scenario, one);
    case Cause::uncorrected:
      return remove_uncorrected(scenario, one);
    case Cause::uncorrectable:
    case Cause::imposed:
      break;
  }
  return false;
}

// All that can be removed.
Causes all_causes() {
  Causes out = {Cause::measurement};
  out.insert(kAdding.begin(), kAdding.end());
  out.insert(kChain.begin(), kChain.end());
  return out;
}

// Whether strategies of a case move the tool where the program does not want it.
bool moves_on_purpose(const CaseSpec& one) {
  return has_strategy(one, strategies::Sign::generate) ||
         std::any_of(one.strategies.begin(), one.strategies.end(), [](const StrategySpec& spec) {
           return !spec.entry->reads_errors && spec.entry->acts;
         });
}

// What stays without all others; none of what begins behind the strategies.
// @param base  the case it is compared with, or nullptr
std::optional<Cause> rest_of(const QuantitySpec& quantity, const CaseSpec& one,
                             const CaseSpec* base) {
  if (quantity.name == "following_error") return std::nullopt;
  const auto any = [&](auto fact) { return fact(one) || (base != nullptr && fact(*base)); };
  const bool takes_imposed_off = quantity.name == "imposed_curve_residual";
  if (any(moves_on_purpose) && !takes_imposed_off) return Cause::imposed;
  const bool knows_errors = any([](const CaseSpec& spec) {
    return has_strategy(spec, strategies::Sign::generate) ||
           has_strategy(spec, strategies::Sign::correct);
  });
  if (knows_errors) return Cause::uncorrectable;
  if (takes_imposed_off) return Cause::uncorrected;
  return std::nullopt;
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

// The cases that have a cause to be removed that another run has not removed already, without it.
Scenario without(const Scenario& scenario, const Causes& removed, const Causes& already,
                 const std::map<std::string, Causes>& present_in) {
  Scenario out = scenario;
  if (!removed.empty()) {  // the first run has checked them; signals along the path need no part
    out.quantities.clear();
    out.probes.clear();
    out.part.reset();
  }
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

// Values of a signal at the places of a budget; constant beyond its ends.
std::vector<double> at_places(const PathSignal& signal, const Budget& places) {
  const auto key = [](double s) { return std::round(s * 1e6); };  // nm: cases differ by rounding
  const auto is_behind = [&](std::size_t k, std::size_t n) {
    return std::pair(key(signal.s[k]), signal.turned[k]) >
           std::pair(key(places.s[n]), places.turned[n]);
  };
  std::vector<double> out;
  out.reserve(places.s.size());
  std::size_t k = 0;
  const std::size_t last = signal.s.size() - 1;
  for (std::size_t n = 0; n < places.s.size(); ++n) {
    while (k < last && !is_behind(k + 1, n)) ++k;
    if (k == last || is_behind(k, n)) {
      out.push_back(signal.value[k]);
      continue;
    }
    const bool moves = key(signal.s[k + 1]) > key(signal.s[k]);
    const std::vector<double>& from = moves ? signal.s : signal.turned;
    const double at = moves ? places.s[n] : places.turned[n];
    const double share = (at - from[k]) / (from[k + 1] - from[k]);
    out.push_back(signal.value[k] + share * (signal.value[k + 1] - signal.value[k]));
  }
  return out;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

using Runs = std::map<std::string, std::shared_ptr<const CaseOutput>>;  // by case

// The budgets of all quantities, filled run by run.
class Accounts {
 public:
  Accounts(const Scenario& scenario, std::span<const QuantitySpec> quantities,
           const BudgetControl& control)
      : scenario_(scenario), control_(control) {
    scenario_.quantities.assign(quantities.begin(), quantities.end());
    const Causes all = all_causes();
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
    return stopped() ? std::vector<Budget>{} : std::move(budgets_);
  }

 private:
  bool stopped() const { return control_.stop != nullptr && *control_.stop; }

  // Runs the cases that have a cause to be removed which `former` has not removed already; the
  // others are those of `former`.
  Runs run(const Causes& removed, const Causes& already, const Runs& former) {
    Runs out = former;
    const Scenario changed = without(scenario_, removed, already, present_);
    if (!changed.cases.empty() && !stopped()) {
      RunControl control;
      control.threads = control_.threads;
      control.stop = control_.stop;
      control.cache = &cache_;
      control.scratch_folder = control_.scratch_folder;
      if (removed.empty()) control.prepared = control_.prepared;
      control.progress = [&](double share) {
        if (control_.progress) control_.progress((runs_ + share) / kRuns);
      };
      for (CaseOutput& one : run_scenario(changed, control).cases) {
        const std::string name = one.name;
        out[name] = std::make_shared<const CaseOutput>(std::move(one));
      }
    }
    runs_ += 1.0;
    return out;
  }

  // The residual of a run; why there is none, otherwise.
  static std::pair<PathSignal, std::string> residual(const Budget& budget, const Runs& runs,
                                                     const char* stops) {
    const QuantitySpec& quantity = budget.quantity;
    std::vector<CaseData> compared;
    for (const std::string& name : {quantity.cases.front(), quantity.base}) {
      if (name.empty()) continue;
      const CaseOutput& one = *runs.at(name);
      const Outcome& outcome = one.result.outcome;
      if (!outcome.finished) {
        return {{}, fmt::format("case {} {}: {}", name, stops, outcome.reason)};
      }
      compared.push_back(one.data());
    }
    const CaseData* base = compared.size() > 1 ? &compared.back() : nullptr;
    PathSignal found = path_signal(quantity, compared.front(), base);
    if (found.value.empty()) return {{}, "no samples"};
    return {std::move(found), ""};
  }

  static void start(Budget& budget, const Runs& complete) {
    auto [signal, why_not] = residual(budget, complete, "stopped");
    budget.note = std::move(why_not);
    if (!budget.note.empty()) return;
    budget.s = signal.s;
    budget.residual = std::move(signal.value);
    const auto largest =
        std::max_element(budget.residual.begin(), budget.residual.end(),
                         [](double a, double b) { return std::abs(a) < std::abs(b); });
    budget.place = static_cast<std::size_t>(largest - budget.residual.begin());
    budget.turned = std::move(signal.turned);
    for (BudgetPart& part : budget.parts) part.signal.assign(budget.s.size(), 0.0);
  }

  // The residual of a run without some causes, at the places of the budget.
  static std::vector<double> signal(Budget& budget, const Runs& runs) {
    auto [found, why_not] = residual(budget, runs, "stops where a cause is taken away");
    if (!why_not.empty()) {
      budget.note = std::move(why_not);
      return {};
    }
    return at_places(found, budget);
  }

  bool has(const Budget& budget, Cause cause) const {
    const std::string& base = budget.quantity.base;
    return present_.at(budget.quantity.cases.front()).contains(cause) ||
           (!base.empty() && present_.at(base).contains(cause));
  }

  // part = residual of `with` - residual of `less`
  void subtract(Cause cause, const Runs& with, const Runs& less) {
    for (Budget& budget : budgets_) {
      if (!budget.note.empty() || !has(budget, cause)) continue;
      std::vector<double> part = signal(budget, with);
      const std::vector<double> left = signal(budget, less);
      if (!budget.note.empty()) continue;
      for (std::size_t n = 0; n < part.size(); ++n) part[n] -= left[n];
      add(budget, cause, part);
    }
  }

  static void add(Budget& budget, Cause cause, const std::vector<double>& signal) {
    BudgetPart& part = budget.parts[static_cast<std::size_t>(cause)];
    part.present = true;
    for (std::size_t n = 0; n < signal.size(); ++n) part.signal[n] += signal[n];
  }

  void finish(Budget& budget, const Runs& none) const {
    if (!budget.note.empty()) return;
    const QuantitySpec& quantity = budget.quantity;
    const auto rest = rest_of(quantity, *scenario_.find_case(quantity.cases.front()),
                              scenario_.find_case(quantity.base));
    if (rest) {
      const std::vector<double> left = signal(budget, none);
      if (!budget.note.empty()) return;
      add(budget, *rest, left);
    }
    budget.remainder = budget.residual;
    for (BudgetPart& part : budget.parts) {
      part.at_place = part.signal[budget.place];
      part.rms = rms(part.signal);
      for (std::size_t n = 0; n < budget.s.size(); ++n) budget.remainder[n] -= part.signal[n];
    }
    budget.remainder_rms = rms(budget.remainder);
  }

  // complete, without measurement, each that adds, all of these, each of the chain
  static constexpr double kRuns = 3.0 + std::size(kAdding) + std::size(kChain);

  Scenario scenario_;
  const BudgetControl& control_;
  PreparationCache cache_;
  std::map<std::string, Causes> present_;  // by case
  std::vector<Budget> budgets_;
  double runs_ = 0.0;
};

// The quantities of a scenario, and those of all cases and axes that it has none of.
std::vector<QuantitySpec> asked_for(const Scenario& scenario, std::span<const std::string> also) {
  std::vector<QuantitySpec> out = scenario.quantities;
  const JointLayout& layout = scenario.machine.chain.layout;
  for (const std::string& name : also) {
    assert(is_of_any_case(name));
    const auto has_name = [&](const QuantitySpec& one) { return one.name == name; };
    if (std::any_of(out.begin(), out.end(), has_name)) continue;
    QuantitySpec one;
    one.name = name;
    for (const CaseSpec& each : scenario.cases) one.cases.push_back(each.name);
    for (int joint = 0; joint < kLinearJoints; ++joint) {
      if (!layout.has(joint)) continue;
      one.axis = layout.letter_of(joint);
      out.push_back(one);
    }
  }
  return out;
}

}  // namespace

const CauseInfo& info_of(Cause cause) { return kInfos[static_cast<std::size_t>(cause)]; }

double Budget::residual_rms() const { return rms(residual); }

bool is_of_any_case(std::string_view quantity) {
  if (!has_path_signal(quantity)) return false;
  const QuantityInfo& info = quantity_info(quantity);
  return !info.needs_base && !info.needs_imposed;
}

std::vector<QuantitySpec> budget_quantities(const Scenario& scenario,
                                            std::span<const std::string> also,
                                            const std::vector<std::string>& sections) {
  std::vector<QuantitySpec> out;
  for (const QuantitySpec& asked : asked_for(scenario, also)) {
    QuantitySpec one = asked;
    if (one.name == "brought_out" || one.name == "response_time") {
      one.name = "imposed_curve_residual";
    }
    if (!has_path_signal(one.name)) continue;
    one.statistic = "max";
    one.reference.clear();
    one.kind.clear();
    if (!sections.empty()) one.sections = sections;
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
