#include "plant/cutting/removed_volume.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>

namespace servomill::plant::removed_volume_test {
namespace {

using Eigen::Vector3d;

constexpr Cutter kFlat{.radius = 4e-3, .length = 20e-3};
constexpr Cutter kBall{.radius = 4e-3, .corner_radius = 4e-3, .length = 20e-3};
constexpr Cutter kBullNose{.radius = 4e-3, .corner_radius = 1e-3, .length = 20e-3};
constexpr Cutter kShortBullNose{.radius = 4e-3, .corner_radius = 3e-3, .length = 4e-3};
constexpr Cutter kShortBall{.radius = 4e-3, .corner_radius = 4e-3, .length = 5e-3};

class Random {
 public:
  double operator()(double from, double to) {
    return boost::random::uniform_real_distribution<double>(from, to)(engine_);
  }
  Vector3d in_box(const Vector3d& from, const Vector3d& to) {
    return {(*this)(from[0], to[0]), (*this)(from[1], to[1]), (*this)(from[2], to[2])};
  }

 private:
  boost::random::mt19937_64 engine_{7};
};

// From the definition of the body. Nearer to its envelope than this: neither (m).
enum class Where { inside, outside, near };
Where where(const Cutter& cutter, const CutterPosition& at, const Vector3d& x, double near) {
  const Vector3d y = x - at.tip;
  const double h = y.dot(at.axis), rho = (y - h * at.axis).norm();
  const double over = std::max(-h, h - cutter.length);
  if (over > near) return Where::outside;
  const double excess = rho - cutter.radius_at(std::clamp(h, 0.0, cutter.length));
  // on the flank of a round corner a small way across is a long one along the axis: allow for both
  const double below = rho - cutter.radius_at(std::clamp(h - near, 0.0, cutter.length));
  const double above = rho - cutter.radius_at(std::clamp(h + near, 0.0, cutter.length));
  if (std::min({excess, below, above}) > near) return Where::outside;
  if (over < -near && std::max({excess, below, above}) < -near) return Where::inside;
  return Where::near;
}

// Position by position on a path that is subdivided finely: an axis between, normalised anew.
CutterPosition between(const CutterPosition& a, const CutterPosition& b, double share) {
  return {a.tip + share * (b.tip - a.tip), (a.axis + share * (b.axis - a.axis)).normalized()};
}

Where stamped(const CutterPass& pass, std::size_t n, const Vector3d& x, int parts, double near) {
  Where found = Where::outside;
  for (std::size_t i = 0; i < n; ++i) {
    const CutterPosition& a = pass.positions[i == 0 ? 0 : i - 1];
    for (int part = 1; part <= parts; ++part) {
      const Where w =
          where(pass.cutter, between(a, pass.positions[i], 1.0 * part / parts), x, near);
      if (w == Where::inside) return w;
      if (w == Where::near) found = w;
    }
  }
  return found;
}

// A winding path of short steps, its axis turning by so much a step.
CutterPass winding_pass(const Cutter& cutter, std::size_t n, double step, double turn) {
  CutterPass pass{cutter, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const double u = static_cast<double>(i);
    const double s = step * u, tilt = 0.4 * std::sin(turn * u), around = 0.7 * turn * u;
    pass.positions.push_back(
        {{s, 3e-3 * std::sin(200.0 * s), 1e-3 * std::cos(150.0 * s)},
         {std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt)}});
  }
  return pass;
}

class EveryCutter : public testing::TestWithParam<Cutter> {};

void expect_as_stamped(const CutterPass& pass, double near) {
  constexpr int kParts = 8, kPoints = 1500;
  const RemovedVolume removed({pass});
  ASSERT_EQ(removed.position_count(), pass.positions.size());
  const double end = pass.positions.back().tip.x();
  Random random;
  int seen[3] = {};
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d x = random.in_box({-5e-3, -8e-3, -3e-3}, {end + 5e-3, 8e-3, 8e-3});
    const auto n =
        static_cast<std::size_t>(random(0.0, 0.999 + static_cast<double>(pass.positions.size())));
    const Where w = stamped(pass, n, x, kParts, near);
    ++seen[static_cast<int>(w)];
    if (w == Where::near) continue;
    EXPECT_EQ(removed.contains(x, n), w == Where::inside) << x.transpose() << ", n " << n;
  }
  EXPECT_GT(seen[0], kPoints / 20);
  EXPECT_GT(seen[1], kPoints / 20);
  EXPECT_LT(seen[2], kPoints / 10);
}

TEST_P(EveryCutter, removes_what_its_body_has_been_through) {
  // a step of 0.1 mm in eight parts leaves 12.5 um/2 between stamps, across a curved envelope less
  expect_as_stamped(winding_pass(GetParam(), 150, 0.1e-3, 0.0), 7e-6);
}

TEST_P(EveryCutter, removes_what_its_body_has_been_through_with_a_turning_axis) {
  expect_as_stamped(winding_pass(GetParam(), 150, 0.1e-3, 5e-3), 15e-6);
}

TEST_P(EveryCutter, turns_by_large_angles_in_one_step) {
  const Cutter& cutter = GetParam();
  const CutterPass pass{cutter, {{{0, 0, 0}, {0, 0, 1}}, {{1e-3, 0, 0}, {0.6, 0, 0.8}}}};
  // the direction turns evenly, not its chord: compare along the finely divided arc
  CutterPass arc{cutter, {}};
  const double angle = std::acos(0.8);
  for (int i = 0; i <= 2000; ++i) {
    const double u = i / 2000.0;
    arc.positions.push_back({{1e-3 * u, 0, 0}, {std::sin(u * angle), 0, std::cos(u * angle)}});
  }
  const RemovedVolume removed({pass});
  Random random;
  int inside = 0, outside = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3d x = random.in_box({-6e-3, -6e-3, -5e-3}, {10e-3, 6e-3, 10e-3});
    const Where w = stamped(arc, arc.positions.size(), x, 1, 7e-6);
    if (w == Where::near) continue;
    ++(w == Where::inside ? inside : outside);
    EXPECT_EQ(removed.contains(x), w == Where::inside) << x.transpose();
  }
  EXPECT_GT(inside, 25);
  EXPECT_GT(outside, 50);
}

constexpr const char* kNames[] = {"flat", "ball", "bull_nose", "short_bull_nose", "short_ball"};
INSTANTIATE_TEST_SUITE_P(all, EveryCutter,
                         testing::Values(kFlat, kBall, kBullNose, kShortBullNose, kShortBall),
                         [](const auto& one) { return kNames[one.index]; });

TEST(RemovedVolume, is_empty_before_the_first_position_and_without_passes) {
  const RemovedVolume removed({{kFlat, {{{0, 0, 0}, {0, 0, 1}}}}});
  EXPECT_FALSE(removed.contains({0, 0, 1e-3}, 0));
  EXPECT_TRUE(removed.contains({0, 0, 1e-3}, 1));
  EXPECT_TRUE(removed.contains({0, 0, 1e-3}));
  EXPECT_FALSE(RemovedVolume({}).contains({0, 0, 1e-3}));
  EXPECT_FALSE(RemovedVolume({{kFlat, {}}}).contains({0, 0, 1e-3}));
}

TEST(RemovedVolume, counts_positions_on_through_passes_and_leaves_what_lies_between_them) {
  const RemovedVolume removed({{kFlat, {{{0, 0, 0}, {0, 0, 1}}, {{10e-3, 0, 0}, {0, 0, 1}}}},
                               {kBall, {}},
                               {kFlat, {{{100e-3, 0, 0}, {0, 0, 1}}}}});
  EXPECT_EQ(removed.position_count(), 3);
  EXPECT_FALSE(removed.contains({13.9e-3, 0, 1e-3}, 1));
  EXPECT_TRUE(removed.contains({13.9e-3, 0, 1e-3}, 2));
  EXPECT_FALSE(removed.contains({100e-3, 0, 1e-3}, 2));
  EXPECT_TRUE(removed.contains({100e-3, 0, 1e-3}, 3));
  EXPECT_FALSE(removed.contains({50e-3, 0, 1e-3}));
}

TEST(RemovedVolume, ends_at_the_flutes) {
  const RemovedVolume removed({{kBall, {{{0, 0, 0}, {0, 0, 1}}, {{10e-3, 0, 0}, {0, 0, 1}}}}});
  EXPECT_TRUE(removed.contains({5e-3, 3.9e-3, 19.9e-3}));
  EXPECT_FALSE(removed.contains({5e-3, 0.0, 20.1e-3}));
  EXPECT_FALSE(removed.contains({5e-3, 3.9e-3, 1e-3}));
  EXPECT_FALSE(removed.contains({5e-3, 0.0, -1e-9}));
  EXPECT_TRUE(removed.contains({5e-3, 0.0, 1e-9}));
}

}  // namespace
}  // namespace servomill::plant::removed_volume_test
