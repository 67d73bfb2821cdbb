/// Places at which points were cut, worked out by hand.
#include "sim/preparation/cut_places.h"

#include <gtest/gtest.h>

#include "tests/sim/preparation/tool_row_paths.h"

namespace servomill::sim::preparation::cut_places_test {
namespace {

using Eigen::Vector3d;

constexpr double kShareTol = 1e-9;
const plant::Cutter kMill = cutter(4.0);

SurfacePoint point(const Vector3d& p, const Vector3d& n, double deviation_um = 0.0) {
  return {p * mm, n.normalized(), deviation_um * um};
}

void expect_places(const CutSearch& found, const std::vector<double>& places, CutBy by) {
  ASSERT_EQ(found.places.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const CutPlace& one = found.places[i];
    EXPECT_NEAR(static_cast<double>(one.row) + one.share, places[i], kShareTol);
    EXPECT_EQ(one.by, by);
  }
}

void expect_place(const CutSearch& found, double place, CutBy by) {
  expect_places(found, {place}, by);
}

TEST(CutPlaces, OfAWallLieARadiusFromIt) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  expect_place(find_cut(rows, point({37.25, 0, -5}, {0, -1, 0})), 37.25, CutBy::flank);
  // a normal into the part: the tool would be at Y4
  const CutSearch inside = find_cut(rows, point({37.25, 0, -5}, {0, 1, 0}));
  EXPECT_TRUE(inside.places.empty());
  EXPECT_NEAR(inside.nearest, 8 * mm, 1e-12);
  EXPECT_EQ(inside.nearest_row, 37U);
}

TEST(CutPlaces, OfAWallReachFromTheTipToTheEndOfTheFlutes) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  EXPECT_FALSE(find_cut(rows, point({50, 0, -10}, {0, -1, 0})).places.empty());
  EXPECT_FALSE(find_cut(rows, point({50, 0, 20}, {0, -1, 0})).places.empty());
  EXPECT_NEAR(find_cut(rows, point({50, 0, -12}, {0, -1, 0})).nearest, 2 * mm, 1e-12);
  EXPECT_NEAR(find_cut(rows, point({50, 0, 21}, {0, -1, 0})).nearest, 1 * mm, 1e-12);
}

// The flank of a tool with a corner begins above it.
TEST(CutPlaces, OfAWallLieAboveTheCorner) {
  const plant::Cutter bull = cutter(4.0, 1.0);
  const auto rows = ToolPath(bull).from(0, -4, -10).to(100, -4, -10).rows;
  EXPECT_FALSE(find_cut(rows, point({50, 0, -9}, {0, -1, 0})).places.empty());
  EXPECT_NEAR(find_cut(rows, point({50, 0, -10}, {0, -1, 0})).nearest, 1 * mm, 1e-12);
}

TEST(CutPlaces, AreRefusedBeyondATenthOfAMillimetreAndTheDeviation) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  const auto is_found = [&](double y, double deviation_um) {
    return find_cut(rows, point({50, y, -5}, {0, -1, 0}, deviation_um)).places.size() == 1;
  };
  EXPECT_TRUE(is_found(0.099, 0.0));
  EXPECT_FALSE(is_found(0.101, 0.0));
  EXPECT_TRUE(is_found(0.149, -50.0));
  EXPECT_FALSE(is_found(0.151, 50.0));
}

TEST(CutPlaces, OfABossAndABoreLieOnTheirAngle) {
  const Vector3d out(std::cos(30 * deg), std::sin(30 * deg), 0.0);
  const auto around = ToolPath(kMill).circle(24.0, -10.0).rows;
  expect_place(find_cut(around, point(20.0 * out - 5.0 * Vector3d::UnitZ(), out)), 30.0,
               CutBy::flank);
  const auto within = ToolPath(kMill).circle(6.0, -10.0).rows;
  expect_place(find_cut(within, point(10.0 * out - 5.0 * Vector3d::UnitZ(), -out)), 30.0,
               CutBy::flank);
}

// The first and the last place of a closed contour are one.
TEST(CutPlaces, OfAClosedContourAreItsBeginningAndItsEnd) {
  const auto rows = ToolPath(kMill).circle(24.0, -10.0).rows;
  expect_places(find_cut(rows, point({20, 0, -5}, {1, 0, 0})), {0.0, 360.0}, CutBy::flank);
}

// Rows leave out where its ends turn to and from the wall: 20 um behind the point and 10 um before.
TEST(CutPlaces, OfAClosedContourMayBeMissedByAStep) {
  const auto rows =
      ToolPath(kMill).from(20.02, -4, -10).to(60, -4, -10).from(0, -4, -10).to(19.99, -4, -10).rows;
  expect_places(find_cut(rows, point({20, 0, -5}, {0, -1, 0})), {0.0, 61.0}, CutBy::flank);
}

// Two passes 6 mm apart: rows 0 to 50 and 51 to 101.
TEST(CutPlaces, OfAFloorLieWhereTheAxisComesNearest) {
  const auto rows = ToolPath(kMill).from(0, 0, 0).to(50, 0, 0).from(0, 6, 0).to(50, 6, 0).rows;
  expect_place(find_cut(rows, point({20.5, 2.9, 0}, {0, 0, 1})), 20.5, CutBy::tip);
  expect_places(find_cut(rows, point({20.5, 3.0, 0}, {0, 0, 1})), {20.5, 71.5}, CutBy::tip);
  expect_place(find_cut(rows, point({20.5, 9.9, 0}, {0, 0, 1})), 71.5, CutBy::tip);
  EXPECT_TRUE(find_cut(rows, point({20.5, 10.2, 0}, {0, 0, 1})).places.empty());
  EXPECT_TRUE(find_cut(rows, point({20.5, 0, -1}, {0, 0, 1})).places.empty());
  EXPECT_NEAR(find_cut(rows, point({20.5, 0, -1}, {0, 0, 1})).nearest, 1 * mm, 1e-12);
}

// The pass before leaves 50 um: it is nearer to the axis, but not to the floor.
TEST(CutPlaces, OfAFloorAreThoseOfThePassAtItsHeight) {
  const auto rows =
      ToolPath(kMill).from(0, 0, 0).to(50, 0, 0).from(0, 0, 0.05).to(50, 0, 0.05).rows;
  expect_place(find_cut(rows, point({20.5, 1, 0}, {0, 0, 1})), 20.5, CutBy::tip);
}

// Passes at two depths, of which the deeper one alone reaches down to Z-6.
TEST(CutPlaces, AreThoseOfAllPassesAlongAWall) {
  const auto rows =
      ToolPath(kMill).from(0, -4, -5).to(50, -4, -5).from(0, -4, -10).to(50, -4, -10).rows;
  expect_places(find_cut(rows, point({20.5, 0, -4}, {0, -1, 0})), {20.5, 71.5}, CutBy::flank);
  expect_place(find_cut(rows, point({20.5, 0, -6}, {0, -1, 0})), 71.5, CutBy::flank);
}

// A slope of 45 deg: the centre of a ball of 5 mm stands 5 mm off along its normal.
TEST(CutPlaces, OfASlopeLieAtTheCentreOfTheBall) {
  const plant::Cutter ball = cutter(5.0, 5.0);
  const Vector3d n = Vector3d(0, -1, 1).normalized(), tip = 5.0 * n - Vector3d(0, 0, 5);
  const auto rows = ToolPath(ball).from(0, tip.y(), tip.z()).to(50, tip.y(), tip.z()).rows;
  expect_place(find_cut(rows, point({12.5, 0, 0}, n)), 12.5, CutBy::corner);
  EXPECT_TRUE(find_cut(rows, point({12.5, 0.2, 0}, n)).places.empty());
  // a floor, too, is cut by the corner, which of a ball is all there is
  const auto flat = ToolPath(ball).from(0, 0, -2).to(50, 0, -2).rows;
  expect_place(find_cut(flat, point({12.5, 0, -2}, {0, 0, 1})), 12.5, CutBy::corner);
  // and a wall by its equator
  const auto wall = ToolPath(ball).from(0, -5, -10).to(50, -5, -10).rows;
  expect_place(find_cut(wall, point({12.5, 0, -5}, {0, -1, 0})), 12.5, CutBy::flank);
  EXPECT_TRUE(find_cut(wall, point({12.5, 0, -6}, {0, -1, 0})).places.empty());
}

// The corner of a bull nose, 2 mm on a tool of 6 mm, touches 4 mm beside the axis and 2 mm above
// the tip, and from there 2 mm along the normal.
TEST(CutPlaces, OfASlopeLieAtTheCornerOfABullNose) {
  const plant::Cutter bull = cutter(6.0, 2.0);
  const Vector3d n = Vector3d(0, -1, 1).normalized();
  const Vector3d tip = 2.0 * n + Vector3d(0, -4, 0) - Vector3d(0, 0, 2);
  const auto rows = ToolPath(bull).from(0, tip.y(), tip.z()).to(50, tip.y(), tip.z()).rows;
  expect_place(find_cut(rows, point({12.5, 0, 0}, n)), 12.5, CutBy::corner);
  EXPECT_TRUE(find_cut(rows, point({12.5, 0.3, 0}, n)).places.empty());
}

// The tool leans by 30 deg across its path, and so does the wall that its flank leaves.
TEST(CutPlaces, FollowTheToolAxis) {
  const Vector3d k(0, -0.5, std::sqrt(0.75)), n(0, -std::sqrt(0.75), -0.5);
  const Vector3d p = Vector3d(12.5, 0, 0) - 4.0 * n + 7.0 * k;  // 7 mm above the tip
  const auto rows = ToolPath(kMill).axis(k).from(0, 0, 0).to(50, 0, 0).rows;
  expect_place(find_cut(rows, point(p, n)), 12.5, CutBy::flank);
  EXPECT_TRUE(find_cut(rows, point(p, {0, -1, 0})).places.empty());
}

// Around a corner, the last point of the first wall is cut on the leg along it, although the tool
// is as near where it sets out along the other.
TEST(CutPlaces, AtACornerLieOnTheLegAlongTheWall) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(54, -4, -10).to(54, 50, -10).rows;
  expect_place(find_cut(rows, point({50, 0, -5}, {0, -1, 0})), 50.0, CutBy::flank);
  expect_place(find_cut(rows, point({50, 0, -5}, {1, 0, 0})), 58.0, CutBy::flank);
}

TEST(CutPlaces, AreNoneWhereTheToolMovesAlongTheNormal) {
  const auto slot = ToolPath(kMill).from(0, 0, -10).to(50, 0, -10).rows;
  const CutSearch end = find_cut(slot, point({54, 0, -5}, {-1, 0, 0}));
  EXPECT_TRUE(end.places.empty());
  EXPECT_TRUE(end.is_along);
  const auto hole = ToolPath(kMill).from(0, 0, 0).to(0, 0, -10).rows;
  EXPECT_TRUE(find_cut(hole, point({4, 0, -5}, {-1, 0, 0})).is_along);
  EXPECT_TRUE(find_cut(hole, point({0, 0, -10}, {0, 0, 1})).is_along);
}

TEST(CutPlaces, AreNotInRapidMovesNorOfUnknownCutters) {
  auto rows = ToolPath(kMill).from(0, -4, -10).rapid(100, -4, -10).rows;
  EXPECT_TRUE(std::isinf(find_cut(rows, point({50, 0, -5}, {0, -1, 0})).nearest));
  rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  for (ToolRow& row : rows) row.cutter = nullptr;
  EXPECT_TRUE(std::isinf(find_cut(rows, point({50, 0, -5}, {0, -1, 0})).nearest));
}

}  // namespace
}  // namespace servomill::sim::preparation::cut_places_test
