/// Responses measured in the simulation against the exact ones.
#include "sim/frequency/measured_response.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/margins.h"
#include "sim/frequency/stability.h"
#include "sim/frequency/step_response.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency::measured_response_test {
namespace {

constexpr double kMagnitudeTol = 0.1;  // dB, wanted of a measurement
constexpr double kPhaseTol = 1.0;      // deg

model::MachineSettings hsm600u() {
  return input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
}

void use_CC422(model::MachineSettings& machine) {
  machine.nc.periods.position = 180;
  machine.nc.periods.velocity = 60;
  for (auto& cascade : machine.nc.cascade) cascade.Tv = 0.6e-3;
}

struct Deviation {
  double dB = 0.0, deg = 0.0;
};

struct Of {
  const char* name;
  PositionLoop loop;
  Entry entry;
  AxisSignal output;
  int input;  // a signal, or -1: what is fed in
};

Complex taken(const Of& of, const Response& response) {
  const Complex y = response[index_of(of.output)];
  return of.input < 0 ? y : y / response[static_cast<std::size_t>(of.input)];
}

Deviation largest_deviation(const model::MachineSettings& machine, int joint, Tick delay,
                            const Of& of, const MeasuredResponse& measured) {
  FrequencyResponse exact(machine, joint, delay, of.loop);
  Deviation worst;
  for (const MeasuredPoint& point : measured.points) {
    const Complex q = taken(of, point.response) / taken(of, exact.at(of.entry, point.f));
    worst.dB = std::max(worst.dB, std::abs(20.0 * std::log10(std::abs(q))));
    worst.deg = std::max(worst.deg, std::abs(std::arg(q)) / deg);
  }
  return worst;
}

constexpr int kOfInput = -1;
constexpr std::array<Of, 6> kAll = {{
    {"position_closed", PositionLoop::closed, Entry::setpoint, AxisSignal::position, kOfInput},
    {"position_open", PositionLoop::closed, Entry::setpoint, AxisSignal::reading,
     static_cast<int>(AxisSignal::position_error)},
    {"position_fed_forward", PositionLoop::closed, Entry::setpoint_fed_forward,
     AxisSignal::position, kOfInput},
    {"velocity_closed", PositionLoop::open, Entry::velocity_command, AxisSignal::motor_speed,
     kOfInput},
    {"velocity_open", PositionLoop::open, Entry::velocity_command, AxisSignal::measured_speed,
     static_cast<int>(AxisSignal::speed_error)},
    {"compliance", PositionLoop::closed, Entry::force, AxisSignal::position, kOfInput},
}};

// Up to 0.4 times the rate of the loop, for presets and axes of each kind.
TEST(MeasuredResponse, OfALinearDriveIsTheExactOne) {
  constexpr int kY = 1, kC = 4;
  for (const bool slow : {false, true}) {
    for (const int joint : {kY, kC}) {
      if (joint == kC && !slow) continue;
      model::MachineSettings machine = linearised(hsm600u());
      machine.nc.cascade[static_cast<std::size_t>(joint)].i_max = 1e9;
      if (slow) use_CC422(machine);
      for (const Of& of : kAll) {
        const model::LoopPeriods& p = machine.nc.periods;
        const double rate =
            1.0 / p.seconds(of.loop == PositionLoop::closed ? p.position : p.velocity);
        const Tick delay = slow ? 3 : 1;
        const auto f = logarithmic(5.0, 0.4 * rate, 4);
        const MeasuredResponse measured =
            measure(machine, joint, delay, of.loop, {.entry = of.entry, .amplitude = 1.0}, f);
        const Deviation worst = largest_deviation(machine, joint, delay, of, measured);
        RecordProperty(fmt::format("{}_{}_{}", of.name, joint, slow ? "CC422" : "CC424"),
                       fmt::format("{:.2e} dB {:.2e} deg", worst.dB, worst.deg));
        EXPECT_LT(worst.dB, kMagnitudeTol) << of.name << " joint " << joint;
        EXPECT_LT(worst.deg, kPhaseTol) << of.name << " joint " << joint;
      }
    }
  }
}

TEST(MeasuredResponse, OfAMultiSineIsTheExactOne) {
  constexpr int kY = 1;
  const model::MachineSettings machine = linearised(hsm600u());
  const Measurement how{.entry = Entry::setpoint, .method = Method::multi_sine, .amplitude = 1.0};
  const auto wanted = logarithmic(10.0, 2000.0, 12);
  const MeasuredResponse measured = measure(machine, kY, 0, PositionLoop::closed, how, wanted);
  ASSERT_EQ(measured.points.size(), wanted.size());
  const Deviation worst = largest_deviation(machine, kY, 0, kAll[0], measured);
  RecordProperty("crest_factor", fmt::format("{:.2f}", measured.crest_factor));
  EXPECT_LT(worst.dB, kMagnitudeTol);
  EXPECT_LT(worst.deg, kPhaseTol);
  // 12 sinusoids in phase have sqrt(2 * 12) = 4.9
  EXPECT_LT(measured.crest_factor, 4.0);
}

// Friction that does not stick is a constant force; friction that does, is not.
TEST(MeasuredResponse, OfAnAxisWithFrictionIsTheLinearOneWhileItMoves) {
  constexpr int kY = 1;
  constexpr double kLow = 3.0;  // Hz
  model::MachineSettings machine = hsm600u();
  machine.drives[kY].friction.kind = plant::FrictionKind::set_valued;
  Measurement how{.entry = Entry::setpoint};
  how.amplitude = default_amplitude(machine, kY, how.entry);
  how.velocity = default_velocity(machine, kY, how.entry, how.amplitude);
  const auto deviation = [&] {
    return largest_deviation(machine, kY, 0, kAll[0],
                             measure(machine, kY, 0, PositionLoop::closed, how, {kLow}));
  };
  const Deviation moving = deviation();
  how.velocity = 0.0;
  const Deviation standing = deviation();
  RecordProperty("moving", fmt::format("{:.3f} dB {:.2f} deg", moving.dB, moving.deg));
  RecordProperty("standing", fmt::format("{:.3f} dB {:.2f} deg", standing.dB, standing.deg));
  EXPECT_LT(moving.dB, kMagnitudeTol);
  EXPECT_LT(moving.deg, kPhaseTol);
  EXPECT_GT(standing.dB, 10.0 * kMagnitudeTol);
}

// Settings that a run refuses are refused here, too.
TEST(MeasuredResponse, SaysWhenTheStepDoesNotResolveTheFriction) {
  constexpr int kX = 0;
  model::MachineSettings machine = hsm600u();
  machine.drives[kX].friction = {};
  machine.drives[kX].friction.kind = plant::FrictionKind::set_valued;
  machine.drives[kX].friction.Fs_positive = machine.drives[kX].friction.Fs_negative = 450.0;
  machine.drives[kX].friction.vs = 1e-9;
  Measurement how{.entry = Entry::setpoint};
  how.amplitude = default_amplitude(machine, kX, how.entry);  // reverses, so that it sticks
  const auto measured = [&] {
    return measure(machine, kX, 0, PositionLoop::closed, how, {5.0}).fault;
  };
  const auto stepped = [&] {
    StepSettings step;
    step.amplitude = 1e-4;
    step.duration = 0.05;
    return step_response(machine, kX, 0, step).fault;
  };
  constexpr auto kWhy = "friction too stiff for the exact integrator; use integrator = \"cvode\"";
  EXPECT_EQ(measured(), kWhy);
  EXPECT_EQ(stepped(), kWhy);
  machine.drives[kX].friction.vs = 1e-3;
  EXPECT_EQ(measured(), std::nullopt);
  EXPECT_EQ(stepped(), std::nullopt);
}

TEST(MeasuredResponse, SaysWhenTheCurrentIsLimited) {
  constexpr int kY = 1;
  model::MachineSettings machine = linearised(hsm600u());
  const double most = machine.nc.cascade[kY].i_max = hsm600u().nc.cascade[kY].i_max;
  const auto run = [&](double amplitude) {
    const Measurement how{.entry = Entry::velocity_command, .amplitude = amplitude};
    return measure(machine, kY, 0, PositionLoop::open, how, {300.0});
  };
  const double small = default_amplitude(machine, kY, Entry::velocity_command);
  const MeasuredResponse calm = run(small);
  EXPECT_FALSE(calm.current_limited);
  // the drive lags, so that its current stays below the limit on which the command is
  const MeasuredResponse loud = run(small / 0.02 * 1.5);
  EXPECT_TRUE(loud.current_limited);
  EXPECT_LT(loud.peak_current, most);
}

// A ratio that counts as a measurement is right to a little more than the share that the encoders
// may add to output and input; high frequencies of C move less than a step of its encoder.
TEST(MeasuredResponse, TellsWhatTheEncodersDoNotResolve) {
  constexpr int kC = 4;
  constexpr double kTol = 2.5 * kMaxAdded;
  const model::MachineSettings machine = hsm600u();
  const std::vector<double> wanted = {30.0, 300.0, 1000.0, 2000.0};
  const auto count = [&](const Of& of, double share) {
    const auto input = static_cast<AxisSignal>(of.input);
    const Measurement how{.entry = of.entry,
                          .amplitude = share * default_amplitude(machine, kC, of.entry)};
    FrequencyResponse exact(machine, kC, 0, of.loop);
    int known = 0;
    for (const MeasuredPoint& point : measure(machine, kC, 0, of.loop, how, wanted).points) {
      if (!resolved(point, of.output, input)) continue;
      ++known;
      const Complex q = taken(of, point.response) / taken(of, exact.at(of.entry, point.f));
      EXPECT_LT(std::abs(q - 1.0), kTol) << of.name << " at " << point.f;
    }
    return known;
  };
  for (const Of& of : {kAll[1], kAll[4]}) {
    const int fewer = count(of, 0.02), few = count(of, 1.0);
    EXPECT_LT(few, static_cast<int>(wanted.size())) << of.name;
    EXPECT_GT(few, 0) << of.name;
    EXPECT_LT(fewer, few) << of.name;
  }
}

}  // namespace
}  // namespace servomill::sim::frequency::measured_response_test
