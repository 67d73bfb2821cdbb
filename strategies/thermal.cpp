#include "strategies/thermal.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/identified_heat.h"

namespace servomill::strategies {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::array<std::string_view, 2> kTemperatures = {"sensors", "network"};

constexpr std::array<ParameterSpec, 3> kSpecs = {{
    {.name = "temperatures",
     .help = "sensors: readings, with the errors_per_K of the sensors; network: temperatures "
             "computed by the thermal network of the known machine",
     .default_text = "sensors",
     .is_number = false,
     .words = kTemperatures},
    {.name = "filter_s",
     .help = "time constant of the temperature filter; 0: no filter",
     .unit = "s",
     .default_text = "60",
     .min = 0.0,
     .max = 3600.0,
     .shortcoming = Shortcoming::delay,
     .ideal = "0"},
    {.name = "max_um",
     .help = "maximum offset of a linear axis; a larger offset ends the case",
     .unit = "um",
     .default_text = "500",
     .min = 0.0,
     .max = 10000.0},
}};

struct Knowledge {
  std::vector<plant::ThermalError> errors;
  double reference = 0.0;  // K
  bool of_sensors = true;
  double filter = 0.0;  // s, time constant
  double max = 0.0;     // m
};

// Filter of first order of values that are linear between readings,
//
//     y_1 = u_1 - r tau + (y_0 - u_0 + r tau) e^(-h / tau),   r = (u_1 - u_0) / h
class LowPass {
 public:
  explicit LowPass(double tau) : tau_(tau) {}

  // Value at which it has settled.
  void start(const VectorXd& u) { u_ = y_ = u; }
  void advance(const VectorXd& u, double h) {
    if (!(tau_ > 0.0)) {
      start(u);
      return;
    }
    const double decay = std::exp(-h / tau_);
    const VectorXd lag = (u - u_) * (tau_ / h);
    y_ = u - lag + decay * (y_ - u_ + lag);
    u_ = u;
  }
  const VectorXd& value() const { return y_; }

 private:
  double tau_;
  VectorXd u_, y_;
};

class TemperatureOffset final : public SetpointPart {
 public:
  TemperatureOffset(const IdentifiedMachine& identified, const Knowledge& knowledge)
      : identified_(identified), knowledge_(knowledge), filtered_(knowledge.filter) {}

  SetpointEntry entry() const override { return {.entry = EntryPoint::position_command}; }

  void read_temperatures(const TemperatureReading& now) override {
    const std::vector<double>& all = knowledge_.of_sensors ? now.sensors : now.bodies;
    const VectorXd T = Eigen::Map<const VectorXd>(all.data(), static_cast<Index>(all.size()));
    if (errors_ == nullptr || !(now.period > 0.0)) {
      filtered_.start(T);
    } else {
      filtered_.advance(T, now.period);
    }
    errors_ = std::make_unique<plant::VolumetricModel>(
        identified_.model.chain(),
        plant::at_temperatures({}, knowledge_.errors, filtered_.value(), knowledge_.reference));
  }

  Joints offset(const Joints& Q_ref) const override {
    Joints out = Joints::Zero();
    if (errors_ == nullptr) return out;
    out.head<kLinearJoints>() = -errors_->joint_offset(Q_ref, identified_.p_ST);
    return out;
  }

  Joints advance(const Reading& now) override {
    const Joints out = offset(now.Q_ref);
    for (int j = 0; j < kLinearJoints && failure_.empty(); ++j) {
      if (!(std::abs(out[j]) > knowledge_.max)) continue;
      failure_ =
          fmt::format("strategy thermal: offset of {} by {:.4g} um; must be <= max_um = {:g}",
                      identified_.layout.letter_of(j), out[j] / um, knowledge_.max / um);
    }
    return out;
  }

  std::string_view failure() const override { return failure_; }

 private:
  const IdentifiedMachine& identified_;
  const Knowledge& knowledge_;
  LowPass filtered_;
  std::unique_ptr<plant::VolumetricModel> errors_;  // at the temperatures; nullptr: none read
  std::string failure_;
};

class TemperatureCompensation final : public Strategy {
 public:
  TemperatureCompensation(IdentifiedMachine identified, Knowledge knowledge)
      : identified_(std::move(identified)), knowledge_(std::move(knowledge)) {}

  std::unique_ptr<SetpointPart> setpoint() const override {
    return std::make_unique<TemperatureOffset>(identified_, knowledge_);
  }

 private:
  IdentifiedMachine identified_;
  Knowledge knowledge_;
};

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  Knowledge knowledge;
  knowledge.of_sensors = p.word("temperatures") == "sensors";
  knowledge.filter = p.number("filter_s");
  knowledge.max = p.number("max_um");
  if (identified.heat != nullptr) {
    knowledge.errors = knowledge.of_sensors ? identified.heat->by_sensor : identified.heat->by_body;
    knowledge.reference = identified.heat->reference;
    if (knowledge.errors.empty()) {
      throw InputError(
          {}, knowledge.of_sensors
                  ? "temperatures = \"sensors\" needs errors_per_K of a sensor "
                    "([heat.sensor.NAME] of the machine; servomill identify-heat finds them)"
                  : "temperatures = \"network\" needs errors_per_K of a body ([heat.body.NAME] of "
                    "the machine)");
    }
  }
  return std::make_unique<TemperatureCompensation>(identified, std::move(knowledge));
}

}  // namespace

Entry thermal_entry() {
  Entry entry = {
      "thermal",
      "offsets the setpoint against thermal errors, from measured or computed temperatures", kSpecs,
      make};
  entry.once = true;
  entry.corrects_heat = true;
  entry.computes_heat = [](const Parameters& p) { return p.word("temperatures") == "network"; };
  entry.reads_errors = false;
  entry.imposes = false;
  return entry;
}

}  // namespace servomill::strategies
