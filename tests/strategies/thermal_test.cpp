// Temperature compensation: offsets by what temperatures displace the tip by.
#include "strategies/thermal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/identified_heat.h"
#include "strategies/registry.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::thermal_test {
namespace {

constexpr double kReference = 293.15;  // K

Parameters parameters(std::string_view temperatures, double filter, double max = 500.0 * um) {
  Parameters p;
  p.set("temperatures", temperatures);
  p.set("filter_s", filter);
  p.set("max_um", max);
  return p;
}

// Growth of the spindle and of the scale of X.
plant::ErrorModel growth(double EZZ, double EXX_per_m) {
  using plant::operator""_err;
  plant::ErrorModel errors;
  errors.component("EZZ"_err).polynomial = {EZZ};
  errors.component("EXX"_err).polynomial = {0.0, EXX_per_m};
  return errors;
}

IdentifiedMachine machine_with(std::vector<plant::ThermalError> by_body,
                               std::vector<plant::ThermalError> by_sensor) {
  IdentifiedMachine machine = identified_with({});
  auto heat = std::make_shared<IdentifiedHeat>();
  heat->by_body = std::move(by_body);
  heat->by_sensor = std::move(by_sensor);
  heat->reference = kReference;
  machine.heat = heat;
  return machine;
}

TemperatureReading at(double period, double sensor, double body) {
  return {period, {kReference + sensor}, {kReference + body}};
}

// A strategy and the part of one run.
struct Compensated {
  Compensated(const IdentifiedMachine& machine, const Parameters& p)
      : strategy(find("thermal")->make(p, Action::compensate, machine)),
        part(strategy->setpoint()) {}
  std::unique_ptr<Strategy> strategy;
  std::unique_ptr<SetpointPart> part;
};

Joints at_x(double x) {
  Joints Q = Joints::Zero();
  Q[0] = x;
  return Q;
}

// With the offset the tip of the warm machine is where that of the ideal one would be.
TEST(Thermal, RemovesTheErrorsOfItsTemperatures) {
  const plant::ErrorModel per_kelvin = growth(-2.0 * um, 10e-6);
  const IdentifiedMachine machine = machine_with({{0, per_kelvin}}, {{0, per_kelvin}});
  for (const std::string_view temperatures : {"sensors", "network"}) {
    Compensated one(machine, parameters(temperatures, 0.0));
    EXPECT_TRUE(one.part->offset(at_x(0.2)).isZero(0.0)) << "nothing was read";
    one.part->read_temperatures(at(0.0, 3.0, 3.0));
    const plant::VolumetricModel warm(machine.model.chain(), scaled(per_kelvin, 3.0));
    for (const double x : {-0.2, 0.0, 0.3}) {
      const Joints Q = at_x(x);
      const Joints d = one.part->offset(Q);
      EXPECT_NEAR(d[0], -x * 30e-6, 1e-12);
      EXPECT_NEAR(d[2], 6.0 * um, 1e-12);
      const auto wanted = plant::forward(machine.model.chain(), Q, machine.p_ST).p_WT;
      EXPECT_LT((warm.forward(Q + d, machine.p_ST).p_WT - wanted).norm(), 1e-9);
    }
  }
}

TEST(Thermal, ReadsSensorsOrTheNetwork) {
  const IdentifiedMachine machine =
      machine_with({{0, growth(-1.0 * um, 0.0)}}, {{0, growth(-5.0 * um, 0.0)}});
  Compensated sensors(machine, parameters("sensors", 0.0));
  Compensated network(machine, parameters("network", 0.0));
  for (Compensated* one : {&sensors, &network}) one->part->read_temperatures(at(0.0, 2.0, 3.0));
  EXPECT_NEAR(sensors.part->offset(at_x(0.0))[2], 10.0 * um, 1e-15);
  EXPECT_NEAR(network.part->offset(at_x(0.0))[2], 3.0 * um, 1e-15);
}

// A ramp through a filter of first order: y = r (t - tau (1 - e^(-t/tau))), whatever the readings'
// period.
TEST(Thermal, FiltersReadings) {
  constexpr double kTau = 60.0, kRate = 0.01;                                    // s, K/s
  const IdentifiedMachine machine = machine_with({}, {{0, growth(-1.0, 0.0)}});  // 1 m/K
  for (const double period : {0.1, 1.0, 60.0}) {
    Compensated one(machine, parameters("sensors", kTau));
    one.part->read_temperatures(at(0.0, 0.0, 0.0));
    const int readings = static_cast<int>(std::lround(300.0 / period));
    for (int n = 1; n <= readings; ++n) {
      one.part->read_temperatures(at(period, kRate * period * n, 0.0));
    }
    const double wanted = kRate * (300.0 - kTau * (1.0 - std::exp(-300.0 / kTau)));
    EXPECT_NEAR(one.part->offset(at_x(0.0))[2], wanted, 1e-9) << period;
  }
}

TEST(Thermal, StopsBeyondItsLargestOffset) {
  const IdentifiedMachine machine = machine_with({}, {{0, growth(-10.0 * um, 0.0)}});
  Compensated one(machine, parameters("sensors", 0.0, 50.0 * um));
  const auto moved = [&](double rise) {
    one.part->read_temperatures(at(0.0, rise, 0.0));
    Reading now;
    one.part->advance(now);
    return std::string(one.part->failure());
  };
  EXPECT_EQ(moved(4.99), "");
  EXPECT_EQ(moved(5.01), "strategy thermal: offset of Z by 50.1 um; must be <= max_um = 50");
}

TEST(Thermal, NeedsErrorsOfWhatItReads) {
  const plant::ErrorModel some = growth(-1.0 * um, 0.0);
  const auto why = [](const IdentifiedMachine& machine, std::string_view temperatures) {
    try {
      find("thermal")->make(parameters(temperatures, 60.0), Action::compensate, machine);
    } catch (const InputError& error) {
      return error.faults().front().message;
    }
    return std::string();
  };
  EXPECT_EQ(why(machine_with({{0, some}}, {}), "sensors"),
            "temperatures = \"sensors\" needs errors_per_K of a sensor ([heat.sensor.NAME] of the "
            "machine; servomill identify-heat finds them)");
  EXPECT_EQ(why(machine_with({}, {{0, some}}), "network"),
            "temperatures = \"network\" needs errors_per_K of a body ([heat.body.NAME] of the "
            "machine)");
  EXPECT_EQ(why(identified_with({}), "sensors"), "");  // a cause that a budget takes away
}

}  // namespace
}  // namespace servomill::strategies::thermal_test
