#include "sim/run/day_correction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/identified_heat.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::run {
namespace {

using Eigen::VectorXd;

constexpr std::uint32_t kNoiseOfReadings = 2000;  // first stream; others of the sensors come before

}  // namespace

DayCorrection::DayCorrection(const preparation::PreparedParts& parts,
                             std::vector<PowerStep> known_cycle)
    : heat_(*parts.scenario.machine_of(parts.spec).heat), cycle_(std::move(known_cycle)) {
  for (std::size_t k = 0; k < parts.strategies.size(); ++k) {
    if (!parts.spec.strategies[k].entry->corrects_heat) continue;
    if (auto part = parts.strategies[k]->setpoint()) parts_.push_back(std::move(part));
  }
  const model::MachineSettings* known =
      preparation::known_heat_of(parts.spec, parts.scenario.machine_of(parts.spec));
  if (known == nullptr) return;
  known_.emplace(Known{engine::HeatSources(*known), engine::network_at_start(*known), {}});
  known_->power.setZero(known_->network.temperatures().size());
}

void DayCorrection::begin(const VectorXd& T) { read(T, 0.0); }

void DayCorrection::use(const engine::HeatInputs& causes) {
  if (known_) known_->sources.powers(causes, known_->power);
}

void DayCorrection::use(std::size_t step) {
  if (known_ && step < cycle_.size()) known_->power = cycle_[step].power;
}

void DayCorrection::advance(double t, double h, const VectorXd& T) {
  if (known_) known_->network.advance(t, h, known_->power);
  if (!parts_.empty()) read(T, h);
}

void DayCorrection::read(const VectorXd& T, double h) {
  strategies::TemperatureReading now;
  now.period = h;
  // mean of white readings, one in each step of a run
  const double noise = h > 0.0 ? std::sqrt(std::min(1.0, engine::HeatBalance::kStep / h)) : 0.0;
  now.sensors = engine::readings_of(heat_, T, readings_++, kNoiseOfReadings, noise);
  if (known_) {
    const VectorXd& bodies = known_->network.temperatures();
    now.bodies.assign(bodies.begin(), bodies.end());
  }
  for (const auto& part : parts_) part->read_temperatures(now);
}

Joints DayCorrection::offset(const Joints& Q) {
  strategies::Reading now;
  now.Q_ref = Q;
  Joints out = Joints::Zero();
  for (const auto& part : parts_) out += part->advance(now);
  return out;
}

std::string DayCorrection::failure() const {
  for (const auto& part : parts_) {
    if (!part->failure().empty()) return std::string(part->failure());
  }
  return {};
}

}  // namespace servomill::sim::run
