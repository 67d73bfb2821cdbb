// Tolerances of chords, one after the other, are those of the formula over all of them.
#include "controllers/path/chord_tolerances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::test::chord_tolerances_test {
namespace {

constexpr double kRadius = 0.1;  // m
constexpr double kRounding = 1e-12;

struct Chord {
  JointChord chord;
  ChordBudget budget;
  std::size_t move;
};

// Moves of one to seven chords, of which some do not begin where the one before has ended, and some
// in a row turn no rotary axis.
std::vector<Chord> chords(std::size_t count) {
  std::mt19937 dice(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Chord> out;
  Joints at = Joints::Zero();
  std::size_t move = 0, left = 0;
  bool turns = true;
  for (std::size_t i = 0; i < count; ++i) {
    if (left == 0) {
      ++move;
      left = 1 + dice() % 7;
      turns = move / 6 % 3 != 0;
      if (dice() % 10 == 0) at[0] += 1 * mm;
    }
    Chord one{{}, {at, 10 * um, (8 + share(dice)) * um, share(dice) * kRadius, 1e-4}, move};
    for (int j = 0; j < (turns ? kJoints : kLinearJoints); ++j) at[j] += share(dice) * 1e-3;
    one.chord.end = at;
    out.push_back(one);
    --left;
  }
  return out;
}

std::vector<JointChord> divided(const std::vector<Chord>& chords) {
  std::vector<JointChord> out;
  ChordTolerances tolerances(kRadius, [&](const JointChord& chord) { out.push_back(chord); });
  for (std::size_t i = 0; i < chords.size(); ++i) {
    if (i > 0 && chords[i].move != chords[i - 1].move) tolerances.end_move();
    tolerances.add(chords[i].chord, chords[i].budget);
  }
  tolerances.finish();
  return out;
}

// Bend of linear joints and of rotary ones, as the latter moves the tip, where a chord begins.
std::pair<double, double> bend_before(const std::vector<Chord>& all, std::size_t i) {
  if (i == 0 || all[i - 1].chord.end != all[i].budget.begin) return {0.0, 0.0};
  const auto direction = [&](std::size_t k) -> Joints {
    Joints step = all[k].chord.end - all[k].budget.begin;
    step.tail<2>() *= kRadius;
    return step / step.norm();
  };
  const Joints bend = direction(i) - direction(i - 1);
  return {bend.head<3>().norm(), all[i].budget.arm * bend.tail<2>().norm() / kRadius};
}

TEST(ChordTolerances, AreDividedAsTheChordsNearbyBend) {
  const std::vector<Chord> all = chords(400);
  const std::vector<JointChord> found = divided(all);
  ASSERT_EQ(found.size(), all.size());
  int inner = 0, still = 0, corners = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    double linear = 0.0, rotary = 0.0;
    for (std::size_t k = i - std::min<std::size_t>(i, 3); k <= std::min(i + 4, all.size() - 1);
         ++k) {
      const auto [l, r] = bend_before(all, k);
      linear += l;
      rotary += r;
    }
    const ChordBudget& budget = all[i].budget;
    const bool is_inner = i > 0 && i + 1 < all.size() && all[i - 1].move == all[i].move &&
                          all[i + 1].move == all[i].move;
    double wanted = 0.0, share = 0.0;  // of linear joints; of the tip, for rotary ones
    if (rotary < kRounding) {
      share = 1e-3 * budget.tip;
      wanted = budget.tip - share;
      ++still;
    } else if (is_inner) {
      wanted = share = 0.4 * budget.whole;
      ++inner;
    } else {
      const double tip = 0.95 * budget.tip;
      share = std::clamp(rotary / (rotary + linear), 0.2, 0.8) * tip;
      wanted = tip - std::min(share, budget.arm * budget.axis);
      ++corners;
    }
    EXPECT_NEAR(found[i].tolerance_linear, wanted, 1e-9 * wanted) << "chord " << i;
    EXPECT_NEAR(found[i].tolerance_rotary, std::min(budget.axis, share / budget.arm), 1e-12);
    EXPECT_EQ(found[i].end, all[i].chord.end);
  }
  EXPECT_GT(std::min({inner, still, corners}), 10);
}

TEST(ChordTolerances, OfFewChordsAreComplete) {
  for (std::size_t count = 0; count < 8; ++count) {
    EXPECT_EQ(divided(chords(count)).size(), count);
  }
}

}  // namespace
}  // namespace servomill::controllers::test::chord_tolerances_test
