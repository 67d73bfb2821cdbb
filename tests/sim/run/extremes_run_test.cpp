// Rows that tell of every tick, against a run that records every tick.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/records/row_thinning.h"
#include "sim/run/run_output.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::extremes_run_test {
namespace {

constexpr const char* kProgram = R"(G21 G90 G94 F6000
(MSG, there)
G1 X8 Y1
(MSG, back)
G1 X0 Y0
M2
)";
constexpr double kRow = 2.0;  // ms

CaseOutput run(const std::string& record, const std::string& servo = "") {
  const model::Scenario of =
      small_scenario(kProgram, "[record]\nsettle_ms = 20.0\nresolution_nm = 0\n" + record +
                                   "[[case]]\nname = \"one\"\n" + servo);
  return run_named_case(of, "one");
}

std::string period(double ms) { return "period_ms = " + std::to_string(ms) + "\n"; }

double tick() {
  const model::Scenario of = small_scenario(kProgram, "[[case]]\nname = \"one\"\n");
  return of.machine.nc.periods.base;
}

// Each row, and extremes and number of the ticks since the row before, by the definition.
void agree(const records::Series& some, const records::Series& every, double step) {
  const std::size_t time = *some.column("time"), samples = *some.column(records::kSamples);
  std::size_t tick = 0, rows_at_period = 0;
  for (std::size_t row = 0; row < some.rows(); ++row) {
    const auto last = static_cast<std::size_t>(std::llround(some.at(row, time) / step));
    ASSERT_EQ(some.at(row, samples), static_cast<double>(last + 1 - tick));
    for (const records::Signal& signal : every.signals()) {
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        ASSERT_EQ(some.at(row, some.find(signal.name)->offset + c),
                  every.at(last, signal.offset + c))
            << signal.name;
      }
      const records::Signal* least = some.find(signal.name + "_min");
      if (least == nullptr) continue;
      const records::Signal* greatest = some.find(signal.name + "_max");
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        double low = every.at(tick, signal.offset + c), high = low;
        for (std::size_t n = tick; n <= last; ++n) {
          low = std::min(low, every.at(n, signal.offset + c));
          high = std::max(high, every.at(n, signal.offset + c));
        }
        ASSERT_EQ(some.at(row, least->offset + c), low) << signal.name;
        ASSERT_EQ(some.at(row, greatest->offset + c), high) << signal.name;
      }
    }
    rows_at_period += std::abs(std::remainder(some.at(row, time), kRow * ms)) < 0.1 * step;
    tick = last + 1;
  }
  EXPECT_EQ(tick, every.rows());
  EXPECT_EQ(rows_at_period, static_cast<std::size_t>(
                                std::floor(every.at(every.rows() - 1, time) / (kRow * ms) + 1e-6)) +
                                1);
  EXPECT_LE(some.rows(), rows_at_period + 2);  // the end of a section, and the last row
}

TEST(Extremes, AreThoseOfEveryTick) {
  const CaseOutput every = run(period(tick() / ms)), some = run(period(kRow) + "extremes = true\n");
  agree(some.result.servo, every.result.servo, tick());
}

TEST(Extremes, AreThoseOfEveryPositionPeriodOfAnIdealServo) {
  const model::Scenario of = small_scenario(kProgram, "[[case]]\nname = \"one\"\n");
  const double step = of.machine.nc.periods.seconds(of.machine.nc.periods.position);
  const std::string ideal = "servo = \"ideal\"\n";
  const CaseOutput every = run(period(step / ms), ideal),
                   some = run(period(6.0 * step / ms) + "extremes = true\n", ideal);
  const records::Series& rows = some.result.servo;
  const std::size_t samples = *rows.column(records::kSamples);
  double sum = 0.0;
  for (std::size_t row = 0; row < rows.rows(); ++row) sum += rows.at(row, samples);
  EXPECT_EQ(sum, static_cast<double>(every.result.servo.rows()));
  const std::size_t greatest = *rows.column("contour_error_max"),
                    error = *every.result.servo.column("contour_error");
  double most = 0.0, wanted = 0.0;
  for (std::size_t n = 0; n < rows.rows(); ++n) most = std::max(most, rows.at(n, greatest));
  for (std::size_t n = 0; n < every.result.servo.rows(); ++n) {
    wanted = std::max(wanted, every.result.servo.at(n, error));
  }
  EXPECT_EQ(most, wanted);
}

// The motion is that of a run without them, but for the rounding of shorter steps of the drives.
TEST(Extremes, DoNotChangeTheMotion) {
  constexpr double kRounding = 1e-9;  // mm
  const CaseOutput plain = run(period(kRow)), some = run(period(kRow) + "extremes = true\n");
  const records::Series &a = plain.result.servo, &b = some.result.servo;
  const std::size_t time = *a.column("time"), x = *a.column("true_linear", 'X');
  std::size_t row = 0;
  for (std::size_t n = 0; n < a.rows(); ++n) {
    while (b.at(row, time) < a.at(n, time) - 1e-9) ++row;
    ASSERT_NEAR(b.at(row, time), a.at(n, time), 1e-12);
    ASSERT_NEAR(b.at(row, x), a.at(n, x), kRounding);
  }
}

// Inside windows, too; no row tells of ticks outside.
TEST(Extremes, StayWithinWindows) {
  const std::string window = "windows.time_s = [[0.02, 0.031]]\n";
  const records::Series every = run(period(tick() / ms) + window).result.servo;
  const records::Series some = run(period(kRow) + "extremes = true\n" + window).result.servo;
  const std::size_t samples = *some.column(records::kSamples), window_of = *some.column("window");
  double sum = 0.0;
  for (std::size_t row = 0; row < some.rows(); ++row) sum += some.at(row, samples);
  EXPECT_EQ(sum, static_cast<double>(every.rows()));
  EXPECT_EQ(some.at(0, window_of), 0.0);
  EXPECT_EQ(some.at(some.rows() - 1, window_of), 2.0);
}

TEST(Extremes, AreComparedAsAllTicksAre) {
  const std::string asked =
      "[[quantity]]\nname = \"following_error\"\naxis = \"X\"\nstatistic = \"max\"\n"
      "[[quantity]]\nname = \"contour_error\"\nstatistic = \"range\"\n";
  const auto compared = [&](const std::string& record) {
    return run_scenario(small_scenario(
                            kProgram, "[record]\n" + record + "[[case]]\nname = \"one\"\n" + asked),
                        {})
        .comparison;
  };
  const auto every = compared(period(tick() / ms)), plain = compared(period(10.0)),
             some = compared(period(10.0) + "extremes = true\n");
  for (std::size_t i = 0; i < every.size(); ++i) {
    EXPECT_EQ(some[i].value, every[i].value);
    EXPECT_LT(std::abs(plain[i].value),
              std::abs(every[i].value));  // what a coarse recording misses
  }
}

}  // namespace
}  // namespace servomill::sim::run::extremes_run_test
