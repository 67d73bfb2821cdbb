#include "plant/cutting/engagement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/cutting/stock.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::engagement_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAngleTol = 2e-4 * kPi;  // rad, to which entry and exit are bisected
constexpr double kDepthTol = 3 * um;      // to which heights are

const Cutter kFlat{.radius = 4 * mm, .length = 30 * mm, .teeth = 4};

// Everything on one side of planes x <= , y <= , z <= .
Stock block(double x, double y, double z) {
  return Stock({StockBox{{-1.0, -1.0, -1.0}, {x, y, z}}});
}

std::vector<EngagedArc> arcs_in(const Stock& stock, const Cutter& cutter,
                                const CutterMotion& motion) {
  return engagement(
      cutter, motion, [&](const Eigen::Vector3d& p) { return stock.contains(p); }, stock.bounds());
}

CutterMotion along_x(double x, double y, double z) { return {{{x, y, z}}, {1.0, 0.0, 0.0}}; }

double depth_of(const std::vector<EngagedArc>& arcs) {
  double depth = 0.0;
  for (const EngagedArc& arc : arcs) depth += arc.width;
  return depth;
}

TEST(Engagement, is_half_a_turn_in_a_slot_as_deep_as_the_slot) {
  const auto arcs = arcs_in(block(1.0, 1.0, 0.0), kFlat, along_x(0.0, 0.0, -2 * mm));
  ASSERT_FALSE(arcs.empty());
  EXPECT_NEAR(depth_of(arcs), 2 * mm, kDepthTol);
  for (const EngagedArc& arc : arcs) {
    EXPECT_EQ(arc.from, 0.0);
    EXPECT_EQ(arc.to, kPi);
    EXPECT_GE(arc.height, 0.0);
    EXPECT_LE(arc.height, 2 * mm);
  }
}

// A piece of a corner turns by 7.5 deg at most: its middle is off that of its heights by
// r (1 - cos 3.75 deg).
constexpr double kPieceOfCorner = 0.0022;

// For every profile and direction the engagement reaches to the top of the block.
TEST(Engagement, reaches_to_the_top_of_what_is_cut) {
  for (const double corner : {0.0, 1 * mm, 4 * mm}) {
    Cutter cutter = kFlat;
    cutter.corner_radius = corner;
    for (const double depth : {0.3 * mm, 2 * mm, 25 * mm}) {
      for (const double slope : {0.0, -0.2, 0.2}) {
        CutterMotion motion = along_x(0.0, 0.0, -depth);
        motion.feed = Eigen::Vector3d(1.0, 0.0, slope).normalized();
        EXPECT_NEAR(engaged_height(arcs_in(block(1.0, 1.0, 0.0), cutter, motion)), depth,
                    kDepthTol + kPieceOfCorner * corner)
            << corner << " " << slope;
      }
    }
  }
  EXPECT_EQ(engaged_height({}), 0.0);
}

// Material on the right of a cutter that turns clockwise: climb milling, it leaves at 180 degrees.
TEST(Engagement, of_a_shoulder_follows_from_its_width) {
  for (const double ae : {0.02 * mm, 0.1 * mm, 1 * mm, 4 * mm, 6 * mm, 7.9 * mm}) {
    const auto right =
        arcs_in(block(1.0, 0.0, 0.0), kFlat, along_x(0.0, kFlat.radius - ae, -1 * mm));
    ASSERT_FALSE(right.empty()) << ae;
    const double phi = std::acos(1.0 - ae / kFlat.radius);
    for (const EngagedArc& arc : right) {
      EXPECT_NEAR(arc.from, kPi - phi, kAngleTol);
      EXPECT_EQ(arc.to, kPi);
    }
    const Stock left_wall({StockBox{{-1.0, 0.0, -1.0}, {1.0, 1.0, 0.0}}});
    const auto left = arcs_in(left_wall, kFlat, along_x(0.0, ae - kFlat.radius, -1 * mm));
    ASSERT_FALSE(left.empty()) << ae;
    for (const EngagedArc& arc : left) {
      EXPECT_EQ(arc.from, 0.0);
      EXPECT_NEAR(arc.to, phi, kAngleTol);
    }
    EXPECT_NEAR(depth_of(left), 1 * mm, kDepthTol);
  }
}

TEST(Engagement, counter_clockwise_is_the_mirror_image) {
  CutterMotion motion = along_x(0.0, kFlat.radius - 1 * mm, -1 * mm);
  motion.clockwise = false;
  const auto arcs = arcs_in(block(1.0, 0.0, 0.0), kFlat, motion);
  ASSERT_FALSE(arcs.empty());
  EXPECT_EQ(arcs.front().from, 0.0);
  EXPECT_NEAR(arcs.front().to, std::acos(1.0 - 1 * mm / kFlat.radius), kAngleTol);
}

// A strip narrower than the cutter, off its middle: it enters and leaves within the material's
// sides.
TEST(Engagement, of_face_milling_lies_between_the_sides_of_the_strip) {
  const Stock strip({StockBox{{-1.0, -3 * mm, -1.0}, {1.0, 1 * mm, 0.0}}});
  const auto arcs = arcs_in(strip, kFlat, along_x(0.0, 0.0, -0.1 * mm));
  ASSERT_FALSE(arcs.empty());
  EXPECT_NEAR(depth_of(arcs), 0.1 * mm, kDepthTol);
  for (const EngagedArc& arc : arcs) {
    EXPECT_NEAR(arc.from, std::acos(1 * mm / kFlat.radius), kAngleTol);
    EXPECT_NEAR(arc.to, std::acos(-3 * mm / kFlat.radius), kAngleTol);
  }
}

TEST(Engagement, two_strips_are_two_arcs) {
  const Stock strips({StockBox{{-1.0, -3 * mm, -1.0}, {1.0, -1 * mm, 0.0}},
                      StockBox{{-1.0, 1 * mm, -1.0}, {1.0, 2 * mm, 0.0}}});
  const auto arcs = arcs_in(strips, kFlat, along_x(0.0, 0.0, -0.1 * mm));
  ASSERT_GE(arcs.size(), 2U);
  EXPECT_NEAR(arcs[0].from, std::acos(2 * mm / kFlat.radius), kAngleTol);
  EXPECT_NEAR(arcs[0].to, std::acos(1 * mm / kFlat.radius), kAngleTol);
  EXPECT_NEAR(arcs[1].from, std::acos(-1 * mm / kFlat.radius), kAngleTol);
  EXPECT_NEAR(depth_of(arcs), 2 * 0.1 * mm, 2 * kDepthTol);
}

TEST(Engagement, is_cut_into_heights_where_a_step_is) {
  const Stock step({StockBox{{-1.0, -1.0, -1.0}, {1.0, 0.0, 0.0}},
                    StockBox{{-1.0, 0.0, -1.0}, {1.0, 1.0, -3 * mm}}});
  double slot = 0.0, side = 0.0;
  for (const EngagedArc& arc : arcs_in(step, kFlat, along_x(0.0, 0.0, -5 * mm))) {
    if (arc.from == 0.0) {
      slot += arc.width;
    } else {
      EXPECT_NEAR(arc.from, 0.5 * kPi, kAngleTol);
      side += arc.width;
    }
  }
  EXPECT_NEAR(slot, 2 * mm, kDepthTol);
  EXPECT_NEAR(side, 3 * mm, kDepthTol);
}

TEST(Engagement, of_a_shallow_cut_deep_below_the_top_is_found) {
  // a wall 30 mm high has been cleared but for the last 0.05 mm at the floor
  const auto is_material = [](const Eigen::Vector3d& p) { return p.z() < 0.05 * mm; };
  const auto arcs =
      engagement(kFlat, along_x(0.0, 0.0, 0.0), is_material,
                 {Eigen::Vector3d(-1.0, -1.0, -1.0), Eigen::Vector3d(1.0, 1.0, 30 * mm)});
  EXPECT_NEAR(depth_of(arcs), 0.05 * mm, kDepthTol);
}

// A web on the way of the flank, at any height.
TEST(Engagement, finds_thin_walls_all_along_the_flank) {
  for (double bottom = 0.3 * mm; bottom < 26 * mm; bottom += 1.7 * mm) {
    for (const double thickness : {0.6 * mm, 3 * mm}) {
      const Stock web({StockBox{{-1.0, -1.0, bottom}, {1.0, -2 * mm, bottom + thickness}},
                       StockBox{{-1.0, -1.0, 40 * mm}, {1.0, -2 * mm, 41 * mm}}});
      const auto arcs = arcs_in(web, kFlat, along_x(0.0, 0.0, 0.0));
      EXPECT_NEAR(depth_of(arcs), thickness, kDepthTol) << bottom;
    }
  }
}

TEST(Engagement, in_air_there_is_none) {
  EXPECT_TRUE(arcs_in(block(1.0, 1.0, 0.0), kFlat, along_x(0.0, 0.0, 1 * mm)).empty());
  EXPECT_TRUE(arcs_in(block(-5 * mm, 1.0, 0.0), kFlat, along_x(0.0, 0.0, -1 * mm)).empty());
  EXPECT_TRUE(arcs_in(Stock(), kFlat, along_x(0.0, 0.0, -1 * mm)).empty());
  EXPECT_TRUE(
      arcs_in(block(1.0, 1.0, 0.0), kFlat, {{{0.0, 0.0, -2 * mm}}, {0.0, 0.0, 1.0}}).empty())
      << "drawn back";
}

TEST(Engagement, bottom_cuts_where_the_cutter_plunges) {
  const auto arcs = arcs_in(block(1.0, 1.0, 0.0), kFlat, {{{0.0, 0.0, -2 * mm}}, {0.0, 0.0, -1.0}});
  EXPECT_NEAR(depth_of(arcs), kFlat.radius, kDepthTol);
  for (const EngagedArc& arc : arcs) {
    EXPECT_EQ(arc.kappa, 0.0);
    EXPECT_NEAR(arc.to - arc.from, 2.0 * kPi, kAngleTol);
  }
}

// A ball in a slot: the profile up to the depth of cut, each height with its own normal. Feed
// across: half a turn everywhere.
TEST(Engagement, of_a_ball_is_its_profile_up_to_the_depth) {
  const Cutter ball{.radius = 4 * mm, .corner_radius = 4 * mm, .length = 30 * mm};
  const double depth = 1 * mm;
  const auto arcs = arcs_in(block(1.0, 1.0, 0.0), ball, along_x(0.0, 0.0, -depth));
  EXPECT_NEAR(depth_of(arcs), ball.radius * std::acos(1.0 - depth / ball.radius), kDepthTol);
  for (const EngagedArc& arc : arcs) {
    EXPECT_EQ(arc.from, 0.0);
    EXPECT_EQ(arc.to, kPi);
    EXPECT_NEAR(arc.height, ball.radius * (1.0 - std::cos(arc.kappa)), 1e-12);
  }
}

TEST(Engagement, turns_with_the_cutter) {
  // the slot again, all of it turned about an oblique axis
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  const Stock stock = block(1.0, kFlat.radius - 3 * mm, 0.0);
  const auto is_material = [&](const Eigen::Vector3d& p) {
    return stock.contains(R.transpose() * p);
  };
  CutterMotion motion = along_x(0.0, 0.0, -2 * mm);
  motion.position = {R * motion.position.tip, R * motion.position.axis};
  motion.feed = R * motion.feed;
  const Eigen::AlignedBox3d within(Eigen::Vector3d::Constant(-0.05),
                                   Eigen::Vector3d::Constant(0.05));
  const auto arcs = engagement(kFlat, motion, is_material, within);
  EXPECT_NEAR(depth_of(arcs), 2 * mm, kDepthTol);
  for (const EngagedArc& arc : arcs) {
    EXPECT_NEAR(arc.from, std::acos((kFlat.radius - 3 * mm) / kFlat.radius), kAngleTol);
    EXPECT_EQ(arc.to, kPi);
  }
}

TEST(Stock, turned_boxes_and_cylinders_hold_what_they_should) {
  const Stock stock({StockBox{{-20 * mm, -10 * mm, 0.0}, {20 * mm, 10 * mm, 5 * mm}, 90 * deg},
                     StockCylinder{{0.1, 0.0}, 5 * mm, -1 * mm, 1 * mm}});
  EXPECT_TRUE(stock.contains({0.0, 19 * mm, 1 * mm}));
  EXPECT_FALSE(stock.contains({19 * mm, 0.0, 1 * mm}));
  EXPECT_FALSE(stock.contains({0.0, 0.0, -1 * mm}));
  EXPECT_TRUE(stock.contains({0.1, 4.9 * mm, -0.9 * mm}));
  EXPECT_FALSE(stock.contains({0.1 + 4 * mm, 4 * mm, 0.0}));
  EXPECT_NEAR(stock.bounds().min().x(), -10 * mm, 1e-12);
  EXPECT_NEAR(stock.bounds().max().x(), 105 * mm, 1e-12);
  EXPECT_NEAR(stock.bounds().max().y(), 20 * mm, 1e-12);
}

}  // namespace
}  // namespace servomill::plant::engagement_test
