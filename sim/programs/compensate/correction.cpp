#include "sim/programs/compensate/correction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {
namespace {

const double kSingular = std::sin(1.0 * deg);  // the strategies' default

strategies::IdentifiedMachine identified_of(const plant::MachineChain& chain,
                                            const plant::ErrorModel& errors) {
  return {.layout = chain.layout, .model = plant::VolumetricModel(chain, errors)};
}

plant::ErrorModel travelling(plant::ErrorModel errors, const Directions& directions) {
  for (std::size_t i = 0; i < errors.components.size(); ++i) {
    for (plant::ErrorFunction& f : errors.components[i]) f = plant::travelling(f, directions[i]);
  }
  return errors;
}

}  // namespace

Correction::Model::Model(const plant::MachineChain& chain, const plant::ErrorModel& errors)
    : identified(identified_of(chain, errors)),
      all(identified, strategies::Iterations::converged, kSingular) {}

Correction::Correction(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                       strategies::DisplacedAxes axes)
    : chain_(chain), errors_(errors), axes_(axes) {
  for (std::size_t i = 0; i < errors.components.size(); ++i) {
    for (const plant::ErrorFunction& f : errors.components[i]) {
      for (const plant::Reversal& one : f.reversals) {
        if (one.is_zero()) continue;
        reverses_[i] = true;
        longest_reversal_ = std::max(longest_reversal_, one.distance);
      }
    }
  }
  model_ =
      models_.emplace(directions_, std::make_unique<Model>(chain_, errors_)).first->second.get();
}

void Correction::set_tool(const Eigen::Vector3d& p_ST) { model_->identified.p_ST = p_ST; }

void Correction::set_directions(const Directions& directions) {
  Directions wanted{};
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = reverses_[i] ? directions[i] : 0;
  if (wanted == directions_) return;
  auto& model = models_[wanted];
  if (model == nullptr) model = std::make_unique<Model>(chain_, travelling(errors_, wanted));
  model->identified.p_ST = model_->identified.p_ST;
  model_ = model.get();
  directions_ = wanted;
}

double Correction::reversal_at(const AxisWords& machine, Axis axis) {
  const auto k = static_cast<std::size_t>(index_of(axis));
  if (!reverses_[k]) return 0.0;
  const Directions before = directions_;
  Directions one = before;
  one[k] = 1;
  set_directions(one);
  const AxisWords up = at(machine);
  one[k] = -1;
  set_directions(one);
  const AxisWords down = at(machine);
  set_directions(before);
  return (up - down).head<3>().norm();
}

AxisWords Correction::at(const AxisWords& machine) const {
  const strategies::IdentifiedMachine& identified = model_->identified;
  const Joints Q = identified.layout.joints(machine);
  AxisWords d = AxisWords::Zero();
  if (axes_ == strategies::DisplacedAxes::all) {
    d = identified.layout.words(model_->all.of_setpoint(strategies::Action::compensate, Q));
  } else {
    d.head<3>() = strategies::setpoint_displacement(identified, strategies::Action::compensate,
                                                    strategies::Iterations::converged, Q);
  }
  return without_left(d);
}

AxisWords Correction::at(const AxisWords& machine, double s) const {
  return offset_ != nullptr ? without_left(layout().words(offset_->at_place(s))) : at(machine);
}

AxisWords Correction::without_left(AxisWords d) const {
  for (int i = 0; i < kLinearJoints; ++i) {
    if (left_[static_cast<std::size_t>(i)]) d[i] = 0.0;
  }
  return d;
}

void Correction::follow(std::shared_ptr<const strategies::PathOffset> offset) {
  offset_ = std::move(offset);
}

std::vector<double> Correction::rows_between(double s_begin, double s_end) const {
  if (offset_ == nullptr) return {};
  const strategies::PathTimes& times = *offset_->times;
  const auto first = std::upper_bound(times.s.begin(), times.s.end(), s_begin);
  const auto from = static_cast<std::size_t>(first - times.s.begin());
  std::vector<double> out;
  for (std::size_t n = (from + times.every - 1) / times.every * times.every;
       n < times.s.size() && times.s[n] < s_end; n += times.every) {
    if (out.empty() || times.s[n] > out.back()) out.push_back(times.s[n]);
  }
  return out;
}

strategies::Residual Correction::residual(const AxisWords& machine) const {
  const strategies::IdentifiedMachine& identified = model_->identified;
  return strategies::uncorrectable(identified, axes_, kSingular, identified.layout.joints(machine));
}

std::vector<double> shares_between_reversals(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                                             double angle, double sweep,
                                             const std::array<bool, kAxisWords>& axes) {
  constexpr double kNothing = 1e-9;
  std::vector<double> shares = {0.0, 1.0};
  for (int i = 0; i < 3; ++i) {
    if (!axes[static_cast<std::size_t>(i)] || std::hypot(x[i], y[i]) < kNothing) continue;
    // the coordinate goes as cos(angle - turn)
    const double turn = std::atan2(y[i], x[i]), low = std::min(angle, angle + sweep);
    const double first = turn + std::numbers::pi * std::ceil((low - turn) / std::numbers::pi);
    for (double at = first; at < low + std::abs(sweep); at += std::numbers::pi) {
      const double share = (at - angle) / sweep;
      if (share > kNothing && share < 1.0 - kNothing) shares.push_back(share);
    }
  }
  std::sort(shares.begin(), shares.end());
  const auto is_same = [](double a, double b) { return b - a < kNothing; };
  shares.erase(std::unique(shares.begin(), shares.end(), is_same), shares.end());
  return shares;
}

}  // namespace servomill::sim::programs
