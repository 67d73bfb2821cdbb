/// Long motions: planned stretch by stretch.
#include "controllers/path/motion_stretches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "programs.h"

namespace servomill::controllers::test::motion_stretches_test {
namespace {

// Rows over a curved surface in chords of 0.05 to 0.2 mm at 50 mm/s.
Program surface(int lines, unsigned seed = 5) {
  std::mt19937 dice(seed);
  Program program;
  double x = 0.0, y = 0.0, direction = 1.0;
  for (int n = 0; n < lines; ++n) {
    const double chord = (0.05 + 0.15 * static_cast<double>(dice()) / 4294967296.0) * mm;
    if (std::abs(x + direction * chord - 0.01) > 0.01) {  // the row ends: nothing stops here
      direction = -direction;
      y += 0.3 * mm;
    } else {
      x += direction * chord;
    }
    program.line(x, y, 0.006 * std::sin(x / 0.031) * std::cos(y / 0.023), 50 * mm);
  }
  return program;
}

Trajectory planned(const Program& program, std::size_t stretch) {
  PathOptions options;
  options.stretch = stretch;
  return program.plan(options);
}

// At a seam the path is straight and the speed does not change, which costs some milliseconds.
TEST(LongMotion, LosesLittleWhereStretchesMeet) {
  constexpr double kLoss = 25 * ms;  // each; 9 to 17 measured
  const Program program = surface(12'000);
  const Trajectory whole = planned(program, 1'000'000);
  ASSERT_EQ(whole.chains(), 1U);
  for (const std::size_t stretch : {1000U, 4000U}) {
    const Trajectory divided = planned(program, stretch);
    const auto stretches = divided.chains();
    ASSERT_GE(stretches, 12'000 / stretch);
    EXPECT_LE(divided.duration(), whole.duration() + kLoss * static_cast<double>(stretches - 1));
  }
}

void expect_same_bits(const Trajectory::Chain& one, const Trajectory::Chain& other) {
  EXPECT_EQ(one.t, other.t);
  EXPECT_EQ(one.duration, other.duration);
  ASSERT_EQ(one.plan->law.phases.size(), other.plan->law.phases.size());
  for (std::size_t i = 0; i < one.plan->law.phases.size(); ++i) {
    EXPECT_EQ(one.plan->law.phases[i].t, other.plan->law.phases[i].t);
    EXPECT_EQ(one.plan->law.phases[i].v, other.plan->law.phases[i].v);
    EXPECT_EQ(one.plan->law.phases[i].beta, other.plan->law.phases[i].beta);
  }
  ASSERT_EQ(one.plan->path.pieces.size(), other.plan->path.pieces.size());
  for (std::size_t i = 0; i < one.plan->path.pieces.size(); ++i) {
    EXPECT_EQ(one.plan->path.pieces[i].c0, other.plan->path.pieces[i].c0);
    EXPECT_EQ(one.plan->path.pieces[i].c3, other.plan->path.pieces[i].c3);
  }
}

// The plan of a stretch is final once the next stretch is known.
TEST(LongMotion, AStretchDependsOnItsNeighboursAlone) {
  constexpr std::size_t kStretch = 1000;
  const Trajectory one = planned(surface(6000), kStretch);
  Program other = surface(4500);
  other.line(0.3, 0.2, 0.1, 5 * mm);
  const Trajectory changed = planned(other, kStretch);
  ASSERT_GE(one.chains(), 6U);
  for (std::size_t n = 0; n < 3; ++n) expect_same_bits(*one.chain(n), *changed.chain(n));
}

// A block whose middle is the seam goes on in the next stretch.
TEST(LongMotion, EveryBlockIsPassedOnceAndWhole) {
  const Program program = surface(5000);
  const Trajectory path = planned(program, 500);
  Trajectory::Cursor cursor;
  double s = 0.0;
  std::size_t move = 0;
  for (double t = 0.0; t < path.duration(); t += 1 * ms) {
    const auto now = path.at(t, cursor);
    EXPECT_GE(now.s, s);
    EXPECT_LE(now.s - s, 51e-6);
    EXPECT_GE(now.move, move);
    EXPECT_GE(now.s, program.moves()[now.move].s_begin);
    EXPECT_LE(now.s, program.moves()[now.move].s_end);
    s = now.s, move = now.move;
  }
  EXPECT_EQ(move, program.moves().size() - 1);
}

double end_speed(const Trajectory::Chain& chain) {
  return chain.plan->law.phases.back().at(chain.duration).v;
}

// A stretch that the look-ahead cannot continue ends at rest, by the law that was planned with it.
// Here the speed at the third seam is the highest from which the 10 mm after it suffice to stop,
// limited by jerk alone: (L^2 j)^(1/3) = 215 mm/s. That braking is at 141 mm/s 2.5 mm ahead of its
// end, within the feed of 145 mm/s there. With the path beyond, the speed is to settle at 145
// mm/s: 9.6 mm, of 7.5 mm.
TEST(LongMotion, AStretchThatCannotBeContinuedEndsAtRest) {
  Program program;
  for (int n = 1; n <= 160; ++n) {
    program.line(n * mm, 0.0, 0.0, n > 42 && n <= 48 ? 145 * mm : 600 * mm);
  }
  const Trajectory path = planned(program, 20);
  ASSERT_GE(path.chains(), 6U);
  EXPECT_NEAR(path.chain(3)->plan->path.length(), 10 * mm, 1e-9);
  EXPECT_NEAR(end_speed(*path.chain(2)), std::cbrt(1e-4 * 100.0), 1e-4);
  EXPECT_NEAR(end_speed(*path.chain(3)), 0.0, 1e-9);
  EXPECT_NEAR(path.chain(4)->plan->law.phases.front().v, 0.0, 1e-9);
  EXPECT_GT(end_speed(*path.chain(4)), 100 * mm);  // and the motion goes on
  Trajectory::Cursor cursor;
  double s = 0.0;
  for (double t = 0.0; t < path.duration(); t += 1 * ms) {
    const auto now = path.at(t, cursor);
    EXPECT_GE(now.s, s);
    EXPECT_LE(now.s - s, (now.move >= 42 && now.move < 48 ? 146e-6 : 601e-6));
    s = now.s;
  }
  EXPECT_NEAR(s, 160 * mm, 1 * mm);
}

// Nothing to be divided: a motion of splines alone stays whole.
TEST(LongMotion, SplinesStayWhole) {
  Program program;
  std::vector<Eigen::Vector2d> points;
  for (int n = 1; n < 60; ++n) points.emplace_back(0.002 * n, 0.004 * std::sin(0.9 * n));
  program.spline(4, points, 50 * mm);
  EXPECT_EQ(planned(program, 20).chains(), 1U);
}

}  // namespace
}  // namespace servomill::controllers::test::motion_stretches_test
