#include "sim/evaluation/r_test_quantities.h"

#include <fmt/format.h>

#include <cassert>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/statistic.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

QuantityValue statistic_of(const model::QuantitySpec& spec, const metrology::BallDeviation& found) {
  Statistic statistic(spec.statistic);
  for (const double d : found.d) statistic.add(d / um);
  return {statistic.value(), found.why_not};
}

template <metrology::NestDirection kDirection>
QuantityValue of_nest(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  return statistic_of(
      spec, metrology::nest_deviation(one.data.chain, one.ball.path_of(spec.sections), kDirection));
}

QuantityValue of_bar(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData*) {
  return statistic_of(
      spec, metrology::bar_deviation(one.ball.path_of(spec.sections), spec.ball->bar_centres[0]));
}

QuantityValue location_error(const model::QuantitySpec& spec, CaseEvaluation& one,
                             const CaseData*) {
  return one.ball.location(spec);
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "radial_ball_deviation",
     .unit = "um",
     .help = "R-test: displacement of the ball in the spindle relative to the table, radial to the "
             "moving rotary axis",
     .has_statistic = true,
     .is_r_test = true,
     .evaluate = of_nest<metrology::NestDirection::radial>},
    {.name = "axial_ball_deviation",
     .unit = "um",
     .help = "R-test: displacement of the ball in the spindle relative to the table, along the "
             "moving rotary axis",
     .has_statistic = true,
     .is_r_test = true,
     .evaluate = of_nest<metrology::NestDirection::axial>},
    {.name = "tangential_ball_deviation",
     .unit = "um",
     .help = "R-test: displacement of the ball in the spindle relative to the table, tangential, "
             "in the positive direction of the moving rotary axis",
     .has_statistic = true,
     .is_r_test = true,
     .evaluate = of_nest<metrology::NestDirection::tangential>},
    {.name = "ball_bar_deviation",
     .unit = "um",
     .help = "ISO 10791-6 BK4: length of a ball bar between centre_mm of [[quantity.bar]] and the "
             "TCP, minus nominal",
     .has_statistic = true,
     .is_r_test = true,
     .bars = BallBars::required,
     .evaluate = of_bar},
    {.name = "location_error",
     .unit = "um",
     .help = "location error identified from the nest of sensors, or from each [[quantity.bar]]; "
             "angles in urad",
     .is_r_test = true,
     .bars = BallBars::optional,
     .identifies = true,
     .evaluate = location_error},
};

}  // namespace

metrology::TipPath BallQuantities::path_of(const std::vector<std::string>& sections) {
  const RowRanges& rows = samples_.rows(sections);
  metrology::TipPath out;
  out.nominal = samples_.positions("tool_position_nominal", rows);
  out.actual = samples_.positions("tool_position_true", rows);
  out.Q.assign(rows.size(), Joints::Zero());
  const records::Series& servo = *samples_.data().servo;
  for (const plant::ChainAxis& axis : samples_.data().chain.axes) {
    const bool linear = is_linear(axis.axis);
    const auto column = servo.column(linear ? "ref_linear" : "ref_rotary", letter(axis.axis));
    if (!column) return {};
    auto Q = out.Q.begin();
    rows.for_each([&](std::size_t row) {
      (*Q++)[axis.joint] = servo.at(row, *column) * (linear ? mm : deg);
    });
  }
  if (out.nominal.size() != rows.size() || out.actual.size() != rows.size()) return {};
  return out;
}

BallQuantities::Identified BallQuantities::identify(const model::QuantitySpec& spec) {
  const plant::MachineChain& chain = samples_.data().chain;
  const std::vector<Eigen::Vector3d>& bars = spec.ball->bar_centres;
  std::vector<metrology::SensorReading> readings;
  const auto add = [&](const metrology::BallReadings& found) {
    readings.insert(readings.end(), found.readings.begin(), found.readings.end());
    return found.why_not;
  };
  std::string why_not;
  if (bars.empty()) {
    why_not = add(metrology::nest_readings(chain, path_of(spec.sections), spec.sections.size()));
  }
  for (std::size_t i = 0; i < bars.size() && why_not.empty(); ++i) {
    why_not = add(
        metrology::bar_readings(chain, path_of({spec.sections[i]}), bars[i], static_cast<int>(i)));
  }
  if (!why_not.empty()) return {{}, why_not};
  const metrology::RTestSetUp set_up{.tcp_is_unknown = !spec.ball->tcp_is_known,
                                     .length_is_unknown = !bars.empty()};
  return {metrology::identify_locations(chain, readings, set_up), ""};
}

QuantityValue BallQuantities::location(const model::QuantitySpec& spec) {
  const model::BallSpec& ball = *spec.ball;
  assert(ball.error);
  std::string key = fmt::format("{}\n{}", fmt::join(spec.sections, "\n"), ball.tcp_is_known);
  for (const Eigen::Vector3d& centre : ball.bar_centres) {
    key += fmt::format("\n{} {} {}", centre.x(), centre.y(), centre.z());
  }
  auto known = identified_.find(key);
  if (known == identified_.end()) known = identified_.emplace(key, identify(spec)).first;
  const Identified& found = known->second;
  const metrology::LocationEstimate* estimate = found.fit.find(*ball.error);
  if (estimate == nullptr) return {.note = found.why_not};
  if (!estimate->value) return {.note = estimate->why_not()};
  return {*estimate->value / (is_linear(ball.error->direction) ? um : urad), ""};
}

std::span<const QuantityEntry> r_test_quantities() { return kQuantities; }

std::string_view unit_of_location(const plant::ErrorName& name) {
  return is_linear(name.direction) ? "um" : "urad";
}

}  // namespace servomill::sim::evaluation
