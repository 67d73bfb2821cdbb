#include "sim/preparation/refusals.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "controllers/gcode/modal_state.h"
#include "controllers/servo/position_feedback.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"

namespace servomill::sim::preparation {
namespace {

// Adds a fault that is not said yet.
void add_once(std::vector<Fault>& faults, Fault fault) {
  const bool is_said = std::any_of(faults.begin(), faults.end(), [&](const Fault& other) {
    return other.place == fault.place && other.message == fault.message;
  });
  if (!is_said) faults.push_back(std::move(fault));
}

}  // namespace

InputError fault_of(const model::StrategySpec& spec, const std::string& case_name,
                    const InputError& error) {
  const std::string& why = error.faults().front().message;
  Place place = spec.place;
  std::size_t first = std::string::npos;
  for (const auto& [key, at] : spec.key_places) {
    const std::size_t found = why.find(key);
    if (found >= first) continue;
    first = found;
    place = at;
  }
  return InputError(place,
                    fmt::format("case {}: strategy {}: {}", case_name, spec.entry->name, why));
}

void refuse_unnumbered_tools(const MoveRange& moves, const std::string& file) {
  const auto found = first_move(moves, [](const Move& move) {
    return is_motion(move.kind) && move.tool_offset == controllers::kOtherToolOffset;
  });
  if (!found) return;
  throw InputError({file, found->line},
                   "moves with a tool offset of G43.1 or G43.2; a simulation uses the tool of "
                   "[[program.tool]]: use G43 H");
}

void refuse_absent_axes(const InterpretedProgram& program, const model::Scenario& scenario) {
  std::vector<Fault> faults;
  for (const Axis axis : kAllAxes) {
    const int line = program.first_line[static_cast<std::size_t>(axis)];
    if (scenario.machine.chain.layout.joint_of(axis) || line == 0) continue;
    faults.push_back({{scenario.program.file, line},
                      fmt::format("moves {0}; the machine has no axis {0}", letter(axis))});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

void refuse_standing_spindle(const InterpretedProgram& program, const model::Scenario& scenario) {
  for (const Move& move : program.moves) {
    if (!is_feed(move.kind) || move.feed_mode != FeedMode::units_per_revolution || move.feed > 0.0)
      continue;
    throw InputError({scenario.program.file, move.line},
                     "feed per revolution (G95) with the spindle stopped would never end: start "
                     "the spindle (M3 S...) or use G94");
  }
}

void refuse_turned_tip(const InterpretedProgram& program, const model::Scenario& scenario,
                       const model::CaseSpec& spec) {
  const AxisWords offset = scenario.program.work_offset + spec.work_offset;
  const Move* tip = program.first_tip_move();
  const bool is_probed = !scenario.probes.empty();
  if (tip == nullptr || offset.tail<3>().isZero(0.0) || !(is_probed || spec.cutting)) return;
  throw InputError(
      is_probed ? scenario.probes.front().place : scenario.cutting->place,
      fmt::format("case {}: a part is {} in the coordinates of its program; under TCP control "
                  "({}:{}) these do not rotate with the work_offset of a rotary axis: set it to 0",
                  spec.name, is_probed ? "probed" : "cut from [[part.stock]]",
                  scenario.program.file, tip->line));
}

void refuse_start_outside(const model::Scenario& scenario, const model::MachineSettings& machine,
                          const Joints& start) {
  std::vector<Fault> faults;
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    if (start[j] >= machine.nc.lower[j] && start[j] <= machine.nc.upper[j]) continue;
    const bool linear = j < kLinearJoints;
    const double unit = linear ? mm : deg;
    faults.push_back(
        {scenario.program.start_place,
         fmt::format("program.start: {} = {:.4f} {} with all work offsets, outside the travel; "
                     "must be >= {:.4f} and <= {:.4f}",
                     machine.chain.layout.letter_of(j), start[j] / unit, linear ? "mm" : "deg",
                     machine.nc.lower[j] / unit, machine.nc.upper[j] / unit)});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

void refuse_unread_scale(const model::StrategySpec& spec, const strategies::Strategy& strategy,
                         const model::MachineSettings& machine, const std::string& case_name) {
  if (!strategy.displaces_feedback()) return;
  for (const int j : machine.joints()) {
    const auto& feedback = machine.nc.functions[static_cast<std::size_t>(j)].position_feedback;
    if (j >= kLinearJoints && !strategy.displaces_rotary()) continue;
    if (feedback.kind != controllers::PositionFeedback::motor) continue;
    throw InputError(
        spec.place,
        fmt::format("case {}: strategy {}: displaces the scale of axis {}, whose position loop is "
                    "closed on the motor encoder (position_feedback = \"motor\")",
                    case_name, spec.entry->name, machine.chain.layout.letter_of(j)));
  }
}

void refuse_undeclared_feedback(const model::StrategySpec& spec,
                                const strategies::Strategy& strategy) {
  if (!strategy.displaces_feedback() || spec.entry->uses_feedback_hardware) return;
  throw std::logic_error(
      fmt::format("strategy {} displaces the feedback, but its entry in the registry lacks "
                  "uses_feedback_hardware",
                  spec.entry->name));
}

void refuse_tip_moves(const model::StrategySpec& spec, const strategies::Strategy& strategy,
                      const InterpretedProgram& program, const std::string& file,
                      const std::string& case_name) {
  const Move* move = program.first_tip_move();
  if (move == nullptr) return;
  if (!strategy.rewrites_tip_moves()) {
    throw InputError(spec.place, fmt::format("case {}: strategy {}: cannot rewrite moves under TCP "
                                             "control or in a tilted work plane ({}:{})",
                                             case_name, spec.entry->name, file, move->line));
  }
  for (const Move& other : program.moves) {
    const bool is_tip = is_motion(other.kind) && other.tool_control != ToolControl::none;
    if (!is_tip || program.tips.at(other.tool_offset) == program.first_tip) continue;
    throw InputError(
        spec.place,
        fmt::format("case {}: strategy {}: rewrites moves under TCP control only for the first "
                    "tool of the program; a different one is used here ({}:{})",
                    case_name, spec.entry->name, file, other.line));
  }
}

namespace {

// True if a strategy corrects all errors of its model, whatever others do.
bool corrects_model(const model::StrategySpec& spec) {
  return spec.entry->reads_errors && !spec.entry->runs_program && !spec.model.empty() &&
         spec.action == strategies::Action::compensate;
}

}  // namespace

void refuse_second_correction(const model::StrategySpec& spec, const model::CaseSpec& one) {
  if (!corrects_model(spec)) return;
  for (const model::StrategySpec& earlier : one.strategies) {
    if (&earlier == &spec) return;
    if (!corrects_model(earlier) || earlier.model != spec.model || earlier.entry == spec.entry) {
      continue;
    }
    throw InputError(spec.place,
                     fmt::format("case {}: strategy {} would correct the errors of model '{}' a "
                                 "second time, after {}; use a model of the residual (relative_to)",
                                 one.name, spec.entry->name, spec.model, earlier.entry->name));
  }
}

void refuse_second(const model::StrategySpec& spec, const model::CaseSpec& one) {
  refuse_second_correction(spec, one);
  if (!spec.entry->once) return;
  const auto is_same = [&](const model::StrategySpec& other) { return other.entry == spec.entry; };
  if (std::count_if(one.strategies.begin(), one.strategies.end(), is_same) < 2) return;
  throw InputError(spec.place,
                   fmt::format("case {}: strategy {} appears twice; each would correct the whole",
                               one.name, spec.entry->name));
}

void refuse_other_tip(const model::StrategySpec& spec, const InterpretedProgram& program,
                      const std::string& file, const std::string& case_name) {
  std::optional<AxisWords> before;
  for (const Move& move : program.moves) {
    if (!is_motion(move.kind)) continue;
    const auto tip = program.tips.find(move.tool_offset);
    const bool other = tip != program.tips.end() && tip->second != program.first_tip;
    const bool turns = before && move.end_machine.segment<3>(3) != before->segment<3>(3);
    before = move.end_machine;
    if (!other || !turns) continue;
    throw InputError(spec.place,
                     fmt::format("case {}: strategy {}: uses the TCP of the first tool of the "
                                 "program; rotary axes move with a different tool here ({}:{})",
                                 case_name, spec.entry->name, file, move.line));
  }
}

void refuse_growing_part(const model::Scenario& scenario, const model::CaseSpec& spec) {
  const auto& heat = scenario.machine_of(spec).heat;
  if (!scenario.day || !heat || !heat->part) return;
  throw InputError(
      Place{}, fmt::format("case {}: [day] needs a part that does not grow (no heat.part): each "
                           "cycle is another part, whose temperature the day does not follow",
                           spec.name));
}

void refuse_endless(const model::Scenario& scenario, double duration) {
  constexpr double kHour = 3600.0;
  if (duration > scenario.record.max_duration) {
    throw InputError({scenario.program.file},
                     fmt::format("takes {:.3g} h at program.feed_override = {:g}; must be <= "
                                 "record.max_duration_h = {:g}: check feeds and feed_override, or "
                                 "raise record.max_duration_h",
                                 duration / kHour, scenario.program.feed_override,
                                 scenario.record.max_duration / kHour));
  }
  constexpr double kMaxSamples = 1e8;  // of some 500 bytes: more than most machines hold
  const double period = scenario.machine.nc.periods.seconds(scenario.record_period);
  const double samples = (duration + scenario.settle_time) / period;
  if (samples <= kMaxSamples) return;
  throw InputError({scenario.program.file},
                   fmt::format("takes {:.3g} s: {:.3g} samples at record.period_ms = {:g}; must be "
                               "<= {:g}; check feeds, feed_override and the limits of the axes",
                               duration, samples, period / ms, kMaxSamples));
}

void refuse_absent_sections(const model::Scenario& scenario,
                            const std::vector<std::string>& sections) {
  std::vector<std::string_view> known;
  for (const std::string& name : sections) {
    if (!name.empty()) known.push_back(name);
  }
  std::vector<Fault> faults;
  const auto look = [&](const std::vector<std::string>& names, const Place& place) {
    for (const std::string& name : names) {
      if (std::find(sections.begin(), sections.end(), name) != sections.end()) continue;
      const std::string near = did_you_mean(name, known);
      add_once(faults, {place, fmt::format("{} has no section '{}'{}", scenario.program.file, name,
                                           !near.empty()   ? near
                                           : known.empty() ? "; a comment (MSG, NAME) starts one"
                                                           : fmt::format("; known are: {}",
                                                                         fmt::join(known, ", ")))});
    }
  };
  for (const model::QuantitySpec& quantity : scenario.quantities) {
    look(quantity.sections, quantity.sections_place);
  }
  look(scenario.record.windows.sections, scenario.record.windows.sections_place);
  if (!faults.empty()) throw InputError(std::move(faults));
}

void refuse_narrow_windows(const model::Scenario& scenario) {
  const model::RecordWindows& windows = scenario.record.windows;
  std::vector<Fault> faults;
  for (const model::QuantitySpec& quantity : scenario.quantities) {
    if (!windows.limited() || !evaluation::quantity_entry(quantity.name).needs_every_row())
      continue;
    if (quantity.sections.empty()) {
      add_once(faults, {quantity.sections_place,
                        fmt::format("{} needs every row: give it sections, and list these in "
                                    "record.windows.sections",
                                    quantity.name)});
    }
    for (const std::string& name : quantity.sections) {
      if (windows.covers(name)) continue;
      add_once(faults, {quantity.sections_place,
                        fmt::format("{} needs every row of section '{}': list it in "
                                    "record.windows.sections, without every",
                                    quantity.name, name)});
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

void CaseFaults::add(const std::string& case_name, const InputError& error) {
  for (const Fault& fault : error.faults()) {
    const auto same = std::find_if(found_.begin(), found_.end(), [&](const Found& other) {
      return other.fault.place == fault.place && other.fault.message == fault.message;
    });
    if (same == found_.end()) {
      found_.push_back({fault, {case_name}});
    } else {
      same->cases.push_back(case_name);
    }
  }
}

void CaseFaults::report(std::size_t cases) {
  if (found_.empty()) return;
  std::vector<Fault> faults;
  for (Found& one : found_) {
    const std::string who = fmt::format("case {}: ", fmt::join(one.cases, ", "));
    if (one.cases.size() < cases && !one.fault.message.starts_with(who)) {
      one.fault.message = who + one.fault.message;
    }
    faults.push_back(std::move(one.fault));
  }
  throw InputError(std::move(faults));
}

void refuse_rewritten_probing(const model::StrategySpec& spec, const InterpretedProgram& program,
                              const std::string& case_name) {
  if (!program.probes()) return;
  throw InputError(spec.place,
                   fmt::format("case {}: strategy {} rewrites the program, which has probing moves "
                               "(line {}); use another strategy for measuring",
                               case_name, spec.entry->name, program.touches.front().line));
}

}  // namespace servomill::sim::preparation
