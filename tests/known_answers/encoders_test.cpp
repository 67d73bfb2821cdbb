/// Effect of encoders and screws on an axis whose loop is closed over them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "plant/drives/screw_error.h"
#include "plant/sensing/reference_marks.h"
#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/run_output.h"
#include "tests/pattern.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::encoders_test {
namespace {

constexpr double kKv = 500.0 / 6.0;  // 1/s, of the machine file

// X with a scale and a motor encoder that have no steps, and what `axis` says.
model::Scenario with_axis(const std::string& program, const std::string& axis,
                          const std::string& more = "[[case]]\nname = \"alone\"\n") {
  return small_scenario(program + "M30\n",
                        "record = { settle_ms = 500.0 }\n[machine_override.axis.X]\n"
                        "scale_step = 0.0\nmotor_step = 0.0\n" +
                            axis + more);
}

records::Series run(const model::Scenario& scenario, const std::string& name = "alone") {
  return run_named_case(scenario, name).result.servo;
}

double last(const records::Series& series, const std::string& name) {  // mm, of X
  return series.at(series.rows() - 1, *series.column(name, 'X'));
}

// Half the range (um) of true minus interpolated position of X.
double ripple(const records::Series& series, double from, double to) {
  const std::size_t ref = *series.column("ref_linear", 'X'),
                    actual = *series.column("true_linear", 'X');
  double low = 1e9, high = -1e9;
  for (const std::size_t n : rows_within(series, from, to)) {
    const double e = (series.at(n, actual) - series.at(n, ref)) * 1e3;
    low = std::min(low, e);
    high = std::max(high, e);
  }
  return 0.5 * (high - low);
}

constexpr const char* kOffsetSine = "scale = { period = \"20 um\", sine_offset = 0.05 }\n";

// The loop holds the reading, so that the slide carries the error: o P / (2 pi).
TEST(PeriodError, MovesASlowSlideByItsAmplitude) {
  const double amplitude = 0.05 * 20.0 / (2.0 * std::numbers::pi);  // um
  constexpr double kTol = 0.01;  // share: loop at 0.8 Hz 0.2 %, third harmonic o^2, rows
  const double got = ripple(run(with_axis("G1 X0.07 F1\n", kOffsetSine)), 0.02, 0.06);
  RecordProperty("ripple_um", fmt::format("{:.5f}", got));
  EXPECT_NEAR(got, amplitude, kTol * amplitude);
}

// A signal of 500 Hz is beyond what the position loop follows.
TEST(PeriodError, HardlyMovesAFastSlide) {
  const double amplitude = 0.05 * 20.0 / (2.0 * std::numbers::pi);
  const double got = ripple(run(with_axis("G1 X6 F600\n", kOffsetSine)), 3.0, 5.0);
  RecordProperty("ripple_um", fmt::format("{:.5f}", got));
  EXPECT_LT(got, 0.1 * amplitude);
}

model::Scenario noisy(int seed) {
  std::string cases;
  for (int n = 0; n < 4; ++n) cases += fmt::format("[[case]]\nname = \"{}\"\n", n);
  return small_scenario(
      "G1 X1 F3000\nM30\n",
      fmt::format("machine_override.noise_seed = {}\nmachine_override.axis.X.scale = {{ period = "
                  "\"20 um\", position_noise = \"50 nm\" }}\n{}",
                  seed, cases));
}

TEST(EncoderNoise, IsThatOfItsSeedForAnyNumberOfThreads) {
  const auto data = [](int seed, unsigned threads) {
    run::RunControl control;
    control.threads = threads;
    std::vector<std::vector<double>> out;
    for (const run::CaseOutput& one : run::run_scenario(noisy(seed), control).cases) {
      out.push_back(one.result.servo.by_rows());
    }
    return out;
  };
  const auto one = data(7, 1);
  EXPECT_GT(one[0].size(), 1000U);
  EXPECT_EQ(one, data(7, 4));
  EXPECT_NE(one[0], data(8, 1)[0]);
}

constexpr double kExact = 1e-3;  // um, what is left after half a second of settling
constexpr const char* kAtMotor = "position_feedback = \"motor\"\n";
constexpr const char* kLead =
    "screw.lead_error.harmonic = { amplitude_um = 8.0, period_mm = 40.0 }\n";

// um, by which the slide stands beside its setpoint in the end
double offset(const model::Scenario& scenario, const std::string& name = "alone") {
  const records::Series series = run(scenario, name);
  return (last(series, "true_linear") - last(series, "cmd_linear")) * 1e3;
}

TEST(LeadError, StaysOnTheSlideWithMotorFeedback) {
  for (const double x : {10.0, 17.0, 33.0}) {
    double e = 0.0;  // um; x + e is where the nut is
    for (int n = 0; n < 20; ++n) {
      e = 8.0 * std::sin(2.0 * std::numbers::pi * (x + 1e-3 * e) / 40.0);
    }
    const std::string program = fmt::format("G1 X{} F6000\n", x);
    EXPECT_NEAR(offset(with_axis(program, std::string(kAtMotor) + kLead)), e, kExact) << x;
    EXPECT_NEAR(offset(with_axis(program, kLead)), 0.0, kExact) << "scale, " << x;
  }
}

// A step of 1 um, for a program has to move, and standing.
constexpr const char* kDwell = "G1 X0.001 F6000\nG4 P1.5\n";

// e(t) = alpha dT (1 - exp(-t/tau)) (x - x_fixed): 46 um in the end, with tau = 1 s
constexpr const char* kGrowth =
    "screw = { expansion = \"11.5 um/m/K\", fixed_at = \"-400 mm\", temperature_rise = \"10 K\", "
    "thermal_time_constant = \"1 s\" }\n";
constexpr double kGrown = 11.5e-6 * 10.0 * 0.4e6;  // um
constexpr double kWarmingTol = 0.01;               // um, what the loops leave of a ramp that decays

void expect_offset(const std::string& axis, double (*expected)(double t)) {
  const records::Series series = run(with_axis(kDwell, axis));
  const std::size_t actual = *series.column("true_linear", 'X'),
                    cmd = *series.column("cmd_linear", 'X'), time = *series.column("time");
  for (const std::size_t row : {200U, 500U, 1000U, 1900U}) {
    const double t = series.at(row, time);
    EXPECT_NEAR((series.at(row, actual) - series.at(row, cmd)) * 1e3, expected(t), kWarmingTol)
        << t;
  }
}

// The motor stands, and the slide is where the screw takes it.
TEST(ScrewGrowth, MovesTheSlideWithMotorFeedback) {
  expect_offset(std::string(kAtMotor) + kGrowth,
                [](double t) { return kGrown * (1.0 - std::exp(-t)); });
}

// The motor has to turn back at de/dt, for which the position loop needs an error of (de/dt) / Kv.
TEST(ScrewGrowth, LeavesItsRateOverKvWithScaleFeedback) {
  expect_offset(kGrowth, [](double t) { return kGrown * std::exp(-t) / kKv; });
}

// Difference (um) of where the slide stands at X5 from below and from above.
double lost_motion(const std::string& axis) {
  const std::string all = "backlash = \"10 um\"\nfriction.model = \"set_valued\"\n" + axis;
  return offset(with_axis("G1 X5 F60\n", all)) - offset(with_axis("G1 X7 F60\nX5\n", all));
}

// Approached from above the slide stands higher, by the gap and the wind-up under friction.
TEST(Backlash, IsLostWithMotorFeedbackUnlessTheNcAddsIt) {
  constexpr double kWindUp = 2.0 * 450.0 / 2.2e8 * 1e6;  // um, between +Fc and -Fc
  const std::string compensation = "backlash_compensation = { width = \"10 um\" }\n";
  const double lost = -lost_motion(kAtMotor), left = -lost_motion(kAtMotor + compensation);
  RecordProperty("lost_um", fmt::format("{:.3f}", lost));
  RecordProperty("left_um", fmt::format("{:.3f}", left));
  EXPECT_GE(lost, 10.0);
  EXPECT_LE(lost, 10.0 + kWindUp);
  EXPECT_GE(left, 0.0);
  EXPECT_LE(left, kWindUp);
  EXPECT_NEAR(lost - left, 10.0, 0.01) << "the compensation gives the whole gap back";
}

// Why the NC stopped the only case.
std::string stopped(const model::Scenario& scenario) {
  static const engine::StopFlag kNever = false;
  std::atomic<float> progress = 0.0F;
  const engine::Outcome outcome =
      run::run_case(preparation::PreparedCase(scenario, scenario.cases.front()), kNever, progress)
          .result.outcome;
  EXPECT_EQ(outcome.finished, outcome.reason.empty());
  return outcome.reason;
}

model::Scenario displaced(const std::string& amplitude) {
  return with_axis("G1 X60 F3000\n",
                   "[machine_override.axis.X.scale]\nperiod = \"20 um\"\n"
                   "[machine_override.axis.X.marks]\nincrement = 1000\n",
                   "[errors.imposed]\nEXX = { harmonic = { amplitude_um = " + amplitude +
                       ", period_mm = 50.0 } }\n[[case]]\nname = \"alone\"\n"
                       "[[case.strategy]]\ntype = \"feedback\"\nmodel = \"imposed\"\n"
                       "action = \"impose\"\nmax_um = 500.0\nmax_rate_mm_per_s = 100.0\n");
}

// +-150 um over 50 mm changes by up to 170 um from mark to mark, 8 periods of 20 um.
TEST(ReferenceMarks, StopTheMachineWhenTheVirtualEncoderFalsifiesTheirCount) {
  const std::string reason = stopped(displaced("150.0"));
  RecordProperty("reason", reason);
  const std::vector<std::string> part =
      Pattern(
          "axis X: counted (\\d+) signal periods instead of (\\d+) between the reference "
          "marks at (-?[0-9.]+) and ([0-9.]+) mm at [0-9.]+ s")
          .parts_of(reason);
  ASSERT_FALSE(part.empty()) << reason;
  const double from = std::stod(part[3]), to = std::stod(part[4]);
  EXPECT_NEAR((to - from) / 0.02, std::stod(part[2]), 0.06);
  // the reading lacks what the slide is to be displaced by
  const auto d = [](double x) { return -150.0 * std::sin(2.0 * std::numbers::pi * x / 50.0); };
  EXPECT_EQ(std::stod(part[1]) - std::stod(part[2]), std::round((d(to) - d(from)) / 20.0));
}

// Half a period, 10 um, from mark to mark is what the count bears.
TEST(ReferenceMarks, BearADisplacementThatChangesByLessThanHalfAPeriod) {
  EXPECT_EQ(stopped(displaced("5.0")), "");
  EXPECT_NE(stopped(displaced("12.0")), "");
}

// 46 um (1 - exp(-t)) of growth pass 30 um at t = ln(46 / 16).
TEST(EncoderDifference, StopsTheMachineWhenTheScrewHasGrown) {
  const std::string reason =
      stopped(with_axis(kDwell, std::string("encoder_difference_limit = \"30 um\"\n") + kGrowth));
  constexpr double kPeriod = 0.2e-3;
  const double t = std::ceil(std::log(46.0 / 16.0) / kPeriod) * kPeriod;
  EXPECT_EQ(reason, fmt::format("axis X: difference of scale and motor encoder beyond 0.03 mm at "
                                "{:.4f} s",
                                t));
}

// Without integral part, friction holds the axis beside its target: 100 ms are granted to settle.
TEST(Standstill, BesideTheTargetStopsTheMachine) {
  const std::string axis =
      "friction.model = \"set_valued\"\nvelocity_reset_time_ms = 0.0\nstandstill_limit = ";
  const std::string program = "G1 X1 F600\n";
  const std::string reason = stopped(with_axis(program, axis + "\"1 um\"\n"));
  const double end = run_named_case(with_axis(program, axis + "\"25 um\"\n"), "alone").duration;
  const std::string expected = "axis X: position at standstill beyond 0.001 mm at ";
  ASSERT_EQ(reason.substr(0, expected.size()), expected);
  EXPECT_NEAR(std::stod(reason.substr(expected.size())), end + 0.1, 1e-3);
}

// 1 kHz at 20 um are 20 mm/s.
TEST(EncoderInput, StopsTheMachineWhenTheSignalsAreTooFast) {
  const std::string scale = "scale = { period = \"20 um\", frequency_limit_kHz = 1.0 }\n";
  EXPECT_EQ(stopped(with_axis("G1 X5 F1100\n", scale)), "");
  const std::string reason = stopped(with_axis("G1 X5 F1800\n", scale));
  const Pattern beyond(
      "axis X: signals of the scale at 1\\.0[0-9]* kHz, beyond the 1 kHz of the input at [0-9.]+ "
      "s");
  EXPECT_TRUE(beyond.matches(reason)) << reason;
}

}  // namespace
}  // namespace servomill::sim::encoders_test
