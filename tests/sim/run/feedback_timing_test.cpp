/// When a virtual displacement reaches the loops: the last paragraph of "Timing of the sampled
/// loops" in scenarios/machines/README.md.
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::feedback_timing_test {
namespace {

constexpr double kSlope = 1e-3;                            // of EXX over X
constexpr std::size_t kModelPeriod = 6, kSignalDelay = 1;  // ticks, the defaults
constexpr std::size_t kPositionPeriod = 3;

// All loops run every third tick, nothing rounds a reading, and each tick is a row.
const records::Series& every_tick() {
  static const CaseOutput kOutput = [] {
    model::Scenario scenario = small_scenario(
        "G1 X1 F1200\nM2\n",
        "[machine_override.nc]\nposition_period_us = 30.0\nvelocity_period_us = 30.0\n"
        "current_period_us = 30.0\n"
        "[record]\nperiod_ms = 0.01\nresolution_nm = 0.0\nsettle_ms = 0.0\n"
        "[errors.known]\nEXX = { um_per_m = 1000.0 }\n"
        "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"feedback\"\nmodel = \"known\"\n"
        "max_rate_mm_per_s = 1000.0\n");
    scenario.machine.scale = {};
    scenario.machine.motor = {};
    return run_named_case(scenario, "one");
  }();
  return kOutput.result.servo;
}

// Model periods lie at ticks n = 0, 6, ...; the position loop at k uses the last with n + 7 <= k.
TEST(VirtualDisplacement, OfTickNIsReadFromTickNPlus7On) {
  const records::Series& rows = every_tick();
  const std::size_t read = rows.column("fb_linear", 'X').value();
  const std::size_t scale = rows.column("meas_linear", 'X').value();
  ASSERT_GT(rows.rows(), 4000U);
  std::size_t steps = 0;
  for (std::size_t k = 2001; k < 3000; k += kPositionPeriod) {  // at full speed
    const double displacement = rows.at(k, read) - rows.at(k - kSignalDelay, scale);
    const auto evaluated = [&](std::size_t delay) {
      return kSlope * rows.at((k - delay) / kModelPeriod * kModelPeriod, scale);
    };
    constexpr double kSame = 1e-10;  // mm; a model period moves it by 1.2e-6 mm
    ASSERT_NEAR(displacement, evaluated(kModelPeriod + kSignalDelay), kSame) << "tick " << k;
    const double sooner = evaluated(kModelPeriod);
    if (std::abs(sooner - evaluated(kModelPeriod + kSignalDelay)) > kSame) ++steps;
  }
  EXPECT_GT(steps, 100U) << "that n + 6 would be another reading";
}

}  // namespace
}  // namespace servomill::sim::run::feedback_timing_test
