#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>

#include "sim/calibration/calibration.h"
#include "sim/calibration/make_up.h"
#include "tests/number_of.h"
#include "tests/sim/calibration/shop.h"

namespace servomill::sim::calibration::large_adjustment_test {
namespace {

using plant::operator""_err;

// Lines with many targets and tables with many knots; time and memory are printed for
// tools/evidence.
TEST(LargeAdjustment, FindsABowOfManyKnots) {
  const int targets = number_of("SERVOMILL_LARGE_TARGETS", 60);
  readings::Readings all = shop_readings();
  for (readings::Group& group : all.groups) {
    if (!group.axis) continue;
    const readings::Reading first = group.rows.front();
    group.rows.assign(std::size_t(targets), first);
    for (int k = 0; k < targets; ++k) {
      group.rows[std::size_t(k)].Q[index_of(*group.axis)] = double(k) / (targets - 1);
    }
  }
  CalibrationSettings settings;
  settings.form_linear.number_of_knots = targets / 16 + 2;
  plant::ErrorModel truth;
  truth.component("EYX"_err) = plant::polynomial({0.0, 0.0, 40e-6});
  make_up(all, gantry(), truth, 1);
  const auto begin = std::chrono::steady_clock::now();
  const Calibration found = calibrate(std::move(all), gantry(), settings);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const Adjustment& adjustment = found.adjustment;
  EXPECT_TRUE(adjustment.converged);
  EXPECT_NEAR(adjustment.squares / adjustment.redundancy, 1.0,
              5.0 * std::sqrt(2.0 / adjustment.redundancy));
  const plant::ErrorFunction& bow = adjustment.errors.component("EYX"_err);
  EXPECT_NEAR(bow.value(0.5) - 0.5 * (bow.value(0.0) + bow.value(1.0)), -10e-6, 2e-6);
  std::printf("%zu numbers, %d unknowns: %.2f s, %.0f MiB\n", found.observations.all.size(),
              adjustment.unknowns.size(), seconds, double(used.ru_maxrss) / 1024.0);
}

}  // namespace
}  // namespace servomill::sim::calibration::large_adjustment_test
