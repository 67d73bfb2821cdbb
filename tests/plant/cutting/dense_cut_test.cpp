/// The machined surface against a dense cut that shares nothing with it: the body of the cutter is
/// a function of a point, and for each point the place on each step that takes most of it is
/// searched.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <vector>

#include "plant/cutting/machined_surface.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::dense_cut_test {
namespace {

using Eigen::Vector3d;

constexpr double kAgreement = 5 * nm;  // 1 where the axis turns, 1 of the end, over the cosine

// How far x is outside of the body; negative inside, convex.
double outside(const Cutter& cutter, const CutterPosition& at, const Vector3d& x) {
  const Vector3d y = x - at.tip;
  const double h = y.dot(at.axis), rho = (y - h * at.axis).norm(), r = cutter.corner_radius;
  const double over = h - cutter.length;
  if (cutter.is_flat()) return std::max({rho - cutter.radius, -h, over});
  const double excess = std::max(rho - (cutter.radius - r), 0.0);
  return std::max(std::hypot(excess, std::min(h - r, 0.0)) - r, over);
}

CutterPosition on_the_way(const CutterPosition& a, const CutterPosition& b, double share) {
  return {a.tip + share * (b.tip - a.tip), (a.axis + share * (b.axis - a.axis)).normalized()};
}

template <class Function>
double least(const Function& f, double a, double b, int iterations) {
  constexpr double kGolden = 0.6180339887498949;
  double c = b - kGolden * (b - a), d = a + kGolden * (b - a), f_c = f(c), f_d = f(d);
  for (int i = 0; i < iterations; ++i) {
    if (f_c < f_d) {
      b = d, d = c, f_d = f_c, c = b - kGolden * (b - a), f_c = f(c);
    } else {
      a = c, c = d, f_c = f_d, d = a + kGolden * (b - a), f_d = f(d);
    }
  }
  return 0.5 * (a + b);
}

// How far x is outside of what the pass sweeps; negative inside.
double outside(const CutterPass& pass, const Vector3d& x) {
  double nearest = HUGE_VAL;
  for (std::size_t i = 1; i < pass.positions.size(); ++i) {
    const CutterPosition &a = pass.positions[i - 1], &b = pass.positions[i];
    const auto f = [&](double t) { return outside(pass.cutter, on_the_way(a, b, t), x); };
    // no body moves farther than its tip and its top
    const double way = (b.tip - a.tip).norm() + 2 * pass.cutter.length * (b.axis - a.axis).norm();
    if (f(0.5) > way) continue;
    nearest = std::min({nearest, f(0.0), f(1.0), f(least(f, 0.0, 1.0, 60))});
  }
  return nearest;
}

struct Cut {
  const char* name;
  Cutter cutter;
  double turn;  // rad a step
};

const Cut kCuts[] = {
    {"flat", {.radius = 4e-3, .length = 12e-3}, 0.0},
    {"flat_turning", {.radius = 4e-3, .length = 12e-3}, 2e-3},
    {"ball", {.radius = 4e-3, .corner_radius = 4e-3, .length = 12e-3}, 0.0},
    {"ball_turning", {.radius = 4e-3, .corner_radius = 4e-3, .length = 12e-3}, 2e-3},
    {"bull_nose", {.radius = 4e-3, .corner_radius = 1e-3, .length = 12e-3}, 0.0},
    {"bull_nose_turning", {.radius = 4e-3, .corner_radius = 1e-3, .length = 12e-3}, 2e-3},
    {"short_bull_nose", {.radius = 4e-3, .corner_radius = 3e-3, .length = 4e-3}, 2e-3},
};

// Back and forth, up and down, 0.1 mm a step.
CutterPass winding_pass(const Cut& cut) {
  CutterPass pass{cut.cutter, {}};
  for (int i = 0; i < 140; ++i) {
    const double tilt = 0.3 * std::sin(cut.turn * i), around = 0.7 * cut.turn * i;
    pass.positions.push_back(
        {{4e-3 * std::sin(0.04 * i), 2e-3 * std::cos(0.017 * i), 0.6e-3 * std::cos(0.06 * i)},
         {std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt)}});
  }
  return pass;
}

class DenseCut : public testing::TestWithParam<Cut> {};

TEST_P(DenseCut, leaves_the_same_surface) {
  constexpr int kTargets = 80, kParts = 10;
  constexpr double kClearance = 1e-3, kDepth = 4e-3;
  const CutterPass pass = winding_pass(GetParam());
  const MachinedSurface surface({pass});
  boost::random::mt19937_64 engine(11);
  const auto random = [&](double from, double to) {
    return boost::random::uniform_real_distribution<double>(from, to)(engine);
  };
  int met = 0;
  for (int i = 0; i < kTargets; ++i) {
    const Vector3d point(random(-6e-3, 6e-3), random(-5e-3, 5e-3), random(-0.5e-3, 2e-3));
    // bottoms, and now and then flanks
    const double steep = i % 3 == 0 ? 3.0 : 0.5;
    const Vector3d normal =
        Vector3d(random(-steep, steep), random(-steep, steep), 1.0).normalized();
    const Meeting meeting = surface.meet({point, normal}, kClearance, kDepth);
    SCOPED_TRACE(testing::Message() << "target " << i << " at " << point.transpose() << ", normal "
                                    << normal.transpose());
    const auto outside_at = [&](double distance) {
      return outside(pass, point + distance * normal);
    };
    switch (meeting.kind) {
      case Meeting::Kind::untouched:
      case Meeting::Kind::blocked:
        EXPECT_GT(outside_at(kClearance), 0.0);
        break;
      case Meeting::Kind::met:
        ++met;
        EXPECT_GT(outside_at(meeting.distance - kAgreement), 0.0);
        EXPECT_LE(outside_at(meeting.distance + kAgreement), 0.0);
        break;
      case Meeting::Kind::through:
        EXPECT_LE(outside_at(-kDepth), 0.0);
        break;
    }
    const bool inside =
        meeting.kind == Meeting::Kind::met || meeting.kind == Meeting::Kind::through;
    const double end = meeting.kind == Meeting::Kind::met ? meeting.distance : -kDepth;
    for (int part = 0; inside && part < kParts; ++part) {
      EXPECT_LE(outside_at(end + (kClearance - end) * (part + 0.5) / kParts), 0.0);
    }
  }
  EXPECT_GT(met, kTargets / 3);
}

INSTANTIATE_TEST_SUITE_P(all, DenseCut, testing::ValuesIn(kCuts),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace servomill::plant::dense_cut_test
