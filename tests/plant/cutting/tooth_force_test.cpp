#include "plant/cutting/tooth_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "plant/vocabulary/units.h"
#include "tests/counting_new.h"

namespace servomill::plant::tooth_force_test {
namespace {

constexpr double kPi = std::numbers::pi;

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

EngagedArc flank(double depth, double from, double to) {
  return {.width = depth, .height = 0.5 * depth, .from = from, .to = to};
}

Cutter end_mill(int teeth, double helix = 0.0) {
  return {.radius = 4 * mm, .length = 30 * mm, .teeth = teeth, .helix = helix};
}

// Two of four straight teeth are always in a slot, a quarter of a turn apart: at phi and
// phi + 90 deg. What grows with the chip does not depend on phi, what the edges need does.
TEST(ToothForce, four_straight_teeth_in_a_slot_follow_the_closed_form) {
  const CuttingCoefficients& K = steel();
  const double a = 2 * mm, c = 0.073 * mm, step = 1 * deg;
  const EngagedArc slot = flank(a, 0.0, kPi);
  const Cutter cutter = end_mill(4);
  const ToothChips chips(cutter);
  const std::vector<EdgeSlice> slices = edge_slices(cutter, {}, {&slot, 1});
  for (int n = 0; n < 360; ++n) {
    const double theta = n * step - 2.0 * kPi;
    const double phi = std::fmod(n, 90) * step;
    // means over the step of sin + cos and of cos - sin
    const auto S = [](double x) { return std::sin(x) - std::cos(x); };
    const auto C = [](double x) { return std::sin(x) + std::cos(x); };
    const double sum = (S(phi + step) - S(phi)) / step,
                 difference = (C(phi + step) - C(phi)) / step;
    const Eigen::Vector3d expected(-a * (K.Krc * c + K.Kte * difference + K.Kre * sum),
                                   a * (K.Ktc * c + K.Kte * sum - K.Kre * difference),
                                   -a * (K.Kac * c * sum + 2.0 * K.Kae));
    const Eigen::Vector3d F = mean_tooth_force(K, chips, slices, theta, step, c);
    ASSERT_LE((F - expected).norm(), 1e-9 * expected.norm()) << n << ": " << F.transpose();
  }
}

// Seeded engagements of all kinds.
struct Cut {
  Cutter cutter;
  FeedDirection feed;
  std::vector<EngagedArc> arcs;
};
Cut random_cut(int n, std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  Cut cut{end_mill(1 + n % 5, between(0.0, 45 * deg)), {}, {}};
  const double slope = n % 3 == 0 ? 0.0 : between(-1.4, 1.4);
  cut.feed = {std::cos(slope), std::sin(slope)};
  for (int i = 0; i < 3; ++i) {
    const double from = between(-4.0, 5.0);
    cut.arcs.push_back({.width = between(0.1, 2.0) * mm,
                        .height = between(0.0, 10.0) * mm,
                        .kappa = n % 2 == 0 ? 0.5 * kPi : between(0.0, 0.5 * kPi),
                        .from = from,
                        .to = from + between(0.1, 6.2)});
  }
  return cut;
}

TEST(ToothForce, mean_over_a_turn_is_the_average_force_whatever_the_steps) {
  std::mt19937 random(11);
  const double c = 0.06 * mm, wear = 1.7;
  for (int n = 0; n < 60; ++n) {
    const Cut cut = random_cut(n, random);
    const ToothChips chips(cut.cutter);
    const std::vector<EdgeSlice> slices = edge_slices(cut.cutter, cut.feed, cut.arcs);
    const int steps = 7 + n;  // teeth do not enter and leave at steps
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double largest = 1.0;
    for (int i = 0; i < steps; ++i) {
      const double dtheta = 2.0 * kPi / steps;
      const Eigen::Vector3d F =
          mean_tooth_force(steel(), chips, slices, 0.3 + i * dtheta, dtheta, c, wear);
      largest = std::max(largest, F.norm());
      mean += F / steps;
    }
    const Eigen::Vector3d average =
        average_force(steel(), cut.cutter.teeth, cut.feed, cut.arcs).at(c, wear);
    EXPECT_LE((mean - average).norm(), 1e-9 * largest) << "set " << n;
  }
}

// Away from entry and exit; without slices of the flank: one thin arc each.
TEST(ToothForce, over_a_small_rotation_is_the_force_at_an_angle) {
  constexpr double kSmall = 1e-6;  // rad
  std::mt19937 random(5);
  int compared = 0;
  for (int n = 0; n < 200; ++n) {
    Cut cut = random_cut(n, random);
    for (EngagedArc& arc : cut.arcs) arc.width = 1 * um;
    const ToothChips chips(cut.cutter);
    const std::vector<EdgeSlice> slices = edge_slices(cut.cutter, cut.feed, cut.arcs);
    const double theta = 0.1 * n, c = 0.06 * mm;
    const auto at = [&](double angle) {
      return force_at_rotation(steel(), cut.cutter, cut.feed, cut.arcs, angle, c);
    };
    const Eigen::Vector3d F = mean_tooth_force(steel(), chips, slices, theta, kSmall, c);
    const Eigen::Vector3d before = at(theta), after = at(theta + kSmall);
    if ((after - before).norm() > 1e-4 * before.norm()) continue;  // a tooth enters or leaves
    EXPECT_LE((F - 0.5 * (before + after)).norm(), 1e-7 * before.norm()) << n;
    ++compared;
  }
  EXPECT_GT(compared, 150);
}

// One slice of the flank against thousands of straight ones, each at its lag.
TEST(ToothForce, on_a_helix_is_that_of_many_straight_pieces) {
  const double a = 20 * mm, c = 0.05 * mm;
  const EngagedArc whole = flank(a, 0.4, 2.6);
  for (const double runout : {0.0, 30 * um}) {
    Cutter cutter = end_mill(3, 40 * deg);  // 240 deg of lag
    cutter.runout = runout;
    const ToothChips chips(cutter);
    const std::vector<EdgeSlice> helix = edge_slices(cutter, {}, {&whole, 1});
    ASSERT_EQ(helix.size(), 1U);
    EXPECT_NEAR(helix[0].lag_span, a * std::tan(cutter.helix) / cutter.radius, 1e-12);
    std::vector<EdgeSlice> straight;
    constexpr int kPieces = 4000;
    for (int i = 0; i < kPieces; ++i) {
      EdgeSlice piece = helix[0];
      piece.width = a / kPieces;
      piece.lag = helix[0].lag_span * (i + 0.5) / kPieces;
      piece.lag_span = 0.0;
      straight.push_back(piece);
    }
    for (int n = 0; n < 40; ++n) {
      const double theta = 0.31 * n - 3.0;
      const Eigen::Vector3d F = mean_tooth_force(steel(), chips, helix, theta, 0.05, c);
      const Eigen::Vector3d sum = mean_tooth_force(steel(), chips, straight, theta, 0.05, c);
      EXPECT_LE((F - sum).norm(), 1e-4 * sum.norm()) << n;  // of the pieces
    }
  }
}

TEST(ToothForce, arcs_of_a_flank_that_are_engaged_alike_are_one_slice) {
  const double a = 2 * mm;
  std::vector<EngagedArc> thin;
  for (int i = 0; i < 40; ++i) {
    thin.push_back({.width = a / 40, .height = (i + 0.5) * a / 40, .from = 0.0, .to = kPi});
  }
  const auto slices = edge_slices(end_mill(4, 30 * deg), {}, thin);
  ASSERT_EQ(slices.size(), 1U);
  EXPECT_NEAR(slices[0].width, a, 1e-15);
  EXPECT_NEAR(slices[0].lag, 0.0, 1e-15);
  thin[20].from = 0.1;
  EXPECT_EQ(edge_slices(end_mill(4, 30 * deg), {}, thin).size(), 3U);
}

// The surface behind a cutter at one angle, tooth by tooth: what each finds and leaves.
TEST(ToothChips, of_teeth_that_run_out_are_those_between_the_surfaces_that_they_leave) {
  std::mt19937 random(3);
  for (int n = 0; n < 300; ++n) {
    Cutter cutter = end_mill(1 + n % 6);
    cutter.runout = 1e-6 * static_cast<double>(random() % 200);
    cutter.runout_direction = 0.01 * static_cast<double>(random() % 628);
    const int N = cutter.teeth;
    const double x = 1e-6 * static_cast<double>(
                                1 + random() % 100);  // of the centre along r, each tooth passage
    double surface = -1.0, sum = 0.0;                 // m, along r
    const ToothChips chips(cutter);
    // tooth j + 1 passes before tooth j
    for (int passage = 0; passage < 20 * N; ++passage) {
      const int tooth = (N - passage % N) % N;
      const double reach = passage * x + cutter.radius_offset(tooth);
      const double chip = std::max(0.0, reach - surface);
      surface = std::max(surface, reach);
      if (passage < 19 * N) continue;  // the first turns enter
      EXPECT_NEAR(chips.at(tooth, x), chip, 1e-15) << n << " tooth " << tooth;
      sum += chip;
    }
    EXPECT_NEAR(sum, N * x, 1e-14) << "mean chip of all teeth";
  }
}

TEST(ToothChips, without_run_out_are_the_nominal_chip) {
  const ToothChips chips(end_mill(4));
  for (int tooth = 0; tooth < 4; ++tooth) {
    ASSERT_EQ(chips.pieces(tooth).size(), 1U);
    EXPECT_EQ(chips.at(tooth, 10 * um), 10 * um);
    EXPECT_EQ(chips.at(tooth, -1 * um), 0.0);
  }
}

// 30 um of run-out leave nothing to one of two teeth that feed 10 um each: R_0 - R_1 = 30 um.
TEST(ToothChips, leave_the_chip_of_a_tooth_that_cuts_nothing_to_the_next) {
  Cutter cutter = end_mill(2);
  cutter.runout = 30 * um;
  const ToothChips chips(cutter);
  EXPECT_NEAR(chips.at(0, 10 * um), 20 * um, 1e-15);
  EXPECT_EQ(chips.at(1, 10 * um), 0.0);
  // on the other side of the limit both cut
  EXPECT_NEAR(chips.at(0, 40 * um), 70 * um, 1e-15);
  EXPECT_NEAR(chips.at(1, 40 * um), 10 * um, 1e-15);
}

// Against sums over small steps of (1) at their angles.
TEST(ToothForce, of_teeth_that_run_out_integrates_their_chips) {
  const CuttingCoefficients& K = steel();
  Cutter cutter = end_mill(3);
  cutter.runout = 40 * um;
  cutter.runout_direction = 0.4;
  const double a = 1 * mm, c = 0.05 * mm, from = 0.2, to = 2.9;
  const EngagedArc arc = flank(a, from, to);
  const ToothChips chips(cutter);
  const auto slices = edge_slices(cutter, {}, {&arc, 1});
  constexpr int kSteps = 20000;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (int part = 0; part < 12; ++part) {
    const double theta = part * kPi / 6.0, dtheta = kPi / 6.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < kSteps; ++i) {
      for (int tooth = 0; tooth < 3; ++tooth) {
        const double phi =
            std::fmod(theta + dtheta * (i + 0.5) / kSteps + tooth * 2.0 * kPi / 3.0, 2.0 * kPi);
        const double h = phi > from && phi < to ? chips.at(tooth, c * std::sin(phi)) : 0.0;
        if (h <= 0.0) continue;
        const double Ft = a * (K.Ktc * h + K.Kte), Fr = a * (K.Krc * h + K.Kre);
        sum += Eigen::Vector3d(-Ft * std::cos(phi) - Fr * std::sin(phi),
                               Ft * std::sin(phi) - Fr * std::cos(phi), -a * (K.Kac * h + K.Kae)) /
               kSteps;
      }
    }
    const Eigen::Vector3d F = mean_tooth_force(K, chips, slices, theta, dtheta, c);
    EXPECT_LE((F - sum).norm(), 2e-4 * 1000.0) << part << ": " << F.transpose();
    turn += F / 12.0;
  }
  // the chips of the teeth differ, their mean does not: the shear is that of the average model
  const CuttingForce average = average_force(K, 3, {}, {&arc, 1});
  CuttingCoefficients shear = K;
  shear.Kte = shear.Kre = shear.Kae = 0.0;
  Eigen::Vector3d mean = mean_tooth_force(shear, chips, slices, 0.0, 2.0 * kPi, c);
  EXPECT_LE((mean - c * average.shear).norm(), 1e-9 * mean.norm());
}

TEST(ToothForce, is_zero_for_a_cutter_that_does_not_feed_and_takes_nothing_from_the_heap) {
  const EngagedArc slot = flank(2 * mm, 0.0, kPi);
  Cutter cutter = end_mill(4, 30 * deg);
  cutter.runout = 20 * um;
  const ToothChips chips(cutter);
  const auto slices = edge_slices(cutter, {}, {&slot, 1});
  const std::size_t before = allocations;
  EXPECT_EQ(mean_tooth_force(steel(), chips, slices, 1.0, 0.1, 0.0).norm(), 0.0);
  EXPECT_GT(mean_tooth_force(steel(), chips, slices, 1.0, 0.1, 50 * um).norm(), 0.0);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace servomill::plant::tooth_force_test
