/// Roughness parameters against closed forms.
#include "sim/metrology/roughness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology::roughness_test {
namespace {

constexpr double kSpacing = 0.5 * um;

// @param z  height (m) over a share of a wave
template <class Wave>
std::vector<double> profile(double length, double wave, Wave z) {
  std::vector<double> out;
  const auto points = std::lround(length / kSpacing) + 1;
  for (long i = 0; i < points; ++i) {
    const double share = static_cast<double>(i) * kSpacing / wave;
    out.push_back(z(share - std::floor(share)));
  }
  return out;
}

Roughness found(const std::vector<double>& heights, double spacing = kSpacing) {
  std::string why_not;
  const auto out = roughness_of(heights, spacing, why_not);
  EXPECT_TRUE(out) << why_not;
  return out.value_or(Roughness{});
}

// Arcs z = H (2 u)^2 about their middles have the mean H / 3 and Ra = 4 H / (9 sqrt 3), which with
// H = c^2 / (8 R) is c^2 / (18 sqrt(3) R), the 0.032 c^2 / R of textbooks.
TEST(Roughness, OfAChainOfArcsIsThatOfTextbooks) {
  const double c = 0.073 * mm, R = 4 * mm, H = c * c / (8.0 * R);
  const Roughness of = found(profile(1.6 * mm, c, [&](double share) {
    const double u = share - 0.5;
    return 4.0 * H * u * u;
  }));
  EXPECT_EQ(of.cutoff, 0.25 * mm);
  EXPECT_EQ(of.evaluation_length, 1.25 * mm);
  EXPECT_NEAR(of.Ra, 4.0 * H / (9.0 * std::sqrt(3.0)), 0.005 * of.Ra);
  EXPECT_NEAR(of.Ra, 0.0321 * c * c / R, 0.005 * of.Ra);
  EXPECT_NEAR(of.Rz, H, 0.01 * H);
}

// Saw teeth: Ra = H / 4. On an inclined line, too.
TEST(Roughness, OfSawTeethIsAQuarterOfTheirHeight) {
  const double H = 0.3 * um;
  std::vector<double> heights =
      profile(1.6 * mm, 0.05 * mm, [&](double share) { return H * share; });
  const Roughness level = found(heights);
  EXPECT_NEAR(level.Ra, 0.25 * H, 0.005 * H);
  EXPECT_NEAR(level.Rz, H, 0.02 * H);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] += 1e-3 * kSpacing * static_cast<double>(i);
  EXPECT_NEAR(found(heights).Ra, level.Ra, 1e-3 * H);
}

// Half of a sine of the cut-off passes the Gaussian filter (ISO 16610-21), 1 - 2^-((lc / w)^2) of
// a wave w: within what ending the weights at half a cut-off leaves.
TEST(Roughness, FilterLetsHalfOfAWaveOfTheCutoffPass) {
  const double A = 1 * um, cutoff = 0.25 * mm;
  for (const double wave : {0.1 * mm, 0.25 * mm, 0.5 * mm}) {
    const Roughness of = found(profile(1.5 * mm, wave, [&](double share) {
      return A * std::sin(2.0 * std::numbers::pi * share);
    }));
    const double largest = *std::max_element(of.profile.begin(), of.profile.end());
    EXPECT_NEAR(largest, A * (1.0 - std::exp2(-std::pow(cutoff / wave, 2))), 0.05 * A) << wave;
  }
}

TEST(Roughness, HasTheLargestCutoffThatSixTimesFitsIntoTheLine) {
  EXPECT_FALSE(cutoff_for(0.47 * mm));
  EXPECT_EQ(cutoff_for(0.48 * mm), 0.08 * mm);
  EXPECT_EQ(cutoff_for(1.5 * mm), 0.25 * mm);
  EXPECT_EQ(cutoff_for(4.7 * mm), 0.25 * mm);
  EXPECT_EQ(cutoff_for(4.8 * mm), 0.8 * mm);
  EXPECT_EQ(cutoff_for(100 * mm), 8 * mm);
}

TEST(Roughness, SaysWhatALineLacks) {
  std::string why_not;
  EXPECT_FALSE(roughness_of(std::vector<double>(101, 0.0), 4 * um, why_not));
  EXPECT_EQ(why_not, "a line of 0.4 mm is shorter than 6 cut-offs of 0.08 mm");
  EXPECT_FALSE(roughness_of(std::vector<double>(501, 0.0), 3 * um, why_not));
  EXPECT_EQ(why_not, "points 3 um apart; a cut-off of 0.25 mm requires at most 2.5 um");
}

}  // namespace
}  // namespace servomill::sim::metrology::roughness_test
