/// Normals and deviations between the points of one face.
#include "sim/preparation/probed_face.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "plant/vocabulary/units.h"

namespace servomill::sim::preparation::probed_face_test {
namespace {

using Eigen::Vector3d;

constexpr double kTol = 1e-12;
const Vector3d kAxis = Vector3d::UnitZ();

PathFrame along(const Vector3d& t) {
  const Vector3d l = kAxis.cross(t).normalized();
  return {t.normalized(), l, t.normalized().cross(l)};
}

FacePoint wall(double s_mm, double deviation_um, const Vector3d& normal, const Vector3d& t) {
  return face_point(CutBy::flank, s_mm * mm, deviation_um * um, normal, along(t));
}

void expect_at(const ProbedFace& face, double s_mm, const Vector3d& t, const Vector3d& normal,
               double deviation_um) {
  const ProbedFace::At at = face.at(s_mm * mm, along(t), kAxis);
  EXPECT_LT((at.normal - normal).norm(), kTol) << at.normal.transpose();
  EXPECT_NEAR(at.deviation, deviation_um * um, kTol);
}

TEST(ProbedFace, TurnsWithAPathThatFollowsIt) {
  ProbedFace face(CutBy::flank);
  face.add(wall(10, 4.0, {0, -1, 0}, {1, 0, 0}));
  const FacePoint behind_corner = wall(30, 8.0, {1, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(face.likeness(behind_corner), 1.0, kTol);
  face.add(behind_corner);
  expect_at(face, 15, {1, 0, 0}, {0, -1, 0}, 5.0);
  expect_at(face, 25, {0, 1, 0}, {1, 0, 0}, 7.0);
}

TEST(ProbedFace, StaysWithThePartWhereThePathComesBack) {
  ProbedFace face(CutBy::flank);
  face.add(wall(10, 4.0, {0, -1, 0}, {1, 0, 0}));
  const FacePoint on_the_way_back = wall(30, 8.0, {0, -1, 0}, {-1, 0, 0});
  EXPECT_NEAR(face.likeness(on_the_way_back), 1.0, kTol);
  face.add(on_the_way_back);
  for (const double x : {1.0, -1.0}) expect_at(face, 20, {x, 0, 0}, {0, -1, 0}, 6.0);
  expect_at(face, 20, {0, 1, 0}, {0, -1, 0}, 6.0);  // from one pass to the other
}

// Ways to the face and from it go on as at its ends, whatever their direction.
TEST(ProbedFace, IsConstantBeyondItsPoints) {
  ProbedFace face(CutBy::flank);
  face.add(wall(10, 4.0, {0, -1, 0}, {1, 0, 0}));
  face.add(wall(30, 8.0, {1, 0, 0}, {0, 1, 0}));
  expect_at(face, 0, {0, 1, 0}, {0, -1, 0}, 4.0);
  expect_at(face, 50, {1, 0, 0}, {1, 0, 0}, 8.0);
}

TEST(ProbedFace, IsUnlikeTheOtherWallOfASlot) {
  ProbedFace face(CutBy::flank);
  EXPECT_EQ(face.likeness(wall(10, 4.0, {0, -1, 0}, {1, 0, 0})), 1.0) << "the first point";
  face.add(wall(10, 4.0, {0, -1, 0}, {1, 0, 0}));
  EXPECT_NEAR(face.likeness(wall(11, 4.0, {0, 1, 0}, {1, 0, 0})), -1.0, kTol);
}

TEST(ProbedFace, OfTheTipLiesAlongTheToolAxis) {
  ProbedFace face(CutBy::tip);
  face.add(face_point(CutBy::tip, 10 * mm, 4 * um, kAxis, along({1, 0, 0})));
  face.add(face_point(CutBy::tip, 30 * mm, 8 * um, kAxis, along({1, 0, 0})));
  expect_at(face, 20, {0, 1, 0}, kAxis, 6.0);
}

// A slope of 45 deg, then one of 30 deg around a corner of the path.
TEST(ProbedFace, OfACornerTurnsAcrossThePathAsWell) {
  ProbedFace face(CutBy::corner);
  const auto slope = [](const Vector3d& across, double angle) {
    return Vector3d(std::cos(angle) * across + std::sin(angle) * kAxis);
  };
  face.add(
      face_point(CutBy::corner, 10 * mm, 4 * um, slope({0, -1, 0}, 45 * deg), along({1, 0, 0})));
  face.add(
      face_point(CutBy::corner, 30 * mm, 4 * um, slope({1, 0, 0}, 30 * deg), along({0, 1, 0})));
  expect_at(face, 20, {0, 1, 0}, slope({1, 0, 0}, 37.5 * deg), 4.0);
}

}  // namespace
}  // namespace servomill::sim::preparation::probed_face_test
