#include "sim/evaluation/circular_quantities.h"

#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

QuantityValue circular_error(const model::QuantitySpec& spec, CaseEvaluation& one,
                             const CaseData*) {
  const auto width = one.circles.zone_width(spec.sections[0]);
  if (!width) return {};
  return {*width / um};
}

template <double (*kValue)(const metrology::RadialRange&)>
QuantityValue of_range(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  const auto* range = one.circles.range(spec.sections[0]);
  if (range == nullptr) return {};
  return {kValue(*range) / um};
}

double width_of(const metrology::RadialRange& range) { return range.width(); }
double largest_of(const metrology::RadialRange& range) { return range.largest; }
double smallest_of(const metrology::RadialRange& range) { return range.smallest; }

template <double metrology::BidirectionalCircle::*kValue>
QuantityValue of_both(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  const metrology::BidirectionalCircle* pair = one.circles.both(spec.sections);
  if (pair == nullptr) return {};
  return {pair->*kValue / um};  // and urad
}

// The value that is larger by magnitude at the two reversals of an axis.
template <double metrology::Reversal::*kValue>
QuantityValue larger_at_reversal(const model::QuantitySpec& spec, CaseEvaluation& one,
                                 const CaseData*) {
  const auto* turn = one.circles.evaluated(spec.sections[0]);
  if (turn == nullptr) return {};
  double larger = std::numeric_limits<double>::quiet_NaN();
  for (const metrology::Reversal& reversal : turn->evaluated->reversals) {
    const int letter = reversal.axis == 0 ? turn->circle.first : turn->circle.second;
    if ("XYZ"[letter] != spec.axis) continue;
    if (!(std::abs(reversal.*kValue) <= std::abs(larger))) larger = reversal.*kValue;
  }
  return {larger / um};
}

constexpr std::string_view kPositions[] = {"tool_position_nominal", "tool_position_true"};

constexpr QuantityEntry kQuantities[] = {
    {.name = "circular_error",
     .unit = "um",
     .help = "ISO 230-4 G: smallest radial separation of two concentric circles around the true "
             "path",
     .circles = 1,
     .evaluate = circular_error,
     .reads = kPositions},
    {.name = "circular_error_least_squares",
     .unit = "um",
     .help = "G about the least-squares centre: range of the radial deviation",
     .circles = 1,
     .evaluate = of_range<width_of>,
     .reads = kPositions},
    {.name = "bidirectional_circular_error",
     .unit = "um",
     .help = "ISO 230-4 G(b): smallest radial separation of two concentric circles around the "
             "paths of both directions",
     .circles = 2,
     .evaluate = of_both<&metrology::BidirectionalCircle::G_b>,
     .reads = kPositions},
    {.name = "radial_error_max",
     .unit = "um",
     .help = "ISO 230-4 F max: largest deviation from the nominal radius, about the least-squares "
             "centre",
     .circles = 1,
     .evaluate = of_range<largest_of>,
     .reads = kPositions},
    {.name = "radial_error_min",
     .unit = "um",
     .help = "ISO 230-4 F min: smallest deviation from the nominal radius, about the least-squares "
             "centre",
     .circles = 1,
     .evaluate = of_range<smallest_of>,
     .reads = kPositions},
    {.name = "mean_bidirectional_radial_error",
     .unit = "um",
     .help = "ISO 230-4 D: nominal radius minus that of the least-squares circle of both "
             "directions",
     .circles = 2,
     .evaluate = of_both<&metrology::BidirectionalCircle::D>,
     .reads = kPositions},
    {.name = "reversal_spike",
     .unit = "um",
     .help =
         "larger of the two excursions at the reversals of the axis on a circle; outward positive",
     .axes = "XYZ",
     .circles = 1,
     .evaluate = larger_at_reversal<&metrology::Reversal::spike>,
     .reads = kPositions},
    {.name = "reversal_step",
     .unit = "um",
     .help = "larger of the two radius steps at the reversals of the axis on a circle",
     .axes = "XYZ",
     .circles = 1,
     .evaluate = larger_at_reversal<&metrology::Reversal::step>,
     .reads = kPositions},
    {.name = "circle_squareness",
     .unit = "urad",
     .help = "(D45 - D135) / (2 R) of a circle, mean of both directions; positive: less than 90 "
             "deg",
     .circles = 2,
     .evaluate = of_both<&metrology::BidirectionalCircle::squareness>,
     .reads = kPositions},
};

}  // namespace

std::optional<CircularQuantities::Turn> CircularQuantities::find_turn(const std::string& section) {
  const RowRanges& rows = samples_.rows({section});
  const auto nominal =
      metrology::circle_of_section(samples_.positions("tool_position_nominal", rows));
  const auto* circle = std::get_if<metrology::SectionCircle>(&nominal);
  if (circle == nullptr) return std::nullopt;
  Turn turn{*circle, circle->in_plane(samples_.positions("tool_position_true", rows))};
  if (metrology::why_no_turn(turn.path, circle->nominal)) return std::nullopt;
  return turn;
}

std::optional<CircularQuantities::Turn>& CircularQuantities::turn(const std::string& section) {
  const auto known = turns_.find(section);
  return known != turns_.end() ? known->second
                               : turns_.emplace(section, find_turn(section)).first->second;
}

const CircularQuantities::Turn* CircularQuantities::evaluated(const std::string& section) {
  std::optional<Turn>& one = turn(section);
  if (!one) return nullptr;
  if (!one->evaluated) {
    one->evaluated = metrology::evaluate_about_least_squares(one->path, one->circle.nominal);
  }
  return &*one;
}

const metrology::RadialRange* CircularQuantities::range(const std::string& section) {
  std::optional<Turn>& one = turn(section);
  if (!one) return nullptr;
  if (!one->range) {
    one->range = metrology::range_about_least_squares(one->path, one->circle.nominal);
  }
  return &*one->range;
}

std::optional<double> CircularQuantities::zone_width(const std::string& section) {
  std::optional<Turn>& one = turn(section);
  if (!one) return std::nullopt;
  if (!one->zone_width) one->zone_width = metrology::minimum_zone(one->path).width();
  return one->zone_width;
}

const metrology::BidirectionalCircle* CircularQuantities::both(
    const std::vector<std::string>& sections) {
  const auto known = pairs_.find(sections);
  if (known != pairs_.end()) return &known->second;
  const auto &one = turn(sections[0]), &other = turn(sections[1]);
  if (!one || !other) return nullptr;
  return &pairs_
              .emplace(sections,
                       metrology::evaluate_both(one->path, other->path, one->circle.nominal))
              .first->second;
}

std::span<const QuantityEntry> circular_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
