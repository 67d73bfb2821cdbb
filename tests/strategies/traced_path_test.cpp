// Nearest places on the path of a commanded point.
#include "strategies/traced_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::strategies::traced_path_test {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 50 * mm, kChord = 5 * um;
constexpr double kSagitta = kChord * kChord / (8.0 * kRadius);

Vector3d on_circle(double angle) {
  return {kRadius * std::cos(angle), kRadius * std::sin(angle), 0.0};
}

TEST(TracedPath, FindsTheFootOnACircle) {
  TracedPath path(1000);
  path.start(on_circle(0.0));
  const double step = kChord / kRadius;
  for (int n = 1; n < 5000; ++n) {
    path.add(on_circle(n * step));
    const double behind = n * step - 0.3 * mm / kRadius;
    if (behind < 0.0) continue;
    const Vector3d a = on_circle(behind) * (1.0 - 2 * um / kRadius);  // 2 um inside
    const TracedPath::Place place = path.nearest(a);
    EXPECT_NEAR((place.point - a).norm(), 2 * um, 1.01 * kSagitta);
    EXPECT_GT(place.tangent.dot(Vector3d(-std::sin(behind), std::cos(behind), 0.0)), 1.0 - 1e-6);
  }
}

// The tip cuts a corner: nearest is the first leg, then the second.
TEST(TracedPath, GoesRoundASharpCorner) {
  TracedPath path(500);
  path.start(Vector3d::Zero());
  for (int n = 1; n <= 100; ++n) path.add(Vector3d(n * 10 * um, 0.0, 0.0));
  for (int n = 1; n <= 100; ++n) path.add(Vector3d(1 * mm, n * 10 * um, 0.0));
  EXPECT_LE((path.nearest({0.5 * mm, 0.1 * mm, 0.0}).point - Vector3d(0.5 * mm, 0, 0)).norm(),
            1e-12);
  EXPECT_LE((path.nearest({0.9 * mm, 0.05 * mm, 0.0}).point - Vector3d(0.9 * mm, 0, 0)).norm(),
            1e-12);
  EXPECT_LE((path.nearest({0.95 * mm, 0.2 * mm, 0.0}).point - Vector3d(1 * mm, 0.2 * mm, 0)).norm(),
            1e-12);
  // outside of the corner it is the corner itself
  EXPECT_LE((path.nearest({1.02 * mm, -0.03 * mm, 0.0}).point - Vector3d(1 * mm, 0, 0)).norm(),
            1e-12);
}

TEST(TracedPath, GoesOnStraightBeyondItsEnds) {
  TracedPath path(10);
  path.start(Vector3d::Zero());
  EXPECT_FALSE(path.has_moved());
  path.add(Vector3d(TracedPath::kShortest / 2.0, 0.0, 0.0));
  EXPECT_FALSE(path.has_moved()) << "stands";
  path.add(Vector3d(1 * mm, 0.0, 0.0));
  ASSERT_TRUE(path.has_moved());
  EXPECT_LE((path.nearest({1.5 * mm, 1 * um, 0.0}).point - Vector3d(1.5 * mm, 0, 0)).norm(), 1e-15);
  EXPECT_LE((path.nearest({-0.5 * mm, 1 * um, 0.0}).point - Vector3d(-0.5 * mm, 0, 0)).norm(),
            1e-15);
}

// Points older than its length are forgotten: a returning path is not mistaken for the first one.
TEST(TracedPath, ForgetsWhatIsOlderThanItsLength) {
  TracedPath path(4);
  path.start(Vector3d::Zero());
  for (int n = 1; n <= 10; ++n) path.add(Vector3d(n * mm, 0.0, 0.0));
  const TracedPath::Place place = path.nearest({2 * mm, 3 * um, 0.0});  // before the oldest, X7
  EXPECT_LE((place.point - Vector3d(2 * mm, 0, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace servomill::strategies::traced_path_test
