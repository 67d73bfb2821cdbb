/// Splines are followed as curves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/spline_curve.h"
#include "programs.h"
#include "tests/plant/vocabulary/cox_de_boor.h"

namespace servomill::controllers::test::spline_path_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Curve {
  std::string name;
  int order = 4;
  std::vector<Vector2d> points;  // m, behind the origin, where it begins
  std::vector<double> weights;
};

std::vector<Curve> curves() {
  const double q = std::sqrt(0.5);
  return {
      {"arch", 4, {{0.02, 0.04}, {0.04, 0.04}, {0.06, 0.0}}, {}},
      {"S", 4, {{0.03, 0.0}, {0.01, 0.03}, {0.04, 0.03}}, {}},
      {"parabola", 3, {{0.02, 0.03}, {0.05, 0.01}}, {}},
      {"quarter circle", 3, {{0.01, 0.0}, {0.01, 0.01}}, {1.0, q, 1.0}},
      {"wave",
       4,
       {{0.005, 0.01}, {0.015, -0.01}, {0.025, 0.01}, {0.035, -0.01}, {0.045, 0.01}, {0.05, 0.0}},
       {}},
      {"weighted", 4, {{0.01, 0.02}, {0.02, -0.01}, {0.04, 0.02}, {0.05, 0.0}}, {1, 3, 1, 2, 1}},
      {"of order 5",
       5,
       {{0.01, 0.01}, {0.02, 0.03}, {0.03, -0.01}, {0.05, 0.0}, {0.06, 0.02}},
       {1, 1, 2, 1, 0.5, 1}},
  };
}

Program program_of(const Curve& curve, double feed) {
  Program program;
  program.spline(curve.order, curve.points, feed, curve.weights);
  return program;
}

CoxDeBoor reference_of(const Curve& curve) {
  std::vector<Vector3d> points = {Vector3d::Zero()};
  for (const Vector2d& p : curve.points) points.emplace_back(p.x(), p.y(), 0.0);
  std::vector<double> weights = curve.weights;
  if (weights.empty()) weights.assign(points.size(), 1.0);
  return {curve.order, points, weights};
}

Vector3d place(const Trajectory::Sample& sample) { return sample.Q_ref.head<3>(); }

TEST(SplinePath, StaysOnTheCurveWithinNanometres) {
  constexpr double kInterpolation = 20e-9, kOfCircle = 0.1e-9;  // m

  for (const Curve& curve : curves()) {
    const Trajectory path = program_of(curve, 0.1).plan();
    const CoxDeBoor reference = reference_of(curve);
    Trajectory::Cursor cursor;
    double worst = 0.0;
    for (int n = 0; n <= 300; ++n) {
      const Vector3d p = place(path.at(path.duration() * n / 300, cursor));
      worst = std::max(worst, reference.distance(p, 500));
    }
    EXPECT_LT(worst, curve.name == "quarter circle" ? kOfCircle : kInterpolation) << curve.name;
  }
}

// Points on the curve so that no chord is farther from it than a micrometre.
Program chords_of(const Curve& curve, double feed) {
  const Program whole = program_of(curve, feed);
  const SplineCurve& exact = whole.moves()[0].spline->curve;
  Program program;
  double s = 0.0;
  while (s < exact.length()) {
    const double bend = exact.state(s).curvature.norm();
    double step = std::min(std::sqrt(8.0 * um / std::max(bend, 1.0)), exact.length() - s);
    const auto miss = [&](double h) {
      const Vector3d a = exact.point(s), b = exact.point(s + h), m = exact.point(s + 0.5 * h);
      return (m - 0.5 * (a + b)).norm();
    };
    while (miss(step) > um) step *= 0.95;
    if (exact.length() - s - step < 1e-6) step = exact.length() - s;
    s += step;
    const Vector3d p = exact.point(s);
    program.line(p.x(), p.y(), p.z(), feed);
  }
  return program;
}

TEST(SplinePath, IsNotSlowerThanItsChords) {
  // Chords may leave the curve by the tolerance, too: where the jerk limits the speed, they cut its
  // bends by all of that. A tolerance of as much as they miss it by anyway makes both alike.
  PathOptions narrow;
  narrow.tolerance = 1 * um;
  constexpr double kCutBends = 1.07;
  for (const double feed : {0.03, 0.1, 0.3}) {
    for (const Curve& curve : curves()) {
      const Program chords = chords_of(curve, feed), whole = program_of(curve, feed);
      EXPECT_LE(whole.plan(narrow).duration(), chords.plan(narrow).duration())
          << curve.name << " at " << feed;
      EXPECT_LE(whole.plan().duration(), kCutBends * chords.plan().duration())
          << curve.name << " at " << feed;
    }
  }
}

// Four quarters about (-r, 0), from the origin on.
Program circle_of_splines(double r, double feed) {
  const double q = std::sqrt(0.5);
  const std::vector<Vector2d> corners = {{0, r},       {-r, r},  {-2 * r, r}, {-2 * r, 0},
                                         {-2 * r, -r}, {-r, -r}, {0, -r},     {0, 0}};
  Program program;
  for (std::size_t i = 0; i < corners.size(); i += 2) {
    program.spline(3, {corners[i], corners[i + 1]}, feed, {1.0, q, 1.0});
  }
  return program;
}

template <class F>
void each_sample(const Trajectory& path, int count, F&& f) {
  Trajectory::Cursor cursor;
  for (int n = 0; n <= count; ++n) f(path.at(path.duration() * n / count, cursor));
}

TEST(SplinePath, ACircleIsThatOfG3) {
  constexpr double kRadius = 0.02, kFeed = 0.1;
  constexpr double kExact = 0.1e-9;     // m, also where its quarters meet
  constexpr double kEndOfArc = 0.4e-6;  // m, by which an arc leaves its circle next to a stop
  Program arc;
  arc.arc({-kRadius, 0, 0}, {0, 0, 0}, 2, 1, kFeed);
  const Trajectory of_splines = circle_of_splines(kRadius, kFeed).plan(), of_arc = arc.plan();
  const auto radial = [&](const Trajectory::Sample& x) {
    return std::abs((place(x) - Vector3d(-kRadius, 0, 0)).norm() - kRadius);
  };
  each_sample(of_splines, 1000, [&](const auto& x) { EXPECT_LT(radial(x), kExact) << x.s; });
  each_sample(of_arc, 1000, [&](const auto& x) { EXPECT_LT(radial(x), kEndOfArc) << x.s; });
  EXPECT_EQ(of_splines.chains(), 1U);
  EXPECT_NEAR(of_splines.duration(), of_arc.duration(), 0.005 * of_arc.duration());
  EXPECT_LE(of_splines.duration(), of_arc.duration());
}

TEST(SplinePath, GoesOnFromArcsAndToThemOnTheSameCircle) {
  constexpr double kRadius = 0.02, kFeed = 0.1;
  Program program;
  program.arc({-kRadius, 0, 0}, {-kRadius, kRadius, 0}, 2, 1, kFeed);
  program.spline(3, {{-2 * kRadius, kRadius}, {-2 * kRadius, 0.0}}, kFeed,
                 {1.0, std::sqrt(0.5), 1.0});
  program.arc({-kRadius, 0, 0}, {0, 0, 0}, 2, 1, kFeed);
  const Trajectory path = program.plan();
  EXPECT_EQ(path.chains(), 1U);
  each_sample(path, 1000, [&](const auto& x) {
    const double radial = std::abs((place(x) - Vector3d(-kRadius, 0, 0)).norm() - kRadius);
    EXPECT_LT(radial, x.s < 5e-3 || x.s > 0.12 ? 0.4e-6 : 0.2e-6) << x.s;
  });
}

TEST(SplinePath, IsJoinedToLinesWithoutAStop) {
  Program program;
  program.line(0.03, 0, 0, 0.1);
  program.spline(4, {{0.04, 0.0}, {0.06, 0.01}, {0.06, 0.02}}, 0.1);
  program.line(0.06, 0.05, 0, 0.1);
  const Trajectory path = program.plan();
  ASSERT_EQ(path.chains(), 1U);
  const SplineCurve& curve = program.moves()[1].spline->curve;
  double slowest = 1.0, worst = 0.0;
  each_sample(path, 2000, [&](const auto& x) {
    if (x.line != 2) return;
    slowest = std::min(slowest, x.dQ_ref.norm());
    worst = std::max(worst, (curve.point(curve.closest(place(x))) - place(x)).norm());
  });
  EXPECT_GT(slowest, 0.03);
  EXPECT_LT(worst, 10 * um);
}

TEST(SplinePath, SaysHowFarItHasCome) {
  for (const Curve& curve : curves()) {
    const Program program = program_of(curve, 0.1);
    const SplineCurve& exact = program.moves()[0].spline->curve;
    constexpr double kBetweenPoints = 0.2e-6;  // m
    each_sample(program.plan(), 200, [&](const auto& x) {
      EXPECT_LT((exact.point(x.s) - place(x)).norm(), kBetweenPoints) << curve.name << " " << x.s;
    });
  }
}

// Lines, arcs and splines of all orders, with cusps and corners, in all path modes.
Program random_splines(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  Program program;
  const double size = std::exp(uniform(std::log(0.2e-3), std::log(30e-3)));
  const auto beside = [&] {
    const Vector2d at = program.at().head<2>();
    return Vector2d(at.x() + uniform(-size, size), at.y() + uniform(-size, size));
  };
  const int count = 2 + static_cast<int>(random() % 8);
  for (int n = 0; n < count; ++n) {
    const double feed = std::exp(uniform(std::log(5e-3), std::log(0.3)));
    if (random() % 4 == 0) {
      program.path_mode = static_cast<PathMode>(random() % 3);
      program.path_tolerance = random() % 2 == 0 ? 0.0 : std::exp(uniform(-14.0, -9.0));
    }
    if (random() % 3 == 0) {
      const Vector2d to = beside();
      program.line(to.x(), to.y(), 0.0, feed);
      continue;
    }
    const int order = 3 + static_cast<int>(random() % 3);
    std::vector<Vector2d> points;
    std::vector<double> weights = {uniform(0.5, 2.0)};
    const std::size_t more = static_cast<std::size_t>(order) - 1 + random() % 4;
    for (std::size_t i = 0; i < more; ++i) {
      const bool is_double = random() % 8 == 0 && !points.empty();
      points.push_back(is_double ? points.back() : beside());
      weights.push_back(uniform(0.3, 3.0));
    }
    program.spline(order, points, feed, weights);
  }
  return program;
}

double tolerance_of(const Move& move, const PathOptions& options) {
  if (move.path_mode != PathMode::continuous) return options.exact_tolerance;
  return move.path_tolerance > 0.0 ? move.path_tolerance : options.tolerance;
}

// Distance to the path, of the tolerance: at a corner that is the larger one of both moves.
double excess(const Program& program, const Trajectory::Sample& x, const PathOptions& options) {
  const std::vector<Move>& moves = program.moves();
  double out = std::numeric_limits<double>::infinity();
  const std::size_t last = std::min(x.move + 1, moves.size() - 1);
  for (std::size_t i = x.move > 0 ? x.move - 1 : 0; i <= last; ++i) {
    const AxisWords from = i > 0 ? moves[i - 1].end_machine : kLayout.words(program.start());
    const MoveCurve curve(from, moves[i]);
    const double distance = (curve.at(curve.closest(place(x))).head<3>() - place(x)).norm();
    const double tolerance =
        std::max(tolerance_of(moves[i], options), tolerance_of(moves[x.move], options));
    out = std::min(out, distance / tolerance);
  }
  return out;
}

TEST(SplinePath, KeepsLimitsAndTolerance) {
  constexpr double kRounding = 1e-7;  // of a limit
  const PathOptions options;
  const JointLimits limits = machine_limits();
  for (unsigned seed = 0; seed < 150; ++seed) {
    const Program program = random_splines(seed);
    const Trajectory path = program.plan(options, limits);
    double v = 0.0, a = 0.0, j = 0.0, jump = 0.0, feed = 0.0, off = 0.0;
    Trajectory::Cursor cursor;
    const double dt = path.duration() / 4000.0;
    Joints ddQ = Joints::Zero();
    const auto most = [](const Joints& x, const Joints& limit) {
      return x.cwiseAbs().cwiseQuotient(limit).maxCoeff();
    };
    for (int n = 0; n <= 4000; ++n) {
      const Trajectory::Sample x = path.at(n * dt, cursor);
      const Move& move = program.moves()[x.move];
      v = std::max(v, most(x.dQ_ref, limits.v));
      a = std::max(a, most(x.ddQ_ref, limits.a));
      j = std::max(j, most(x.dddQ_ref, limits.j));
      if (n > 0) jump = std::max(jump, most(x.ddQ_ref - ddQ, limits.j) / dt);
      ddQ = x.ddQ_ref;
      feed = std::max(feed, x.dQ_ref.norm() / move.feed);
      if (n % 20 == 0) off = std::max(off, excess(program, x, options));
    }
    EXPECT_LE(std::max({v, a, j}), 1.0 + kRounding) << seed;
    EXPECT_LE(jump, 1.0 + 1e-3) << seed;
    EXPECT_LE(feed, 1.0 + kRounding) << seed;
    EXPECT_LE(off, 1.0 + 1e-3) << seed;
    EXPECT_EQ(path.end(), kLayout.joints(program.at())) << seed;
  }
}

}  // namespace
}  // namespace servomill::controllers::test::spline_path_test
