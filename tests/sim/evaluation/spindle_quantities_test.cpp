// The synchronisation error of G33 and G33.1.
#include "sim/evaluation/spindle_quantities.h"

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::evaluation::spindle_quantities_test {
namespace {

constexpr double kKv = 25.0;  // 1/s

model::SpindleDrive spindle(double feed_forward) {
  return {.Kv = kKv, .velocity_feed_forward = feed_forward};
}

TEST(SpindleLag, IsThatOfAFirstOrderLoop) {
  for (const double feed_forward : {0.0, 0.4, 1.0}) {
    SpindleLag lag(spindle(feed_forward));
    const double v = 30 * mm, dt = 1 * ms;
    for (int n = 1; n <= 200; ++n) {
      lag.advance(v * dt, dt);
      const double known = (1.0 - feed_forward) * v / kKv * (1.0 - std::exp(-kKv * n * dt));
      ASSERT_NEAR(lag.value(), known, 1e-15);
    }
    lag.reverse();
    const double before = lag.value();
    lag.advance(0.0, 10 * ms);  // stands
    EXPECT_NEAR(lag.value(), before * std::exp(-kKv * 10 * ms), 1e-15);
    lag.advance(0.0, 0.0);
    EXPECT_NEAR(lag.value(), before * std::exp(-kKv * 10 * ms), 1e-15);
  }
}

// Against a loop of a microsecond's steps, for a way of changing speed.
TEST(SpindleLag, ConvergesWithTheSquareOfTheStep) {
  const auto x = [](double t) { return 5 * mm * (1.0 - std::cos(8.0 * t)); };
  const auto lag_at = [&](double end, int steps) {
    SpindleLag lag(spindle(0.3));
    const double dt = end / steps;
    for (int n = 0; n < steps; ++n) lag.advance(x((n + 1) * dt) - x(n * dt), dt);
    return lag.value();
  };
  const double known = lag_at(0.5, 500000);
  const double coarse = lag_at(0.5, 50) - known, fine = lag_at(0.5, 100) - known;
  EXPECT_NEAR(coarse / fine, 4.0, 0.1);
}

// A machine in lag mode: Z lags by v / Kv, the spindle by v / Kv of its own. While the tap goes at
// constant speed, the difference of both is left; the spindle is slow enough for the inner loops.
TEST(SynchronisationError, IsTheDifferenceOfTheLags) {
  const auto errors = [](double Kv_of_spindle, double feed_forward) {
    const std::string quantity =
        "[[quantity]]\nname = \"synchronisation_error\"\nstatistic = \"max\"\n";
    const model::Scenario scenario = small_scenario(
        "S1200 M3\nG0 Z20\nG4 P1\nG33.1 Z-20 K1\nM2\n",
        "[[case]]\nname = \"one\"\n" + quantity + "[machine_override.nc]\n" +
            fmt::format(
                "velocity_feed_forward = 0.0\nspindle = {{ acceleration_rpm_per_s = 2000.0, "
                "Kv = {}, velocity_feed_forward = {} }}\n",
                Kv_of_spindle, feed_forward));
    const run::CaseOutput output = run_named_case(scenario, "one");
    const CaseData data = output.data();
    return compare(scenario.quantities, {&data, 1}).front().value * um;
  };
  const double v = 1200.0 / 60.0 * 1 * mm;
  const double Kv = small_scenario("M2\n", "[[case]]\nname = \"one\"\n").machine.nc.cascade[2].Kv;
  EXPECT_NEAR(std::abs(errors(2.0 * Kv, 0.0)), v / Kv - v / (2.0 * Kv), 0.02 * v / Kv);
  EXPECT_NEAR(std::abs(errors(0.5 * Kv, 0.0)), v / (0.5 * Kv) - v / Kv, 0.02 * v / Kv);
  EXPECT_NEAR(std::abs(errors(Kv, 1.0)), v / Kv, 0.02 * v / Kv);
  EXPECT_LT(std::abs(errors(Kv, 0.0)), 0.05 * v / Kv);  // alike but for the inner loops
}

TEST(SynchronisationError, IsNotKnownWithoutTheGainOfTheSpindle) {
  const auto note = [](const std::string& program, const std::string& spindle) {
    const model::Scenario scenario = small_scenario(
        program,
        "[[case]]\nname = \"one\"\n[[quantity]]\nname = \"synchronisation_error\"\n" + spindle);
    const run::CaseOutput output = run_named_case(scenario, "one");
    const CaseData data = output.data();
    const ComparisonRow row = compare(scenario.quantities, {&data, 1}).front();
    EXPECT_TRUE(std::isnan(row.value));
    return row.note;
  };
  const std::string tap = "S1200 M3\nG33.1 Z-2 K1\nM2\n";
  EXPECT_EQ(note(tap, ""),
            "the gain of the spindle is not known: no nc.spindle.Kv in the machine file");
  EXPECT_EQ(note(tap, "[machine_override.nc.spindle]\nacceleration_rpm_per_s = 1000.0\n"),
            "the gain of the spindle is not known: no nc.spindle.Kv in the machine file");
  EXPECT_EQ(note("G1 X1 F500\nM2\n", ""), "the program has no G33 and no G33.1");
}

}  // namespace
}  // namespace servomill::sim::evaluation::spindle_quantities_test
