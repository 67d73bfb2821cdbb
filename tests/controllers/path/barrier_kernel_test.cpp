/// The derivatives that the search for a quicker time law goes by.
#include "controllers/path/barrier_kernel.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <vector>

namespace servomill::controllers::barrier_kernel_test {
namespace {

constexpr std::size_t kBlocks = 3, kCoefficients = 12;

struct Problem {
  std::vector<BarrierPoints> points;
  BarrierJoints joints;
  std::vector<double> c, step;
};

// Numbers of the size that paths have, every slack positive.
Problem problem() {
  std::mt19937 dice(4);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(dice()) / 4294967296.0);
  };
  Problem out;
  out.points.resize(kBlocks);
  out.joints = {3, {0.1, 0.05, 0.2, 0.0, 0.0}};
  for (BarrierPoints& p : out.points) {
    for (std::size_t n = 0; n < kLaneWidth; ++n) {
      for (auto& row : p.S) {
        for (auto& cell : row) cell[n] = uniform(-1.0, 1.0);
      }
      for (auto& cell : p.S[0]) cell[n] = uniform(0.1, 0.5);
      p.length[n] = uniform(0.5, 2.0);
      p.time[n] = uniform(0.5, 2.0);
      p.b_top[n] = uniform(4.0, 6.0);
      p.swell[n] = uniform(0.0, 0.1);
      for (std::size_t k = 0; k < out.joints.count; ++k) {
        p.j0[k][n] = uniform(-0.2, 0.2);
        p.j1[k][n] = uniform(-0.2, 0.2);
        p.j2[k][n] = uniform(-0.2, 0.2);
      }
      p.interval[n] = static_cast<std::uint32_t>(uniform(0.0, kCoefficients - 2.0));
    }
  }
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    out.c.push_back(uniform(0.8, 1.2));
    out.step.push_back(uniform(-0.1, 0.1));
  }
  return out;
}

BarrierKernel kernel_of(SimdLevel level) {
  return at_simd_level(level, []<SimdLevel chosen>() { return make_barrier_kernel<chosen>(); });
}

std::vector<BarrierTerms> terms_of(const BarrierKernel& kernel, const Problem& p,
                                   const std::vector<double>& c, double mu) {
  std::vector<BarrierTerms> terms(kBlocks);
  kernel.derive(p.points.data(), kBlocks, p.joints, c.data(), mu, terms.data());
  return terms;
}

// The cost of one point as the header has it, limits below `idle` left out as they were at c0.
double cost(const Problem& p, std::size_t block, std::size_t lane, const double* c,
            const double* c0, double mu) {
  const BarrierPoints& q = p.points[block];
  const auto state = [&](const double* from, std::size_t i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < 3; ++j) sum += q.S[i][j][lane] * from[j];
    return sum;
  };
  const double b = state(c, 0), r = 1.0 / std::sqrt(b), r0 = 1.0 / std::sqrt(state(c0, 0));
  double logs = std::log(q.b_top[lane] - b);
  constexpr double idle = 0.1;
  for (std::size_t k = 0; k < p.joints.count; ++k) {
    const double j0 = q.j0[k][lane], j1 = q.j1[k][lane], j2 = q.j2[k][lane];
    const auto L = [&](const double* at) {
      return j0 * state(at, 0) + j1 * state(at, 1) + j2 * state(at, 2);
    };
    const auto M = [&](const double* at) {
      return p.joints.ratio[k] *
             (2.0 / 3.0 * j1 * state(at, 0) + (j2 + q.swell[lane] * j0) * state(at, 1));
    };
    if (std::abs(L(c0)) >= idle * r0) logs += std::log(r - L(c)) + std::log(r + L(c));
    if (std::abs(M(c0)) >= idle) logs += std::log(1.0 - M(c)) + std::log(1.0 + M(c));
  }
  return q.length[lane] * r - mu * q.time[lane] * logs;
}

// The tangent of 1/sqrt(b) in a slack leaves its own curvature out of the second derivatives, so
// that they stay positive; the first ones are exact.
TEST(BarrierKernel, DerivesTheCost) {
  constexpr double mu = 0.3, h = 1e-5;
  constexpr double kDifferenceTol = 1e-8;  // central differences of order 1 at h
  const Problem p = problem();
  const auto terms = terms_of(kernel_of(simd_level()), p, p.c, mu);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      const double* c0 = &p.c[p.points[block].interval[lane]];
      for (std::size_t i = 0; i < 3; ++i) {
        std::array<double, 3> low = {c0[0], c0[1], c0[2]}, high = low;
        low[i] -= h, high[i] += h;
        const double slope =
            (cost(p, block, lane, high.data(), c0, mu) - cost(p, block, lane, low.data(), c0, mu)) /
            (2.0 * h);
        EXPECT_NEAR(terms[block].g[i][lane], slope, kDifferenceTol);
      }
    }
  }
}

// Without jerks the second derivatives are those of the cost.
TEST(BarrierKernel, DerivesTwiceWhereNoJerkIsNear) {
  constexpr double mu = 0.3, h = 1e-6;
  constexpr double kDifferenceTol = 1e-7;  // central differences of order 1 at h
  Problem p = problem();
  for (BarrierPoints& q : p.points) {
    for (auto& j0 : q.j0) j0 = {};
    for (auto& j2 : q.j2) j2 = {};
    for (auto& j1 : q.j1) {
      for (double& x : j1) x *= 0.1;
    }
  }
  p.joints.ratio = {30.0, 25.0, 20.0, 0.0, 0.0};
  const BarrierKernel kernel = kernel_of(simd_level());
  const auto terms = terms_of(kernel, p, p.c, mu);
  std::size_t accelerating = 0;
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    std::vector<double> low = p.c, high = p.c;
    low[i] -= h, high[i] += h;
    const auto below = terms_of(kernel, p, low, mu), above = terms_of(kernel, p, high, mu);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
        const std::size_t first = p.points[block].interval[lane];
        if (i < first || i > first + 2) continue;
        constexpr std::size_t kPlace[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
        for (std::size_t j = 0; j < 3; ++j) {
          const double slope = (above[block].g[j][lane] - below[block].g[j][lane]) / (2.0 * h);
          const double derived = terms[block].h[kPlace[i - first][j]][lane];
          EXPECT_NEAR(derived, slope, kDifferenceTol * (1.0 + std::abs(slope)));
          ++accelerating;
        }
      }
    }
  }
  EXPECT_EQ(accelerating, kBlocks * kLaneWidth * 9);
}

TEST(BarrierKernel, GivesTheSameBitsOnEveryInstructionSet) {
  const Problem p = problem();
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const BarrierKernel base = kernel_of(SimdLevel::baseline);
  const auto expected = terms_of(base, p, p.c, 0.3);
  for (const SimdLevel level : simd_levels()) {
    const BarrierKernel kernel = kernel_of(level);
    const auto terms = terms_of(kernel, p, p.c, 0.3);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      EXPECT_EQ(terms[block].x, expected[block].x);
      EXPECT_EQ(terms[block].g, expected[block].g);
      EXPECT_EQ(terms[block].h, expected[block].h);
    }
    const auto loss = [&](const BarrierKernel& k) {
      return bits(k.largest_loss(p.points.data(), kBlocks, p.joints, p.step.data(), terms.data()));
    };
    EXPECT_EQ(loss(kernel), loss(base));
    Problem one = p, two = p;
    const BarrierUse use = kernel.use(one.points.data(), kBlocks, p.joints, p.c.data());
    const BarrierUse same = base.use(two.points.data(), kBlocks, p.joints, p.c.data());
    EXPECT_EQ(bits(use.jerk), bits(same.jerk));
    EXPECT_EQ(bits(use.acceleration), bits(same.acceleration));
    EXPECT_EQ(bits(use.speed), bits(same.speed));
    EXPECT_EQ(bits(use.b_least), bits(same.b_least));
    EXPECT_EQ(one.points[0].time, two.points[0].time);
  }
}

// A step that takes a slack to zero loses all of it.
TEST(BarrierKernel, LosesAllWhereASlackVanishes) {
  constexpr double kRounding = 1e-13;
  Problem p = problem();
  p.joints.count = 0;
  const BarrierKernel kernel = kernel_of(simd_level());
  for (BarrierPoints& q : p.points) q.b_top.fill(100.0);
  for (double& x : p.step) x = 0.0;
  BarrierPoints& q = p.points[1];
  const std::size_t k = q.interval[5];
  for (std::size_t i = 0; i < 3; ++i) p.step[k + i] = 0.01;
  const double b = q.S[0][0][5] * p.c[k] + q.S[0][1][5] * p.c[k + 1] + q.S[0][2][5] * p.c[k + 2];
  const double db = 0.01 * (q.S[0][0][5] + q.S[0][1][5] + q.S[0][2][5]);
  q.b_top[5] = b + db;
  const auto terms = terms_of(kernel, p, p.c, 0.3);
  EXPECT_NEAR(kernel.largest_loss(p.points.data(), kBlocks, p.joints, p.step.data(), terms.data()),
              1.0, kRounding);
}

}  // namespace
}  // namespace servomill::controllers::barrier_kernel_test
