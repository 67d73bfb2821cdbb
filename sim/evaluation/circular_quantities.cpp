#include "sim/evaluation/circular_quantities.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The value that is larger by magnitude at the two reversals of an axis.
double larger_at_reversal(const CircularTurn& turn, const SectionCircle& circle, char axis,
                          double Reversal::*value) {
  double larger = kNone;
  for (const Reversal& reversal : turn.reversals) {
    const int letter = reversal.axis == 0 ? circle.first : circle.second;
    if ("XYZ"[letter] != axis) continue;
    if (!(std::abs(reversal.*value) <= std::abs(larger))) larger = reversal.*value;
  }
  return larger;
}

}  // namespace

std::optional<CircularQuantities::Turn> CircularQuantities::find_turn(const std::string& section) {
  const RowRanges& rows = samples_.rows({section});
  const auto nominal = circle_of_section(samples_.positions("tool_position_nominal", rows));
  const auto* circle = std::get_if<SectionCircle>(&nominal);
  if (circle == nullptr) return std::nullopt;
  Turn turn{*circle, circle->in_plane(samples_.positions("tool_position_true", rows))};
  if (why_no_turn(turn.path, circle->nominal)) return std::nullopt;
  return turn;
}

std::optional<CircularQuantities::Turn>& CircularQuantities::turn(const std::string& section) {
  const auto known = turns_.find(section);
  return known != turns_.end() ? known->second
                               : turns_.emplace(section, find_turn(section)).first->second;
}

const BidirectionalCircle& CircularQuantities::both(const std::vector<std::string>& sections) {
  const auto known = pairs_.find(sections);
  if (known != pairs_.end()) return known->second;
  const Turn &one = *turn(sections[0]), &other = *turn(sections[1]);
  return pairs_.emplace(sections, evaluate_both(one.path, other.path, one.circle.nominal))
      .first->second;
}

double CircularQuantities::value(const QuantitySpec& spec) {
  for (const std::string& section : spec.sections) {
    if (!turn(section)) return kNone;
  }
  if (spec.sections.size() == 2) {
    const BidirectionalCircle& pair = both(spec.sections);
    if (spec.name == "bidirectional_circular_deviation") return pair.G_b / um;
    if (spec.name == "mean_bidirectional_radial_deviation") return pair.D / um;
    assert(spec.name == "circle_squareness");
    return pair.squareness / urad;
  }
  Turn& one = *turn(spec.sections[0]);
  if (!one.evaluated) one.evaluated = evaluate_turn(one.path, one.circle.nominal);
  const CircularTurn& found = *one.evaluated;
  if (spec.name == "circular_deviation") return found.G / um;
  if (spec.name == "circular_deviation_least_squares") return found.G_least_squares / um;
  if (spec.name == "radial_deviation_max") return found.F_max / um;
  if (spec.name == "radial_deviation_min") return found.F_min / um;
  assert(spec.name == "reversal_spike" || spec.name == "reversal_step");
  const auto value = spec.name == "reversal_spike" ? &Reversal::spike : &Reversal::step;
  return larger_at_reversal(found, one.circle, spec.axis, value) / um;
}

}  // namespace servomill::sim
