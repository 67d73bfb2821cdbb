#include "plant/cutting/machined_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::plant::machined_surface_test {
namespace {

using Eigen::Vector3d;
using Kind = Meeting::Kind;

constexpr double kExact = 1.001 * nm;  // what a way may be short of, and rounding
constexpr double kClearance = 2 * mm, kDepth = 1 * mm;

constexpr Cutter kFlat{.radius = 4e-3, .length = 20e-3};
constexpr Cutter kBall{.radius = 4e-3, .corner_radius = 4e-3, .length = 20e-3};
constexpr Cutter kBullNose{.radius = 4e-3, .corner_radius = 1e-3, .length = 20e-3};

// From one tip to the other in so many steps, the axis along Z.
CutterPass straight(const Cutter& cutter, const Vector3d& from, const Vector3d& to,
                    int steps = 40) {
  CutterPass pass{cutter, {}};
  for (int i = 0; i <= steps; ++i) {
    pass.positions.push_back({from + (to - from) * i / steps, Vector3d::UnitZ()});
  }
  return pass;
}

// Passes along X, so far from each other in Y.
std::vector<CutterPass> raster(const Cutter& cutter, double apart, int count) {
  std::vector<CutterPass> passes;
  for (int i = 0; i < count; ++i) {
    passes.push_back(straight(cutter, {-20e-3, i * apart, 0}, {20e-3, i * apart, 0}));
  }
  return passes;
}

double met(const std::vector<CutterPass>& passes, const ProbeTarget& target) {
  const Meeting meeting = MachinedSurface(passes).meet(target, kClearance, kDepth);
  EXPECT_EQ(meeting.kind, Kind::met);
  return meeting.distance;
}

TEST(MachinedSurface, of_a_flat_end_mill_is_a_plane_between_walls) {
  const std::vector<CutterPass> slot = {straight(kFlat, {-20e-3, 0, -1e-3}, {20e-3, 0, -1e-3})};
  EXPECT_NEAR(met(slot, {{1.23e-3, 2.7e-3, -1e-3}, Vector3d::UnitZ()}), 0.0, kExact);
  EXPECT_NEAR(met(slot, {{1.23e-3, 2.7e-3, -1.2e-3}, Vector3d::UnitZ()}), 0.2e-3, kExact);
  EXPECT_NEAR(met(slot, {{1.23e-3, 4.1e-3, 1e-3}, -Vector3d::UnitY()}), 0.1e-3, kExact);
  EXPECT_NEAR(met(slot, {{1.23e-3, -3.9e-3, 1e-3}, Vector3d::UnitY()}), -0.1e-3, kExact);
  // its end is the mill
  EXPECT_NEAR(met(slot, {{24e-3, 1e-3, 1e-3}, -Vector3d::UnitX()}),
              24e-3 - (20e-3 + std::sqrt(15.0) * mm), kExact);
}

TEST(MachinedSurface, of_a_ramp_is_inclined_and_turns_with_the_tool) {
  // tool tilted so that its bottom lies in the ramp: the plane through the tips
  const Vector3d along = Vector3d(4, 0, -3) / 5, up = Vector3d(3, 0, 4) / 5;
  CutterPass pass{kFlat, {}};
  for (int i = 0; i < 50; ++i) pass.positions.push_back({along * (i * 0.1e-3), up});
  EXPECT_NEAR(met({pass}, {along * 2e-3 + Vector3d(0, 1e-3, 0) + 0.3e-3 * up, up}), -0.3e-3,
              kExact);
}

TEST(MachinedSurface, of_a_ball_end_mill_has_scallops) {
  constexpr double kApart = 0.5e-3;
  const auto passes = raster(kBall, kApart, 7);
  const double height = 4e-3 - std::sqrt(16e-6 - kApart * kApart / 4);  // about a^2 / 8 R
  EXPECT_NEAR(met(passes, {{0.17e-3, 3 * kApart, 0}, Vector3d::UnitZ()}), 0.0, kExact);
  EXPECT_NEAR(met(passes, {{0.17e-3, 3.5 * kApart, 0}, Vector3d::UnitZ()}), height, kExact);
  const double y = 0.2 * kApart;
  EXPECT_NEAR(met(passes, {{0.17e-3, 3 * kApart + y, 0}, Vector3d::UnitZ()}),
              4e-3 - std::sqrt(16e-6 - y * y), kExact);
}

TEST(MachinedSurface, of_a_bull_nose_has_cusps_between_flats) {
  constexpr double kApart = 7e-3;  // flats of 6 mm
  const auto passes = raster(kBullNose, kApart, 3);
  EXPECT_NEAR(met(passes, {{0.17e-3, kApart + 2.9e-3, 0}, Vector3d::UnitZ()}), 0.0, kExact);
  const double height = 1e-3 - std::sqrt(1e-6 - 0.25e-6);
  EXPECT_NEAR(met(passes, {{0.17e-3, 1.5 * kApart, 0}, Vector3d::UnitZ()}), height, kExact);
  EXPECT_NEAR(met(passes, {{0.17e-3, 1.5 * kApart - 0.2e-3, 0}, Vector3d::UnitZ()}),
              1e-3 - std::sqrt(1e-6 - 0.09e-6), kExact);
}

TEST(MachinedSurface, of_a_circular_path_is_a_polygon_of_steps) {
  constexpr int kSteps = 720;
  constexpr double kPath = 30e-3;
  CutterPass circle{kFlat, {}};
  for (int i = 0; i <= kSteps; ++i) {
    const double a = 2 * std::numbers::pi * i / kSteps;
    circle.positions.push_back({{kPath * std::cos(a), kPath * std::sin(a), 0}, Vector3d::UnitZ()});
  }
  const MachinedSurface surface({circle});
  const double half = std::numbers::pi / kSteps;
  for (const int i : {0, 17, 180, 333, 719}) {
    const double a = 2 * half * i;
    const Vector3d corner(std::cos(a), std::sin(a), 0);
    const Vector3d middle(std::cos(a + half), std::sin(a + half), 0);
    const Vector3d up(0, 0, 5e-3);
    // inner flank: the boss; the middle of a step cuts deepest
    EXPECT_NEAR(surface.meet({26e-3 * middle + up, middle}, kClearance, kDepth).distance,
                kPath * std::cos(half) - 4e-3 - 26e-3, kExact);
    // outer flank: the bore; at a corner the mill's own radius
    EXPECT_NEAR(surface.meet({34e-3 * corner + up, -corner}, kClearance, kDepth).distance, 0.0,
                kExact);
    EXPECT_NEAR(surface.meet({34e-3 * middle + up, -middle}, kClearance, kDepth).distance,
                34e-3 - (kPath * std::cos(half) + 4e-3), kExact);
  }
}

TEST(MachinedSurface, of_a_cone_milled_by_a_turning_flank) {
  // swarf milling: the axis goes round with the part, tilted; its foot on a circle: a cone, exactly
  // in the limit of small steps
  constexpr int kSteps = 3600;
  constexpr double kFoot = 30e-3, kTilt = 10 * deg;
  CutterPass circle{kFlat, {}};
  for (int i = 0; i <= kSteps; ++i) {
    const double a = 2 * std::numbers::pi * i / kSteps;
    const Vector3d e(std::cos(a), std::sin(a), 0);
    circle.positions.push_back(
        {kFoot * e, std::sin(kTilt) * e + std::cos(kTilt) * Vector3d::UnitZ()});
  }
  const MachinedSurface surface({circle});
  for (const double a : {0.0003, 1.0, 4.0}) {
    const Vector3d e(std::cos(a), std::sin(a), 0);
    const Vector3d k = std::sin(kTilt) * e + std::cos(kTilt) * Vector3d::UnitZ();
    const Vector3d inward = -std::cos(kTilt) * e + std::sin(kTilt) * Vector3d::UnitZ();
    for (const double h : {3e-3, 11e-3, 18e-3}) {
      const Vector3d point = kFoot * e + h * k + kFlat.radius * inward;
      const Meeting meeting = surface.meet({point, -inward}, kClearance, kDepth);
      ASSERT_EQ(meeting.kind, Kind::met);
      // sagitta of a step of 52 um on a radius of 30 mm and more
      const double sagitta = 0.5 * point.head<2>().norm() * std::pow(std::numbers::pi / kSteps, 2);
      EXPECT_NEAR(meeting.distance, -0.5 * sagitta, 0.6 * sagitta + 10 * nm);
    }
  }
}

constexpr double kContact = 50 * nm;  // of a probe ball
constexpr double kProbe = 1 * mm;

TEST(MachinedSurface, is_touched_by_a_ball_where_a_plane_is_met) {
  const MachinedSurface surface({straight(kFlat, {-20e-3, 0, -1e-3}, {20e-3, 0, -1e-3})});
  const Meeting meeting =
      surface.touch({{0, 1e-3, -1e-3}, Vector3d::UnitZ()}, kProbe, kClearance, kDepth);
  EXPECT_EQ(meeting.kind, Kind::met);
  EXPECT_NEAR(meeting.distance, 0.0, kContact);
  // the wall of the slot is nearer than the ball's radius
  EXPECT_EQ(surface.touch({{0, 3.5e-3, -1e-3}, Vector3d::UnitZ()}, kProbe, kClearance, kDepth).kind,
            Kind::blocked);
}

// Between two cusps, y beside the middle of the groove of radius R that the ball end mill left.
double on_scallops(double y, double R, double r, double apart) {
  const double height = R - std::sqrt(R * R - apart * apart / 4);
  const double beside = apart / 2 - y;
  // it lies in the groove as long as it touches it before the cusp, else on the cusp
  if (r < R && y * R / (R - r) < apart / 2) return R - r - std::sqrt((R - r) * (R - r) - y * y);
  return height - (r - std::sqrt(r * r - beside * beside));
}

TEST(MachinedSurface, carries_a_ball_by_its_scallops) {
  constexpr double kApart = 0.5e-3;
  const MachinedSurface surface(raster(kBall, kApart, 25));
  for (const double radius : {kProbe, 5 * mm}) {
    for (const double offset : {0.0, 0.1, 0.3, 0.4, 0.5}) {
      const Meeting meeting = surface.touch(
          {{0.17e-3, (12 + offset) * kApart, 0}, Vector3d::UnitZ()}, radius, 1 * mm, kDepth);
      EXPECT_EQ(meeting.kind, Kind::met);
      EXPECT_NEAR(meeting.distance, on_scallops(offset * kApart, kBall.radius, radius, kApart),
                  kContact)
          << "probe " << radius / mm << " mm, offset " << offset;
    }
  }
}

TEST(MachinedSurface, lets_a_ball_into_a_wider_groove_but_not_into_a_narrower_one) {
  const auto groove = [](double radius) {
    const Cutter wide{.radius = 10e-3, .length = 20e-3};
    const Cutter ball{.radius = radius, .corner_radius = radius, .length = 20e-3};
    return MachinedSurface({straight(wide, {-20e-3, 0, 0}, {20e-3, 0, 0}),
                            straight(ball, {-20e-3, 0, -0.3e-3}, {20e-3, 0, -0.3e-3})});
  };
  const ProbeTarget target = {{0.3e-3, 0, 0}, Vector3d::UnitZ()};
  // in the wide one it lies on the ground
  EXPECT_NEAR(groove(2e-3).touch(target, kProbe, kClearance, kDepth).distance, -0.3e-3, kContact);
  // the narrow one carries it by its edges
  const double edge = std::sqrt(0.25e-6 - 0.04e-6);
  EXPECT_NEAR(groove(0.5e-3).touch(target, kProbe, kClearance, kDepth).distance,
              -(kProbe - std::sqrt(kProbe * kProbe - edge * edge)), kContact);
}

// A plunge leaves a bore of the tool's radius R. A ball of radius r starts with its near side a
// clearance c off the wall, so that its middle lies r + c - R beyond the axis: it fits while that
// and r are within R, that is up to r = R - c / 2.
TEST(MachinedSurface, lets_a_ball_into_a_bore_that_is_little_wider) {
  const double R = kFlat.radius;
  const MachinedSurface bore({straight(kFlat, {0, 0, 20e-3}, {0, 0, -20e-3})});
  const ProbeTarget wall = {{R, 0, 0}, -Vector3d::UnitX()};
  const Meeting fits = bore.touch(wall, R - 0.51 * kClearance, kClearance, kDepth);
  EXPECT_EQ(fits.kind, Kind::met);
  EXPECT_NEAR(fits.distance, 0.0, kContact);
  EXPECT_EQ(bore.touch(wall, R - 0.49 * kClearance, kClearance, kDepth).kind, Kind::blocked);
}

TEST(MachinedSurface, is_the_same_for_any_number_of_threads) {
  const MachinedSurface surface(raster(kBullNose, 1.5e-3, 9));
  std::vector<ProbeTarget> targets;
  for (int i = 0; i < 1000; ++i) {
    targets.push_back({{0.02e-3 * i, 0.013e-3 * i, 0}, Vector3d(0.1, -0.2, 1).normalized()});
  }
  const auto one = surface.meet(targets, kClearance, kDepth, 1);
  ASSERT_EQ(one.size(), targets.size());
  for (const unsigned threads : {0U, 2U, 7U}) {
    EXPECT_EQ(surface.meet(targets, kClearance, kDepth, threads), one);
  }
  EXPECT_EQ(one[500], surface.meet(targets[500], kClearance, kDepth));
}

TEST(MachinedSurface, says_what_became_of_a_probe_that_met_nothing) {
  const MachinedSurface surface({straight(kFlat, {-20e-3, 0, 0}, {20e-3, 0, 0})});
  const auto kind = [&](const Vector3d& point, const Vector3d& normal) {
    return surface.meet({point, normal}, kClearance, kDepth).kind;
  };
  EXPECT_EQ(kind({0, 0, 0}, Vector3d::UnitZ()), Kind::met);
  EXPECT_EQ(kind({0, 6e-3, 0}, Vector3d::UnitZ()), Kind::untouched);
  EXPECT_EQ(kind({0, 0, 19e-3}, Vector3d::UnitZ()), Kind::blocked);
  EXPECT_EQ(kind({0, 0, 10e-3}, Vector3d::UnitZ()), Kind::through);
  EXPECT_EQ(MachinedSurface({}).meet({{0, 0, 0}, Vector3d::UnitZ()}, kClearance, kDepth).kind,
            Kind::untouched);
}

TEST(MachinedSurface, ends_at_material_that_was_left_before_a_deeper_cut) {
  // a slot, and another one under it, found whichever comes first
  const Cutter low{.radius = 4e-3, .length = 3e-3};
  const auto upper = straight(low, {-20e-3, 0, 0}, {20e-3, 0, 0});
  const auto apart = straight(low, {-20e-3, 0, -3.5e-3}, {20e-3, 0, -3.5e-3});
  const auto joined = straight(low, {-20e-3, 0, -2.5e-3}, {20e-3, 0, -2.5e-3});
  const ProbeTarget target = {{0, 0, 0}, Vector3d::UnitZ()};
  for (const auto& passes : {std::vector{upper, apart}, std::vector{apart, upper}}) {
    const Meeting meeting = MachinedSurface(passes).meet(target, kClearance, 10e-3);
    EXPECT_EQ(meeting.kind, Kind::met);
    EXPECT_NEAR(meeting.distance, 0.0, kExact);
  }
  for (const auto& passes : {std::vector{upper, joined}, std::vector{joined, upper}}) {
    EXPECT_NEAR(MachinedSurface(passes).meet(target, kClearance, 10e-3).distance, -2.5e-3, kExact);
  }
}

TEST(MachinedSurface, tells_the_position_that_left_a_point) {
  const MachinedSurface surface(raster(kBall, 0.5e-3, 3));  // 41 positions each, 1 mm apart
  const Meeting meeting =
      surface.meet({{0.3e-3, 0.51e-3, 0}, Vector3d::UnitZ()}, kClearance, kDepth);
  EXPECT_EQ(meeting.position, 41U + 21U);
}

}  // namespace
}  // namespace servomill::plant::machined_surface_test
