#include "sim/run/budget_causes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/drives/feed_drive.h"
#include "plant/sensing/encoder.h"
#include "plant/vocabulary/parameters.h"
#include "plant/vocabulary/ticks.h"
#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"
#include "sim/run/budget.h"
#include "strategies/entry.h"

namespace servomill::sim::run {
namespace {

constexpr std::array<CauseInfo, kCauses> kInfos = {{
    {"lag", "lag of servo loops and drives", CauseGroup::servo},
    {"table", "points and layout of compensation tables"},
    {"delay", "response and update of tables, signal delay, model period", CauseGroup::servo},
    {"saturation", "limits of virtual displacements"},
    {"single_evaluation", "errors evaluated at a displaced position"},
    {"identification",
     "differences of identified errors, machine or work offset from the actual ones"},
    {"friction", "dry friction, backlash and cogging, including their compensation in the NC",
     CauseGroup::servo},
    {"measurement", "encoders and, with motor feedback, screws", CauseGroup::servo},
    {"cutting", "cutting forces", CauseGroup::force},
    {"inertia", "deflection of the structure under acceleration, and motion of the machine bed",
     CauseGroup::inertia},
    {"heat", "temperatures of the machine", CauseGroup::heat},
    {"interpolation", "chords, path tolerance and filter of the NC", CauseGroup::servo},
    {"uncorrected", "errors that no strategy of the case compensates or imposes"},
    {"uncorrectable",
     "errors that the axes cannot correct, or of a cause that the strategy does not declare"},
    {"imposed", "errors imposed on purpose by strategies", CauseGroup::imposed},
}};

constexpr double kFine = 0.01;       // share of tolerances that are taken away
constexpr double kMinChord = 1e-9;   // m
constexpr double kFineBlocks = 0.1;  // of the length: the chord error is the square of it

model::MachineSettings& own_machine(const model::Scenario& scenario, model::CaseSpec& one) {
  if (!one.machine) one.machine = scenario.machine;
  return *one.machine;
}

// Takes a cause away from the machine of a case and from those that its strategies know; whether
// the machine of the case had it.
template <class Remove>
bool remove_of_machines(const model::Scenario& scenario, model::CaseSpec& one,
                        const Remove& remove) {
  for (model::StrategySpec& strategy : one.strategies) {
    if (!strategy.machine) continue;
    auto known = std::make_shared<model::MachineSettings>(*strategy.machine);
    remove(*known);
    strategy.machine = std::move(known);
  }
  return remove(own_machine(scenario, one));
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
  const config::ParsedUnit unit = config::parse_unit(spec.unit);
  const double ideal = std::stod(std::string(spec.ideal)) * (unit.unit ? unit.unit->factor : 1.0);
  if (!parameters.is_word(spec.name) && parameters.number(spec.name) == ideal) return false;
  parameters.set(spec.name, ideal);
  return true;
}

// Takes a shortcoming away from all strategies that have it; whether any had.
bool idealise(model::CaseSpec& one, Shortcoming shortcoming) {
  bool any = false;
  for (model::StrategySpec& strategy : one.strategies) {
    for (const ParameterSpec& spec : strategy.entry->parameters) {
      if (spec.shortcoming != shortcoming || spec.ideal.empty()) continue;
      any |= idealise(spec, strategy.parameters);
    }
  }
  return any;
}

bool remove_friction(model::MachineSettings& machine) {
  bool any = false;
  for (const int joint : machine.joints()) {
    const auto j = static_cast<std::size_t>(joint);
    plant::FeedDriveParams& drive = machine.drives[j];
    model::AxisFunctions& functions = machine.nc.functions[j];
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

bool remove_inertia(model::MachineSettings& machine) {
  bool any = !std::exchange(machine.inertial_compliances, {}).empty();
  for (plant::FeedDriveParams& drive : machine.drives) {
    any |= std::exchange(drive.bed, {}).M > 0.0;
  }
  return any;
}

// The structure is rigid under acceleration, its bed stands still, and nothing corrects for them.
bool remove_inertia(const model::Scenario& scenario, model::CaseSpec& one) {
  const bool corrected = std::erase_if(one.strategies, [](const auto& spec) {
                           return spec.entry->corrects_inertia;
                         }) > 0;
  const auto of_machine = [](model::MachineSettings& machine) { return remove_inertia(machine); };
  return remove_of_machines(scenario, one, of_machine) || corrected;
}

bool remove_measurement(model::MachineSettings& machine) {
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

bool remove_delay(model::Scenario& scenario, model::CaseSpec& one) {
  constexpr Tick kNone = 0, kMin = 1;
  const bool needs_hardware = one.needs_feedback_hardware();
  model::MachineSettings& machine = own_machine(scenario, one);
  bool any = machine.scale_delay != kNone ||
             (one.feedback_hardware && scenario.hardware.signal_delay != kNone) ||
             (needs_hardware && scenario.hardware.model_period != kMin);
  machine.scale_delay = kNone;
  any |= idealise(one, Shortcoming::delay);
  return any;
}

const std::string& machine_errors_of(const model::Scenario& scenario, const model::CaseSpec& one) {
  return one.machine_errors ? *one.machine_errors : scenario.machine_errors;
}

// True if strategies of a case know errors, to correct or to generate them.
bool has_strategy(const model::CaseSpec& one, strategies::Action action) {
  return std::any_of(one.strategies.begin(), one.strategies.end(),
                     [&](const model::StrategySpec& spec) {
                       return spec.entry->reads_errors && spec.action == action;
                     });
}

bool remove_identification(const model::Scenario& scenario, model::CaseSpec& one) {
  bool any = idealise(one, Shortcoming::identification);
  for (model::StrategySpec& strategy : one.strategies) {
    any |= std::exchange(strategy.machine, nullptr) != nullptr;
  }
  const std::string& machine_errors = machine_errors_of(scenario, one);
  for (model::StrategySpec& strategy : one.strategies) {
    if (!strategy.entry->reads_errors) continue;
    const bool removes_machine_errors =
        strategy.action == strategies::Action::compensate && !machine_errors.empty();
    const std::string& right = removes_machine_errors ? machine_errors : scenario.imposed;
    if (right.empty() || strategy.model == right) continue;
    strategy.model = right;
    any = true;
  }
  return any;
}

bool remove_uncorrected(const model::Scenario& scenario, model::CaseSpec& one) {
  if (machine_errors_of(scenario, one).empty() || has_strategy(one, strategies::Action::compensate))
    return false;
  one.machine_errors = "";
  return true;
}

// Refines the blocks of a strategy that rewrites: by its chord tolerance, or where it has none by
// their length.
void refine_blocks(model::StrategySpec& strategy) {
  const auto has = [&](Shortcoming shortcoming) {
    return std::any_of(strategy.entry->parameters.begin(), strategy.entry->parameters.end(),
                       [&](const ParameterSpec& spec) { return spec.shortcoming == shortcoming; });
  };
  const bool by_chord = has(Shortcoming::chord_tolerance);
  for (const ParameterSpec& spec : strategy.entry->parameters) {
    Parameters& p = strategy.parameters;
    if (by_chord && spec.shortcoming == Shortcoming::chord_tolerance) {
      p.set(spec.name, std::max(kMinChord, kFine * p.number(spec.name)));
    } else if (!by_chord && spec.shortcoming == Shortcoming::block_length && spec.is_number) {
      p.set(spec.name, kFineBlocks * p.number(spec.name));
    }
  }
}

bool remove_interpolation(const model::Scenario& scenario, model::CaseSpec& one) {
  model::NcSettings& nc = own_machine(scenario, one).nc;
  nc.path_tolerance *= kFine;
  nc.rotary_tolerance *= kFine;
  nc.tolerance_share *= kFine;
  nc.filter = {};
  nc.block_time = 0.0;
  for (model::StrategySpec& strategy : one.strategies) refine_blocks(strategy);
  return true;  // there is always a tolerance
}

// Takes a cause away from a case, but for what is the scenario's; whether it had it.
bool remove(Cause cause, model::Scenario& scenario, model::CaseSpec& one) {
  switch (cause) {
    case Cause::lag: {
      const bool had = one.servo != model::ServoModel::ideal;
      one.servo = model::ServoModel::ideal;
      return had;
    }
    case Cause::table:
      return idealise(one, Shortcoming::points);
    case Cause::delay:
      return remove_delay(scenario, one);
    case Cause::saturation:
      return idealise(one, Shortcoming::saturation);
    case Cause::single_evaluation:
      return idealise(one, Shortcoming::single_evaluation);
    case Cause::identification:
      return remove_identification(scenario, one);
    case Cause::friction:
      return remove_of_machines(scenario, one, remove_friction);
    case Cause::measurement: {
      const bool learnt = idealise(one, Shortcoming::measurement);
      return remove_of_machines(scenario, one, remove_measurement) || learnt;
    }
    case Cause::cutting:
      return std::exchange(one.cutting, false);
    case Cause::inertia:
      return remove_inertia(scenario, one);
    case Cause::heat:
      return remove_of_machines(scenario, one, [](model::MachineSettings& machine) {
        return std::exchange(machine.heat, nullptr) != nullptr;
      });
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

// True if strategies of a case move the tool off the programmed path on purpose.
bool moves_on_purpose(const model::CaseSpec& one) {
  return has_strategy(one, strategies::Action::impose) ||
         std::any_of(one.strategies.begin(), one.strategies.end(),
                     [](const model::StrategySpec& spec) {
                       const strategies::Entry& entry = *spec.entry;
                       return !entry.reads_errors && entry.acts && !entry.corrects_following &&
                              !entry.corrects_heat;
                     });
}

}  // namespace

const CauseInfo& info_of(Cause cause) { return kInfos[static_cast<std::size_t>(cause)]; }

Causes all_causes() {
  Causes out = {Cause::measurement};
  out.insert(kAdding.begin(), kAdding.end());
  out.insert(kChain.begin(), kChain.end());
  return out;
}

std::optional<Cause> rest_of(const model::QuantitySpec& quantity, const model::CaseSpec& one,
                             const model::CaseSpec* base) {
  const evaluation::QuantityEntry& entry = evaluation::quantity_entry(quantity.name);
  if (entry.is_of_servo) return std::nullopt;
  const auto any = [&](auto fact) { return fact(one) || (base != nullptr && fact(*base)); };
  const bool takes_imposed_off = entry.needs_imposed;
  if (any(moves_on_purpose) && !takes_imposed_off) return Cause::imposed;
  const bool knows_errors = any([](const model::CaseSpec& spec) {
    return has_strategy(spec, strategies::Action::impose) ||
           has_strategy(spec, strategies::Action::compensate);
  });
  if (knows_errors) return Cause::uncorrectable;
  if (takes_imposed_off) return Cause::uncorrected;
  return std::nullopt;
}

Causes present(const Causes& causes, const model::Scenario& scenario, const model::CaseSpec& one) {
  Causes out;
  for (const Cause cause : causes) {
    model::Scenario trial = scenario;
    model::CaseSpec spec = one;
    if (remove(cause, trial, spec)) out.insert(cause);
  }
  if (one.servo == model::ServoModel::ideal) {
    for (const Cause cause : {Cause::friction, Cause::measurement}) out.erase(cause);
  }
  return out;
}

model::Scenario without(const model::Scenario& scenario, const Causes& removed,
                        const Causes& already, const std::map<std::string, Causes>& present_in) {
  model::Scenario out = scenario;
  if (!removed.empty()) {  // the first run has checked them; signals along the path need no part
    out.quantities.clear();
    out.probes.clear();
    out.part.reset();
  }
  out.cases.clear();
  for (const model::CaseSpec& one : scenario.cases) {
    const auto found = present_in.find(one.name);
    if (found == present_in.end()) continue;  // nobody asks for it
    model::CaseSpec changed = one;
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

}  // namespace servomill::sim::run
