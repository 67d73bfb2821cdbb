/// Machines and strategies for tests of all strategies: built from what a strategy declares.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "strategies/registry.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::strategies {

/// A five-axis machine of +-200 mm with a tool of 110 mm, its rotary axes turned, identified to
/// have these errors. The reference position is a point of a table with the default spacing.
inline IdentifiedMachine identified_with(const plant::ErrorModel& errors,
                                         const char* structure = "[w C' B' X b Y Z (C1) t]") {
  const plant::MachineChain chain = plant::make_chain(plant::parse_structure(structure));
  IdentifiedMachine identified{chain.layout, plant::VolumetricModel(chain, errors)};
  identified.p_ST << 0.0, 0.0, -110.0 * mm;
  identified.lower << -200.0 * mm, -200.0 * mm, -200.0 * mm, -2.0, -7.0;
  identified.upper << 200.0 * mm, 200.0 * mm, 200.0 * mm, 2.0, 7.0;
  identified.reference = identified.lower;
  identified.reference.head<3>().array() += 100 * 1.6384 * mm;
  identified.reference.tail<2>() << 20.0 * deg, 30.0 * deg;
  identified.Kv.setConstant(80.0);
  identified.position_period = 0.2 * ms;
  return identified;
}

/// The declared defaults; the first word for what has none.
inline Parameters default_parameters(const Entry& entry) {
  Parameters out;
  for (const ParameterSpec& spec : entry.parameters) {
    const std::string text(spec.default_text);
    const bool is_word = std::find(spec.words.begin(), spec.words.end(), text) != spec.words.end();
    if (is_word || !spec.is_number) {
      out.set(spec.name, is_word ? std::string_view(text) : spec.words.front());
    } else {
      const auto unit = sim::config::parse_unit(spec.unit).unit;
      out.set(spec.name, std::stod(text) * (unit ? unit->factor : 1.0));
    }
  }
  return out;
}

/// The moves that a strategy makes of others.
inline std::vector<Move> rewritten_moves(const Strategy& strategy, const std::vector<Move>& moves) {
  std::vector<Move> out;
  strategy.rewrite(moves, [&](const Move& move) { out.push_back(move); });
  return out;
}

/// Parts that act on a run, made once.
struct Acting {
  std::unique_ptr<Strategy> strategy;
  std::unique_ptr<SetpointPart> setpoint;
  std::unique_ptr<FeedbackPart> feedback;

  bool acts() const { return strategy->rewrites() || setpoint || feedback; }

  /// Displacement of the axes (5; m, rad) at standstill in Q: setpoint, program and feedback
  /// together.
  Joints displacement(const JointLayout& layout, const Joints& Q) const {
    Joints sum = Joints::Zero();
    if (setpoint) sum += setpoint->offset(Q);
    if (feedback) sum -= feedback->settle(Q);
    if (strategy->rewrites()) {
      Move move;
      move.end = move.end_machine = layout.words(Q);
      sum +=
          layout.joints(rewritten_moves(*strategy, {move}).back().end_machine - move.end_machine);
    }
    return sum;
  }
};

inline constexpr double kModelPeriod = 60e-6;  // s

inline Acting make_acting(const Entry& entry, const Parameters& parameters, Action action,
                          const IdentifiedMachine& identified) {
  Acting out;
  out.strategy = entry.make(parameters, action, identified);
  out.setpoint = out.strategy->setpoint();
  out.feedback = out.strategy->feedback(kModelPeriod);
  return out;
}

/// The strategy with its default parameters; `iterations = "converged"` and `axes = "all"` where it
/// knows them.
inline Acting make_acting(const Entry& entry, Action action, const IdentifiedMachine& identified,
                          bool converged = false, bool all_axes = false) {
  Parameters parameters = default_parameters(entry);
  if (converged && parameters.is_word("iterations")) parameters.set("iterations", "converged");
  if (all_axes && parameters.is_word("axes")) parameters.set("axes", "all");
  return make_acting(entry, parameters, action, identified);
}

inline constexpr std::array<Action, 2> kBothActions = {Action::impose, Action::compensate};

}  // namespace servomill::strategies
