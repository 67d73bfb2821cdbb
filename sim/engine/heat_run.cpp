#include "sim/engine/heat_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/heat/temperature.h"
#include "plant/sensing/noise.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

}  // namespace

HeatSources::HeatSources(const model::MachineSettings& machine) : heat_(*machine.heat) {
  for (int j = 0; j < kJoints; ++j) ratio_[j] = machine.drives[static_cast<std::size_t>(j)].r;
}

void HeatSources::powers(const HeatInputs& now, VectorXd& out) const {
  out.setZero();
  for (const model::HeatSource& source : heat_.sources) {
    double& P = out[source.body];
    const int j = source.joint;
    switch (source.kind) {
      case model::HeatKind::constant:
        P += source.power;
        break;
      case model::HeatKind::spindle:
        P += source.spindle.value(now.spindle);
        break;
      case model::HeatKind::motor:
        P += source.resistance * now.current[j] * now.current[j];
        break;
      case model::HeatKind::cutting:
        P += source.share * now.cut;
        break;
      case model::HeatKind::friction:
        P += source.share * (now.torque[j] / ratio_[j] + now.load[j]) * now.dQ[j];
        break;
    }
  }
}

plant::ThermalNetwork network_at_start(const model::MachineSettings& machine) {
  const model::HeatSettings& heat = *machine.heat;
  plant::ThermalNetwork network(heat.network);
  const auto n = static_cast<Index>(heat.network.bodies.size());
  if (!heat.start.empty()) {
    network.start(Eigen::Map<const VectorXd>(heat.start.data(), n));
    return network;
  }
  VectorXd at_rest(n);
  HeatSources(machine).powers({}, at_rest);
  network.start(network.settled(at_rest, heat.clock));
  return network;
}

std::string fault_of(const model::HeatSettings& heat, const VectorXd& T) {
  for (Index i = 0; i < T.size(); ++i) {
    const auto body = static_cast<std::size_t>(i);
    if (T[i] >= heat.coldest[body] && T[i] <= heat.warmest[body]) continue;
    return fmt::format("{} is at {:.1f} degC, beyond its limits of {:g} to {:g} degC",
                       heat.network.bodies[body].name, celsius(T[i]), celsius(heat.coldest[body]),
                       celsius(heat.warmest[body]));
  }
  return "";
}

std::vector<double> readings_of(const model::HeatSettings& heat, const VectorXd& T, Tick step,
                                std::uint32_t stream, double noise) {
  std::vector<double> out;
  for (const model::HeatSensor& sensor : heat.sensors) {
    const double white = plant::white_noise({heat.noise_seed, stream++}, 0, step)[0];
    out.push_back(T[sensor.body] + noise * sensor.noise * white);
  }
  return out;
}

HeatBalance::HeatBalance(const model::MachineSettings& machine)
    : sources_(machine), network_(network_at_start(machine)), t_(machine.heat->clock) {
  const double period = machine.nc.periods.seconds(machine.nc.periods.position);
  periods_per_step_ = std::max(1, static_cast<int>(std::lround(kStep / period)));
  const auto n = static_cast<Index>(machine.heat->network.bodies.size());
  power_.resize(n);
  sum_ = VectorXd::Zero(n);
  row_ = VectorXd::Zero(n);
  step_ = period * periods_per_step_;
  course_.step = step_;
  course_.bodies = machine.heat->network.bodies.size();
}

bool HeatBalance::advance(const HeatInputs& now) {
  sources_.powers(now, power_);
  sum_ += power_;
  if (++periods_ < periods_per_step_) return false;
  sum_ /= periods_;
  add_to_course();
  network_.advance(t_, step_, sum_);
  t_ += step_;
  periods_ = 0;
  ++steps_;
  sum_.setZero();
  return true;
}

// Two rows become one where there are too many.
void HeatBalance::add_to_course() {
  std::vector<double>& power = course_.power;
  row_ += sum_;
  if (++steps_in_row_ < steps_per_row_) return;
  row_ /= steps_per_row_;
  power.insert(power.end(), row_.begin(), row_.end());
  row_.setZero();
  steps_in_row_ = 0;
  const std::size_t n = course_.bodies;
  if (power.size() < kMaxRows * n) return;
  for (std::size_t row = 0; row < kMaxRows / 2; ++row) {
    for (std::size_t body = 0; body < n; ++body) {
      power[row * n + body] = 0.5 * (power[2 * row * n + body] + power[(2 * row + 1) * n + body]);
    }
  }
  power.resize(kMaxRows / 2 * n);
  steps_per_row_ *= 2;
  course_.step *= 2.0;
}

// The work of a row that is not full is spread over a whole one.
HeatCourse HeatBalance::course() && {
  if (steps_in_row_ > 0) {
    row_ /= steps_per_row_;
    course_.power.insert(course_.power.end(), row_.begin(), row_.end());
  }
  return std::move(course_);
}

HeatRun::HeatRun(const model::MachineSettings& machine, const plant::ErrorModel& errors,
                 const model::MachineSettings* known)
    : machine_(machine),
      errors_(errors),
      balance_(machine),
      known_(known != nullptr ? std::make_unique<HeatBalance>(*known) : nullptr),
      at_(errors_now()) {
  reading_.sensors = readings_of(*machine.heat, balance_.temperatures(), 0, 0, 0.0);
  if (known_) reading_.bodies.assign(known_->temperatures().begin(), known_->temperatures().end());
}

// Both networks have steps of the same length: that of the position period, which they share.
bool HeatRun::advance(const HeatInputs& now) {
  if (known_) known_->advance(now);
  if (!balance_.advance(now)) return false;
  at_ = errors_now();
  reading_.period = balance_.step();
  reading_.sensors = readings_of(*machine_.heat, balance_.temperatures(), balance_.steps());
  if (known_) reading_.bodies.assign(known_->temperatures().begin(), known_->temperatures().end());
  return true;
}

std::shared_ptr<const plant::VolumetricModel> HeatRun::errors_now() const {
  const model::HeatSettings& heat = *machine_.heat;
  return std::make_shared<const plant::VolumetricModel>(
      machine_.chain,
      plant::at_temperatures(errors_, heat.errors, balance_.temperatures(), heat.reference));
}

std::vector<double> HeatRun::temperatures() const {
  std::vector<double> out(balance_.temperatures().begin(), balance_.temperatures().end());
  for (const double T : readings_of(*machine_.heat, balance_.temperatures(), balance_.steps())) {
    out.push_back(T);
  }
  return out;
}

std::string HeatRun::fault() const { return fault_of(*machine_.heat, balance_.temperatures()); }

void HeatRun::take_courses(CaseResult& out) && {
  out.heat = std::move(balance_).course();
  if (known_) out.known_heat = std::move(*known_).course();
}

}  // namespace servomill::sim::engine
