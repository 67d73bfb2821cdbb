#include "sim/standards/positioning_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/sim/standards/reading_file.h"

namespace servomill::sim::standards::positioning_uncertainty_test {

using enum Positioning;

// An axis of 1 m whose mean error rises by 20 um, with a reversal of 3 um and some scatter.
PositioningTest axis() {
  PositioningTest test;
  constexpr int kTargets = 6, kRuns = 5;
  test.targets = Eigen::ArrayXd::LinSpaced(kTargets, 0.2, 1.2);
  test.up = test.down = test.time_up = test.time_down = Eigen::ArrayXXd::Zero(kTargets, kRuns);
  int k = 0;
  for (int j = 0; j < kRuns; ++j) {
    for (int i = 0; i < kTargets; ++i) {
      const double scatter = 0.4 * um * std::sin(17.0 * i + 5.0 * j * j);
      test.up(i, j) = 20e-6 * test.targets[i] + scatter;
      test.time_up(i, j) = k++ / 59.0;
    }
    for (int i = kTargets - 1; i >= 0; --i) {
      test.down(i, j) = 20e-6 * test.targets[i] - 3.0 * um - 0.7 * std::abs(test.up(i, j)) / 25.0;
      test.time_down(i, j) = k++ / 59.0;
    }
  }
  return test;
}

double U(const PositioningContributions& contributions, Positioning which) {
  const auto found = positioning_uncertainty(axis(), contributions, {.trials = 1});
  double all = 0.0;  // of the sources, where U of the whole is not stated
  for (const PositioningValues& alone : found.alone) all = std::hypot(all, at(alone, which));
  return all;
}

PositioningContributions only(std::optional<double> PositioningContributions::*which,
                              double value) {
  PositioningContributions out;
  out.*which = value;
  return out;
}

constexpr double kMonteCarlo = 0.03;  // relative, 10 000 trials of a standard deviation

// A(L (1 + e)) = A + e L where the extreme targets are the ends: U = 2 u L.
TEST(PositioningUncertainty, ScaleOfTheDeviceActsOnTheRange) {
  const auto c = only(&PositioningContributions::scale, 0.5e-6);
  EXPECT_NEAR(U(c, A), 1.0 * um, kMonteCarlo * um);
  EXPECT_NEAR(U(c, E), 1.0 * um, kMonteCarlo * um);
  EXPECT_NEAR(U(c, M), 1.0 * um, kMonteCarlo * um);
}

// Both are the same in both directions and in all runs.
TEST(PositioningUncertainty, ScaleAndExpansionCancelInReversalAndRepeatability) {
  constexpr double kRounding = 1e-15;  // m
  PositioningContributions c;
  c.scale = 2e-6;
  c.target = 1.0 * um;
  c.misalignment = 1e-3;
  c.expansion = 11.5e-6;
  c.u_expansion = 2e-6;
  c.temperature = 3.0;
  c.u_temperature = 0.5;
  c.set_up = 5.0 * um;
  for (const Positioning which : {B, B_mean, R_up, R_down, R}) EXPECT_LT(U(c, which), kRounding);
  for (const Positioning which : {A, A_up, E, M}) EXPECT_GT(U(c, which), 5.0 * um);
}

TEST(PositioningUncertainty, ExpansionOfTheAxis) {
  PositioningContributions c;
  c.expansion = 12e-6;
  c.temperature = 4.0;
  c.u_expansion = 1e-6;    // 4 um/m
  c.u_temperature = 0.25;  // 3 um/m
  EXPECT_NEAR(U(c, M), 2.0 * 5.0 * um, 2.0 * kMonteCarlo * 5.0 * um);
}

// The beam reads short by L (pitch^2 + yaw^2) / 2, which is not corrected: U counts the shift.
// Mean square of pitch^2 + yaw^2 for angles within +-a: a^4 (2/5 + 2/9).
TEST(PositioningUncertainty, MisalignmentIsACosine) {
  constexpr double kLimit = 1e-3;
  const double expected = kLimit * kLimit * std::sqrt(2.0 / 5.0 + 2.0 / 9.0);
  EXPECT_NEAR(U(only(&PositioningContributions::misalignment, kLimit), M), expected,
              2.0 * kMonteCarlo * expected);
}

// The mean reversal over n runs of m targets: noise of each reading averages out.
TEST(PositioningUncertainty, VariationOfReadingsActsOnRepeatabilityAndAveragesInMeans) {
  const auto c = only(&PositioningContributions::variation, 0.6 * um);
  const double standard = 0.6 * um / std::sqrt(12.0);
  EXPECT_NEAR(U(c, B_mean), 2.0 * standard * std::sqrt(2.0 / (5.0 * 6.0)), kMonteCarlo * standard);
  EXPECT_GT(U(c, R), 2.0 * standard);
}

// Readings upwards and downwards at one target are apart in time.
TEST(PositioningUncertainty, DriftShowsAsReversal) {
  const double limit = 1.0 * um;
  const PositioningTest test = axis();
  const double lag = (test.time_up - test.time_down).mean();
  EXPECT_NEAR(U(only(&PositioningContributions::drift, limit), B_mean),
              2.0 * limit / std::sqrt(3.0) * std::abs(lag),
              2.0 * kMonteCarlo * limit * std::abs(lag));
}

TEST(PositioningUncertainty, UnknownIsUnknown) {
  PositioningContributions c;
  c.resolution = 1.0 * nm;
  c.variation = 0.2 * um;
  EXPECT_TRUE(missing_for(c, false, R).empty());
  EXPECT_FALSE(missing_for(c, false, A).empty());
  const auto found = positioning_uncertainty(axis(), c, {.trials = 100, .trials_alone = 10});
  EXPECT_FALSE(std::isnan(at(found.U, R)));
  EXPECT_TRUE(std::isnan(at(found.U, A)));
  c.scale = 1e-6;
  c.misalignment = c.expansion = c.u_expansion = c.temperature = 0.0;
  const std::vector<std::string_view> last = {"temperature_uncertainty"};
  EXPECT_EQ(missing_for(c, false, A), last);
  EXPECT_FALSE(missing_for(c, true, A).empty());  // a rotary axis needs a calibrated angle
}

TEST(PositioningUncertainty, SameSeedSameBits) {
  PositioningContributions c;
  c.variation = 1.0 * um;
  c.resolution = 0.1 * um;
  const MonteCarloSettings settings{.seed = 7, .trials = 500, .trials_alone = 10};
  const auto one = positioning_uncertainty(axis(), c, settings);
  const auto other = positioning_uncertainty(axis(), c, settings);
  EXPECT_EQ(at(one.U, R), at(other.U, R));
  const auto third = positioning_uncertainty(axis(), c, {.seed = 8, .trials = 500});
  EXPECT_NE(at(one.U, R), at(third.U, R));
}

TEST(PositioningUncertainty, KeysOfAFile) {
  const ReadingFile file(
      "scale_uncertainty_um_per_m = 0.25\nresolution_um = 0.001\nmisalignment_mrad = 0.5\n"
      "coefficient_per_K = 11.5e-6\ncoefficient_uncertainty_per_K = 1e-6\n"
      "temperature_degC = 21.5\ntemperature_uncertainty_K = 0.2\nvariation_um = 0.02\n",
      "laser.toml");
  const PositioningContributions c = read_contributions(file.path());
  EXPECT_DOUBLE_EQ(*c.scale, 0.25e-6);
  EXPECT_DOUBLE_EQ(*c.resolution, 1.0 * nm);
  EXPECT_DOUBLE_EQ(*c.misalignment, 0.5e-3);
  EXPECT_DOUBLE_EQ(*c.u_expansion, 1e-6);
  EXPECT_DOUBLE_EQ(*c.temperature, 1.5);
  EXPECT_DOUBLE_EQ(*c.variation, 20.0 * nm);
  EXPECT_FALSE(c.drift);
  EXPECT_TRUE(missing_for(c, false, A).empty());
  EXPECT_EQ(message_of("temperature_degC = 70\n", read_contributions),
            "readings.csv:1:20: error: temperature_degC = 70; must be >= -10 and <= 50");
}

}  // namespace servomill::sim::standards::positioning_uncertainty_test
