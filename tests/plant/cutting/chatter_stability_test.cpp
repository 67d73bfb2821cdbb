#include "plant/cutting/chatter_stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/cutting/regenerative_cut.h"

namespace servomill::plant::chatter_stability_test {
namespace {

constexpr double kPi = std::numbers::pi;

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

const ChatterMode kNormal{.stiffness = 20e6, .frequency = 2.0 * kPi * 500.0, .damping = 0.03};

SteadyCut steady(int teeth, double to, double turns, double depth) {
  return {.coefficients = steel(), .teeth = teeth, .to = to, .depth = depth, .turns = turns};
}

ChatterStability discretised(const SteadyCut& cut, std::span<const ChatterMode> modes) {
  return ChatterAnalysis(modes).of({cut.coefficients, cut.teeth, cut.turns,
                                    flank_slices(cut.depth, cut.from, cut.to, 0.0, 1.0)});
}

TEST(ChatterStability, without_a_cut_is_the_decay_of_the_mode) {
  const double T = 1.0 / (4.0 * 80.0), z = kNormal.damping, w = kNormal.frequency;
  const auto found = discretised(steady(4, kPi, 80.0, 0.0), {&kNormal, 1});
  EXPECT_NEAR(std::abs(found.multiplier), std::exp(-z * w * T), 1e-9);
  EXPECT_NEAR(found.frequency, w * std::sqrt(1.0 - z * z) / (2.0 * kPi), 1e-6);
  EXPECT_TRUE(found.is_stable());
}

// The simulation of regeneration.h, step by step, is another method.
TEST(ChatterStability, multiplier_is_that_of_a_simulation) {
  struct Row {
    int teeth;
    double to, turns, depth;
  };
  for (const Row& row :
       {Row{4, kPi, 80.0, 0.3 * mm}, Row{4, kPi, 45.0, 0.6 * mm}, Row{2, 12.8 * deg, 130.0, 2 * mm},
        Row{2, 12.8 * deg, 350.0, 5 * mm}, Row{3, 60 * deg, 100.0, 1 * mm}}) {
    const SteadyCut cut = steady(row.teeth, row.to, row.turns, row.depth);
    const Multiplier simulated = chatter_multiplier(cut, kNormal, 300);
    const auto found = discretised(cut, {&kNormal, 1});
    EXPECT_NEAR(std::abs(found.multiplier), simulated.magnitude(), 2e-3) << row.turns;
    EXPECT_NEAR(found.multiplier.real(), simulated.real, 5e-3) << row.turns;
  }
}

// Two modes in one direction that are one: twice the stiffness each.
TEST(ChatterStability, modes_add_up) {
  ChatterMode half = kNormal;
  half.stiffness *= 2.0;
  const ChatterMode halves[] = {half, half};
  const SteadyCut cut = steady(4, kPi, 80.0, 0.5 * mm);
  const auto one = discretised(cut, {&kNormal, 1}), two = discretised(cut, halves);
  EXPECT_NEAR(std::abs(one.multiplier), std::abs(two.multiplier), 1e-5);
  EXPECT_NEAR(one.frequency, two.frequency, 0.1);
}

TEST(ChatterStability, tells_flip_from_hopf) {
  EXPECT_EQ((ChatterStability{.multiplier = -1.0}.kind()), Chatter::flip);
  EXPECT_EQ((ChatterStability{.multiplier = {-0.6, 0.8}}.kind()), Chatter::hopf);
  EXPECT_EQ((ChatterStability{.multiplier = 1.0}.kind()), Chatter::fold);
}

// A flip repeats after two teeth: an odd multiple of half the tooth passing frequency.
TEST(ChatterStability, frequency_of_a_flip_is_that_of_two_teeth) {
  int flips = 0;
  for (const double turns : {172.0, 175.0, 180.0, 185.0, 190.0}) {
    for (const double depth : {20 * mm, 30 * mm, 60 * mm}) {
      const auto found = discretised(steady(2, 12.8 * deg, turns, depth), {&kNormal, 1});
      if (found.is_stable() || found.kind() != Chatter::flip) continue;
      ++flips;
      const double halves = found.frequency / turns;  // odd multiples
      EXPECT_NEAR(std::remainder(halves - 1.0, 2.0), 0.0, 1e-6) << turns;
    }
  }
  EXPECT_GE(flips, 5);
}

}  // namespace
}  // namespace servomill::plant::chatter_stability_test
