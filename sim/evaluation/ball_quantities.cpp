#include "sim/evaluation/ball_quantities.h"

#include <fmt/format.h>

#include <cassert>
#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

BallDeviation deviation_of(const std::string& quantity, const plant::MachineChain& chain,
                           const TipPath& path, const BallSpec& ball) {
  if (quantity == "ball_bar_deviation") return bar_deviation(path, ball.bar_centres[0]);
  if (quantity == "radial_ball_deviation") {
    return nest_deviation(chain, path, NestDirection::radial);
  }
  if (quantity == "axial_ball_deviation") return nest_deviation(chain, path, NestDirection::axial);
  assert(quantity == "tangential_ball_deviation");
  return nest_deviation(chain, path, NestDirection::tangential);
}

}  // namespace

TipPath BallQuantities::path_of(const std::vector<std::string>& sections) {
  const RowRanges& rows = samples_.rows(sections);
  TipPath out;
  out.nominal = samples_.positions("tool_position_nominal", rows);
  out.actual = samples_.positions("tool_position_true", rows);
  out.Q.assign(rows.size(), Joints::Zero());
  const Series& servo = *samples_.data().servo;
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

BallDeviation BallQuantities::deviation(const QuantitySpec& spec) {
  BallDeviation found =
      deviation_of(spec.name, samples_.data().chain, path_of(spec.sections), *spec.ball);
  for (double& d : found.d) d /= um;
  return found;
}

BallQuantities::Identified BallQuantities::identify(const QuantitySpec& spec) {
  const plant::MachineChain& chain = samples_.data().chain;
  const std::vector<Eigen::Vector3d>& bars = spec.ball->bar_centres;
  std::vector<SensorReading> readings;
  const auto add = [&](const BallReadings& found) {
    readings.insert(readings.end(), found.readings.begin(), found.readings.end());
    return found.why_not;
  };
  std::string why_not;
  if (bars.empty()) {
    why_not = add(nest_readings(chain, path_of(spec.sections), spec.sections.size()));
  }
  for (std::size_t i = 0; i < bars.size() && why_not.empty(); ++i) {
    why_not = add(bar_readings(chain, path_of({spec.sections[i]}), bars[i], static_cast<int>(i)));
  }
  if (!why_not.empty()) return {{}, why_not};
  const BallSetUp set_up{.tip_is_unknown = !spec.ball->tip_is_known,
                         .length_is_unknown = !bars.empty()};
  return {identify_locations(chain, readings, set_up), ""};
}

BallQuantities::Location BallQuantities::location(const QuantitySpec& spec) {
  const BallSpec& ball = *spec.ball;
  assert(ball.error);
  std::string key = fmt::format("{}\n{}", fmt::join(spec.sections, "\n"), ball.tip_is_known);
  for (const Eigen::Vector3d& centre : ball.bar_centres) {
    key += fmt::format("\n{} {} {}", centre.x(), centre.y(), centre.z());
  }
  auto known = identified_.find(key);
  if (known == identified_.end()) known = identified_.emplace(key, identify(spec)).first;
  const Identified& found = known->second;
  const LocationEstimate* estimate = found.fit.find(*ball.error);
  if (estimate == nullptr) return {kNone, found.why_not};
  if (!estimate->value) return {kNone, estimate->why_not()};
  return {*estimate->value / (is_linear(ball.error->direction) ? um : urad), ""};
}

std::string_view unit_of_location(const plant::ErrorName& name) {
  return is_linear(name.direction) ? "um" : "urad";
}

}  // namespace servomill::sim
