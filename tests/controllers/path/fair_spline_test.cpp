/// Splines through runs of short chords.
#include "controllers/path/fair_spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "plant/vocabulary/units.h"

namespace servomill::controllers::fair_spline_test {
namespace {

constexpr double kTolerance = 10 * um;
constexpr double kRounding = 1e-12;  // m, sums of 1 m
const Joints kJerk = Joints::Constant(50.0);

double linear_norm(const Joints& u) { return u.head<kLinearJoints>().norm(); }

PathVertex vertex(double x, double y, double z) {
  PathVertex v;
  v.u.head<3>() << x, y, z;
  v.tolerance_linear = v.tolerance_rotary = kTolerance;
  v.speed = 33 * mm;
  return v;
}

// The direction turns by some degrees from chord to chord, as in programs of measured surfaces.
std::vector<PathVertex> wandering(int count, unsigned seed) {
  std::mt19937 dice(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(dice()) / 4294967296.0);
  };
  std::vector<PathVertex> out = {vertex(0, 0, 0)};
  double azimuth = 0.0, x = 0.0, y = 0.0;
  for (int i = 0; i < count; ++i) {
    azimuth += uniform(-0.08, 0.08);
    const double step = uniform(0.025, 0.075) * mm;
    x += step * std::cos(azimuth), y += step * std::sin(azimuth);
    out.push_back(vertex(x, y, 0));
  }
  return out;
}

// Rows over a surface, with corners at both ends of the step to the next one.
std::vector<PathVertex> rows(int count, unsigned seed) {
  std::mt19937 dice(seed);
  const auto chord = [&] {
    return (0.05 + 0.15 * (static_cast<double>(dice()) / 4294967296.0)) * mm;
  };
  const auto at = [](double x, double y) {
    return vertex(x, y, 6 * mm * std::sin(x / (31 * mm)) * std::cos(y / (23 * mm)));
  };
  std::vector<PathVertex> out = {at(0, 0)};
  double x = 0.0;
  for (int row = 0; row < count; ++row) {
    const double y = row * 0.3 * mm, end = row % 2 == 0 ? 10 * mm : 0.0;
    if (row > 0) out.push_back(at(x, y));
    for (double step = chord(); std::abs(end - x) > step; step = chord()) {
      x += std::copysign(step, end - x);
      out.push_back(at(x, y));
    }
    out.push_back(at(x = end, y));
  }
  return out;
}

std::vector<PathVertex> circle(double R, double chord) {
  std::vector<PathVertex> out;
  for (double phi = 0.0; phi < 3.0; phi += chord / R) {
    out.push_back(vertex(R * std::cos(phi), R * std::sin(phi), 0));
  }
  return out;
}

// Largest distance to the polyline at equal s, on 20 points of each piece.
double largest_deviation(const SmoothPath& path, const std::vector<PathVertex>& v) {
  double largest = 0.0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < path.pieces.size(); ++i) {
    const CubicPiece& p = path.pieces[i];
    for (int n = 0; n <= 20; ++n) {
      const double x = (path.end_of(i) - p.s) * n / 20.0, s = p.s + x;
      while (k > 0 && path.s[k] > s) --k;
      while (k + 2 < path.s.size() && path.s[k + 1] <= s) ++k;
      const double f = (s - path.s[k]) / (path.s[k + 1] - path.s[k]);
      const Joints q = p.c0 + x * (p.c1 + x * (p.c2 / 2.0 + x * p.c3 / 6.0));
      largest = std::max(largest, linear_norm(q - v[k].u - f * (v[k + 1].u - v[k].u)));
    }
  }
  return largest;
}

TEST(FairSpline, KeepsTheToleranceOfEveryChord) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const auto v = wandering(2000, seed);
    const SmoothPath path = smooth(v, kJerk);
    EXPECT_LE(largest_deviation(path, v), kTolerance * (1 + 1e-9)) << seed;
    EXPECT_LT(path.pieces.size(), v.size() / 2) << "windows alone give two to three for each chord";
  }
}

void expect_continuous(const SmoothPath& path) {
  for (std::size_t i = 0; i + 1 < path.pieces.size(); ++i) {
    const CubicPiece &p = path.pieces[i], &next = path.pieces[i + 1];
    const double h = next.s - p.s;
    const Joints q = p.c0 + h * (p.c1 + h * (p.c2 / 2.0 + h * p.c3 / 6.0));
    ASSERT_LE((q - next.c0).norm(), kRounding);
    ASSERT_LE((p.c1 + h * (p.c2 + h * p.c3 / 2.0) - next.c1).norm(), 1e-9);
    ASSERT_LE((p.c2 + h * p.c3 - next.c2).norm(), 1e-6 * (1.0 + p.c3.norm() * h));
  }
}

TEST(FairSpline, ContinuesPlaceDirectionAndCurvature) {
  expect_continuous(smooth(wandering(3000, 7), kJerk));
}

// Some splines begin in the very vertex where the window of the corner before ends.
TEST(FairSpline, ContinuesThemBehindCorners) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(seed);
    expect_continuous(smooth(rows(30, seed), kJerk));
  }
}

TEST(FairSpline, BeginsAndEndsInTheVertices) {
  const auto v = wandering(1000, 3);
  const SmoothPath path = smooth(v, kJerk);
  EXPECT_LE((path.pieces.front().c0 - v.front().u).norm(), kRounding);
  const CubicPiece& p = path.pieces.back();
  const double h = path.length() - p.s;
  EXPECT_LE((p.c0 + h * (p.c1 + h * (p.c2 / 2 + h * p.c3 / 6)) - v.back().u).norm(), kRounding);
}

// The window misses a circle by w^2/12R, which it sets to the tolerance.
TEST(FairSpline, BendsASmoothCurveFarLessThanTheWindowDoes) {
  const auto v = circle(10 * mm, 0.05 * mm);
  const SmoothPath path = smooth(v, kJerk);
  for (std::size_t i = 0; i < path.pieces.size(); ++i) {
    const CubicPiece& p = path.pieces[i];
    if (p.s < 5 * mm || p.s > path.length() - 5 * mm) continue;  // where it leads in and out
    EXPECT_NEAR(linear_norm(p.c0), 10 * mm, 0.1 * kTolerance);
  }
}

TEST(FairSpline, RefusesARunThatIsTooShortForItsKnots) {
  const auto v = wandering(8, 1);
  std::vector<double> s = {0.0}, w(v.size(), 0.3 * mm);
  for (std::size_t i = 1; i < v.size(); ++i) s.push_back(s.back() + (v[i].u - v[i - 1].u).norm());
  const auto state = [&](std::size_t i, std::size_t chord) {
    const Joints d = (v[chord + 1].u - v[chord].u).normalized();
    return FairSpline::State{s[i], v[i].u, d, Joints::Zero(), chord};
  };
  FairSpline spline;
  EXPECT_FALSE(spline.fit(v, s, w, kJerk, state(0, 0), state(v.size() - 1, v.size() - 2)));
}

// std::max and friends pass over NaN.
TEST(FairSpline, RefusesWhatHasNoSolution) {
  const auto v = wandering(200, 1);
  std::vector<double> s = {0.0}, w(v.size(), 0.3 * mm);
  for (std::size_t i = 1; i < v.size(); ++i) s.push_back(s.back() + (v[i].u - v[i - 1].u).norm());
  const auto state = [&](std::size_t i, std::size_t chord, double bend) {
    const Joints d = (v[chord + 1].u - v[chord].u).normalized();
    return FairSpline::State{s[i], v[i].u, d, Joints::Constant(bend), chord};
  };
  const auto end = state(v.size() - 1, v.size() - 2, 0.0);
  FairSpline spline;
  EXPECT_TRUE(spline.fit(v, s, w, kJerk, state(0, 0, 0.0), end));
  EXPECT_FALSE(spline.fit(v, s, w, kJerk, state(0, 0, std::nan("")), end));
}

}  // namespace
}  // namespace servomill::controllers::fair_spline_test
