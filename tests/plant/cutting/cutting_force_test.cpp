#include "plant/cutting/cutting_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::plant::cutting_force_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-9;  // N or N/m relative to some 1e3 N and 1e7 N/m: relative below

const CuttingCoefficients& steel() { return find_material("42CrMo4")->typical; }

EngagedArc flank(double depth, double from, double to) {
  return {.width = depth, .height = 0.5 * depth, .from = from, .to = to};
}

// In a test's failure: relative to the largest component.
void expect_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double relative) {
  EXPECT_LE((a - b).norm(), relative * b.norm()) << a.transpose() << "\n" << b.transpose();
}

TEST(CuttingForce, average_in_a_slot_is_that_of_the_closed_form) {
  const CuttingCoefficients& K = steel();
  const int N = 4;
  const double a = 2 * mm;
  const EngagedArc slot = flank(a, 0.0, kPi);
  const CuttingForce F = average_force(K, N, {}, {&slot, 1});
  expect_near(F.shear, {-0.25 * N * a * K.Krc, 0.25 * N * a * K.Ktc, -N * a / kPi * K.Kac},
              kRounding);
  expect_near(F.edge, {-N * a / kPi * K.Kre, N * a / kPi * K.Kte, -0.5 * N * a * K.Kae}, kRounding);
}

TEST(CuttingTorque, average_in_a_slot_is_that_of_the_closed_form) {
  const CuttingCoefficients& K = steel();
  const int N = 4;
  const double a = 2 * mm, R = 5 * mm;
  EngagedArc slot = flank(a, 0.0, kPi);
  slot.radius = R;
  const CuttingTorque M = average_torque(K, N, {}, {&slot, 1});
  EXPECT_NEAR(M.shear, N * a * R / kPi * K.Ktc, kRounding * M.shear);
  EXPECT_NEAR(M.edge, 0.5 * N * a * R * K.Kte, kRounding * M.edge);
}

// A drill-like plunge of a flat bottom: every edge removes c at every angle.
TEST(CuttingTorque, average_of_a_plunge_is_that_of_the_closed_form) {
  const CuttingCoefficients& K = steel();
  const double R = 4 * mm;
  std::vector<EngagedArc> bottom;
  for (int i = 0; i < 8; ++i) {
    bottom.push_back({.width = R / 8,
                      .kappa = 0.0,
                      .from = -0.5 * kPi,
                      .to = 1.5 * kPi,
                      .radius = (i + 0.5) * R / 8});
  }
  const CuttingTorque M = average_torque(K, 2, {0.0, -1.0}, bottom);
  EXPECT_NEAR(M.shear, 2 * 0.5 * R * R * K.Ktc, kRounding * M.shear);
  EXPECT_NEAR(M.edge, 2 * 0.5 * R * R * K.Kte, kRounding * M.edge);
}

// Y. Altintas 2012, averages between entry and exit angles; its z counts from the spindle to the
// tip.
TEST(CuttingForce, average_between_two_angles_is_that_of_the_literature) {
  const CuttingCoefficients& K = steel();
  const int N = 3;
  const double a = 1.5 * mm, c = 0.07 * mm;
  const auto antiderivative = [&](double phi) {
    const double shear = N * a * c / (8.0 * kPi), edge = N * a / (2.0 * kPi);
    const double s2 = std::sin(2.0 * phi), c2 = std::cos(2.0 * phi);
    const double s = std::sin(phi), co = std::cos(phi);
    return Eigen::Vector3d(
        shear * (K.Ktc * c2 - K.Krc * (2.0 * phi - s2)) + edge * (-K.Kte * s + K.Kre * co),
        shear * (K.Ktc * (2.0 * phi - s2) + K.Krc * c2) - edge * (K.Kte * co + K.Kre * s),
        -edge * (-K.Kac * c * co + K.Kae * phi));
  };
  const double from = 0.3, to = 2.2;
  const EngagedArc arc = flank(a, from, to);
  expect_near(average_force(K, N, {}, {&arc, 1}).at(c), antiderivative(to) - antiderivative(from),
              kRounding);
}

// The closed form against the force on each tooth as it turns, summed up: any helix, any profile,
// any direction of feed, any engagement.
TEST(CuttingForce, average_is_the_mean_over_a_turn_of_the_force_on_the_teeth) {
  constexpr double kStep = 2e-4;  // of a turn's mean: a tooth enters or leaves within one step
  constexpr int kRotations = 40000;
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int n = 0; n < 12; ++n) {
    const Cutter cutter{
        .radius = 4 * mm, .length = 30 * mm, .teeth = 1 + n % 5, .helix = between(0.0, 45 * deg)};
    const double slope = n % 3 == 0 ? 0.0 : between(-1.4, 1.4);
    const FeedDirection feed{std::cos(slope), std::sin(slope)};
    std::vector<EngagedArc> arcs;
    for (int i = 0; i < 3; ++i) {
      const double from = between(-1.0, 3.0);
      arcs.push_back({.width = between(0.1, 2.0) * mm,
                      .height = between(0.0, 10.0) * mm,
                      .kappa = n % 2 == 0 ? 0.5 * kPi : between(0.0, 0.5 * kPi),
                      .from = from,
                      .to = from + between(0.1, 3.0)});
    }
    const double c = 0.06 * mm, wear = 1.7;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double largest = 0.0;
    for (int i = 0; i < kRotations; ++i) {
      const double theta = 2.0 * kPi / cutter.teeth * (i + 0.5) / kRotations;
      const Eigen::Vector3d F = force_at_rotation(steel(), cutter, feed, arcs, theta, c, wear);
      largest = std::max(largest, F.norm());
      mean += F / kRotations;
    }
    const Eigen::Vector3d closed = average_force(steel(), cutter.teeth, feed, arcs).at(c, wear);
    EXPECT_LE((mean - closed).norm(), kStep * largest) << "set " << n;
  }
}

TEST(CuttingForce, axial_force_draws_towards_the_work_on_the_flank_and_away_on_the_bottom) {
  const EngagedArc side = flank(1 * mm, 0.0, kPi);
  EXPECT_LT(average_force(steel(), 4, {}, {&side, 1}).at(0.05 * mm).z(), 0.0);
  const EngagedArc bottom{.width = 1 * mm, .kappa = 0.0, .from = 0.0, .to = 2.0 * kPi};
  EXPECT_GT(average_force(steel(), 4, {0.0, -1.0}, {&bottom, 1}).at(0.05 * mm).z(), 0.0);
}

// Each tooth removes c on every turn: N (K_rc c + K_re) on the radius.
TEST(CuttingForce, thrust_of_a_plunging_bottom_is_that_of_its_edges) {
  const double R = 4 * mm, c = 0.05 * mm;
  const int N = 4;
  const EngagedArc bottom{.width = R, .kappa = 0.0, .from = -1.0, .to = 2.0 * kPi - 1.0};
  const Eigen::Vector3d F = average_force(steel(), N, {0.0, -1.0}, {&bottom, 1}).at(c);
  expect_near(F, {0.0, 0.0, N * R * (steel().Krc * c + steel().Kre)}, kRounding);
}

TEST(CuttingForce, grows_linearly_with_feed_per_tooth_and_wear_of_the_edge) {
  const EngagedArc arc = flank(1 * mm, 0.0, 1.0);
  const CuttingForce F = average_force(steel(), 4, {}, {&arc, 1});
  const double c = 0.05 * mm;
  expect_near(F.at(c, 3.0) - F.at(c, 1.0), 2.0 * F.edge, kRounding);
  expect_near(F.at(3.0 * c) - F.at(c), 2.0 * c * F.shear, kRounding);
}

TEST(CuttingForce, angles_at_which_no_chip_is_removed_count_nothing) {
  const EngagedArc behind = flank(1 * mm, kPi, 2.0 * kPi);
  const CuttingForce F = average_force(steel(), 4, {}, {&behind, 1});
  EXPECT_EQ(F.shear.norm() + F.edge.norm(), 0.0);
  const EngagedArc all = flank(1 * mm, 0.0, 2.0 * kPi), half = flank(1 * mm, 0.0, kPi);
  expect_near(average_force(steel(), 4, {}, {&all, 1}).at(1e-5),
              average_force(steel(), 4, {}, {&half, 1}).at(1e-5), kRounding);
}

TEST(CuttingForce, edge_term_fades_for_a_cutter_that_comes_to_a_stand) {
  EXPECT_EQ(bearing_share(0.0), 0.0);
  EXPECT_EQ(bearing_share(0.5 * kBearingFeed), 0.5);
  EXPECT_EQ(bearing_share(kBearingFeed), 1.0);
  EXPECT_EQ(bearing_share(10.0 * kBearingFeed), 1.0);
}

TEST(Material, typical_coefficients_lie_within_their_plausible_ranges) {
  for (const Material& one : materials()) {
    for (const NamedCoefficient& K : kCuttingCoefficients) {
      EXPECT_LE(one.low.*K.member, one.typical.*K.member) << one.name << " " << K.name;
      EXPECT_GE(one.high.*K.member, one.typical.*K.member) << one.name << " " << K.name;
    }
  }
  EXPECT_EQ(find_material("42CrMo4")->typical.Ktc, 2300e6);  // N/m^2
  EXPECT_EQ(find_material("42CrMo4")->typical.Kre, 50e3);    // N/m
  EXPECT_EQ(find_material("butter"), nullptr);
}

}  // namespace
}  // namespace servomill::plant::cutting_force_test
