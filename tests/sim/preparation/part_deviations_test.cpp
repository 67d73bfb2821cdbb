/// Deviations between probed points, worked out by hand.
#include "sim/preparation/part_deviations.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/sim/preparation/tool_row_paths.h"

namespace servomill::sim::preparation::part_deviations_test {
namespace {

using Eigen::Vector3d;

constexpr double kTol = 1e-12;  // m, rounding
const plant::Cutter kMill = cutter(4.0);

struct Probed {
  Vector3d p, n;
  double deviation_um;
};

PartDeviations deviations(const std::vector<ToolRow>& rows, const std::vector<Probed>& points) {
  std::vector<ProbedCut> cuts;
  for (const Probed& one : points) {
    const Vector3d n = one.n.normalized();
    const CutSearch found = find_cut(rows, {one.p * mm, n, one.deviation_um * um});
    if (found.places.empty()) throw std::logic_error("a point was not cut");
    for (const CutPlace& place : found.places) cuts.push_back({place, n, one.deviation_um * um});
  }
  return part_deviations(rows, cuts);
}

// @param um_  wanted
void expect_at(const PartDeviations& part, std::size_t row, const Vector3d& um_) {
  EXPECT_LT((part.tip.at(row) - um_ * um).norm(), kTol)
      << row << ": " << part.tip[row].transpose() / um;
}

TEST(PartDeviations, AreLinearBetweenPointsAndConstantBeyond) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  const PartDeviations part =
      deviations(rows, {{{60, 0, -5}, {0, -1, 0}, 20.0}, {{20, 0, -5}, {0, -1, 0}, 10.0}});
  expect_at(part, 0, {0, -10, 0});
  expect_at(part, 20, {0, -10, 0});
  expect_at(part, 30, {0, -12.5, 0});
  expect_at(part, 60, {0, -20, 0});
  expect_at(part, 100, {0, -20, 0});
  EXPECT_TRUE(part.unprobed.empty());
}

TEST(PartDeviations, OfSeveralPointsAtOnePlaceAreTheirMean) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  const PartDeviations part = deviations(rows, {{{60, 0, -5}, {0, -1, 0}, 20.0},
                                                {{60, 0, -2}, {0, -1, 0}, 5.0},
                                                {{60, 0, 3}, {0, -1, 0}, 2.0}});
  expect_at(part, 10, {0, -9, 0});
}

// Along the first wall -Y, along the second +X, between the points of one and the other.
TEST(PartDeviations, TurnWithThePathAroundACorner) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(54, -4, -10).to(54, 50, -10).rows;
  const PartDeviations part =
      deviations(rows, {{{34, 0, -5}, {0, -1, 0}, 10.0}, {{50, 16, -5}, {1, 0, 0}, 30.0}});
  expect_at(part, 34, {0, -10, 0});
  expect_at(part, 44, {0, -15, 0});  // a quarter of the way of 40 mm
  expect_at(part, 64, {25, 0, 0});
  expect_at(part, 100, {30, 0, 0});
}

// Rows 54 and 55 are the last on the first leg and the first on the second: the step between them
// cuts the corner, and is the direction of neither.
TEST(PartDeviations, AreThoseOfTheLegUpToTheCorner) {
  const auto rows =
      ToolPath(kMill).from(0, -4, -10).to(53.6, -4, -10).to(54, -3.6, -10).to(54, 50, -10).rows;
  const PartDeviations part =
      deviations(rows, {{{34, 0, -5}, {0, -1, 0}, 10.0}, {{50, 16, -5}, {1, 0, 0}, 10.0}});
  expect_at(part, 54, {0, -10, 0});
  expect_at(part, 55, {10, 0, 0});
}

TEST(PartDeviations, OfABossAndABoreAreRadial) {
  for (const double side : {1.0, -1.0}) {  // of the normal: outwards, inwards
    const double path = side > 0.0 ? 24.0 : 6.0, wall = side > 0.0 ? 20.0 : 10.0;
    const auto rows = ToolPath(kMill).circle(path, -10.0).rows;
    std::vector<Probed> points;
    for (int a = 10; a < 360; a += 20) {
      const Vector3d out(std::cos(a * deg), std::sin(a * deg), 0.0);
      points.push_back({wall * out, side * out, 8.0});
    }
    const PartDeviations part = deviations(rows, points);
    for (const std::size_t a : {20U, 90U, 133U, 350U}) {
      const double angle = static_cast<double>(a) * deg;
      expect_at(part, a, 8.0 * side * Vector3d(std::cos(angle), std::sin(angle), 0.0));
    }
  }
}

// A tool that is 6 um too small leaves 3 um on both walls of a slot; this one went 4 um beside the
// middle as well.
TEST(PartDeviations, OfASlotAreThoseOfItsMiddle) {
  const auto rows = ToolPath(kMill).from(0, 0, -10).to(100, 0, -10).rows;
  const PartDeviations part = deviations(rows, {{{20, 4, -5}, {0, -1, 0}, 3.0 - 4.0},
                                                {{50, 4, -5}, {0, -1, 0}, 3.0 - 4.0},
                                                {{20, -4, -5}, {0, 1, 0}, 3.0 + 4.0},
                                                {{60, -4, -5}, {0, 1, 0}, 3.0 + 4.0}});
  for (const std::size_t n : {0U, 20U, 35U, 90U}) expect_at(part, n, {0, 4, 0});
}

TEST(PartDeviations, OfWallAndFloorAddUp) {
  const auto rows = ToolPath(kMill).from(0, -4, -10).to(100, -4, -10).rows;
  const PartDeviations part =
      deviations(rows, {{{20, 0, -5}, {0, -1, 0}, 10.0}, {{40, -4, -10}, {0, 0, 1}, -6.0}});
  expect_at(part, 30, {0, -10, -6});
}

// Into the floor straight down: the tool arrives with the offset that it needs along it.
TEST(PartDeviations, AreTakenAlongIntoAPlunge) {
  const auto rows = ToolPath(kMill).from(0, -4, 0).to(0, -4, -10).to(100, -4, -10).rows;
  const PartDeviations part =
      deviations(rows, {{{20, 0, -5}, {0, -1, 0}, 10.0}, {{40, -4, -10}, {0, 0, 1}, -6.0}});
  expect_at(part, 3, {0, -10, -6});
}

TEST(PartDeviations, OfASlopeLieAlongItsNormal) {
  const plant::Cutter ball = cutter(5.0, 5.0);
  const Vector3d n = Vector3d(0, -1, 1).normalized(), tip = 5.0 * n - Vector3d(0, 0, 5);
  const auto rows = ToolPath(ball).from(0, tip.y(), tip.z()).to(50, tip.y(), tip.z()).rows;
  const PartDeviations part = deviations(rows, {{{10, 0, 0}, n, 10.0}, {{30, 0, 0}, n, 20.0}});
  expect_at(part, 15, 12.5 * n);
  expect_at(part, 45, 20.0 * n);
}

// There and back along one face: the path sees it on its left, then on its right.
TEST(PartDeviations, StayOnTheirFaceWhereThePathComesBack) {
  const plant::Cutter ball = cutter(5.0, 5.0);
  const Vector3d n = Vector3d(0, -3, 1).normalized(), up = Vector3d(0, 1, 3).normalized();
  const auto tip = [&](double along) { return Vector3d(5.0 * n + along * up - Vector3d(0, 0, 5)); };
  const Vector3d low = tip(0.0), high = tip(1.0);
  const auto rows = ToolPath(ball)
                        .from(0, low.y(), low.z())
                        .to(50, low.y(), low.z())
                        .to(50, high.y(), high.z())
                        .to(0, high.y(), high.z())
                        .rows;
  const PartDeviations part = deviations(rows, {{{10, 0, 0}, n, 10.0},
                                                {{40, 0, 0}, n, 10.0},
                                                {Vector3d(40, 0, 0) + up, n, 10.0},
                                                {Vector3d(10, 0, 0) + up, n, 10.0}});
  for (const std::size_t row : {0U, 25U, 45U, 56U, 80U, 101U}) expect_at(part, row, 10.0 * n);
  const auto wall = ToolPath(kMill).from(0, -4, -5).to(50, -4, -5).to(50, -4, -10).to(0, -4, -10);
  const PartDeviations both =
      deviations(wall.rows, {{{10, 0, 20}, {0, -1, 0}, 10.0}, {{40, 0, -8}, {0, -1, 0}, 10.0}});
  for (const std::size_t row : {0U, 25U, 45U, 53U, 80U, 105U}) expect_at(both, row, {0, -10, 0});
}

// Two walls with a rapid way of 10 mm between them, then one without points.
TEST(PartDeviations, GoFromRunToRunInRapidMoves) {
  const auto rows = ToolPath(kMill)
                        .from(0, -4, -10)
                        .to(50, -4, -10)
                        .rapid(50, -14, -10)
                        .to(0, -14, -10)
                        .rapid(0, -24, -10)
                        .to(50, -24, -10)
                        .rows;
  const PartDeviations part =
      deviations(rows, {{{20, 0, -5}, {0, -1, 0}, 10.0}, {{20, -18, -5}, {0, 1, 0}, 5.0}});
  expect_at(part, 50, {0, -10, 0});
  // rows 51 to 60 are rapid, 61 is the first of the run behind
  expect_at(part, 51, {0, -10.0 + 15.0 / 11.0, 0});
  expect_at(part, 61, {0, 5, 0});
  expect_at(part, 150, {0, 0, 0});
  ASSERT_EQ(part.unprobed.size(), 1U);
  EXPECT_EQ(part.unprobed[0].first_line, 5);
  EXPECT_EQ(part.unprobed[0].last_line, 5);
}

}  // namespace
}  // namespace servomill::sim::preparation::part_deviations_test
