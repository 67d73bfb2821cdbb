// Filters of learning on recordings, against what they do to sinusoids.
#include "strategies/learning_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::strategies::learning_filter_test {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi;
constexpr double kH = 1 * ms;
constexpr double kCutoff = 40.0;         // Hz
constexpr double kNotInverted = 0.0025;  // share that L leaves of 1/P where |P| = 1: c^2 = 0.05^2
constexpr double kRounding = 1e-9;

Complex one(int, double) { return 1.0; }

std::vector<Joints> recording(int rows, int joint, const auto& value) {
  std::vector<Joints> out(static_cast<std::size_t>(rows), Joints::Zero());
  for (int n = 0; n < rows; ++n) out[static_cast<std::size_t>(n)][joint] = value(n * kH);
  return out;
}
std::vector<Joints> nothing(const std::vector<Joints>& like) {
  return std::vector<Joints>(like.size(), Joints::Zero());
}

// Complex amplitude of the middle of a recording of 3 s, from 1 to 2 s. The ends, a second away,
// are e^-180 of their size there. @pre whole periods in a second
constexpr int kRows = 3001;
Complex amplitude(const std::vector<Joints>& u, double f, int joint = 1) {
  Complex sum = 0.0;
  for (std::size_t n = 1000; n < 2000; ++n) {
    sum += u[n][joint] * std::polar(1.0, -2.0 * kPi * f * static_cast<double>(n) * kH);
  }
  return sum * 2.0 * kH;
}
std::vector<Joints> sinusoid(double f, int joint = 1) {
  return recording(kRows, joint, [&](double t) { return std::cos(2.0 * kPi * f * t); });
}

TEST(LearningFilter, LeavesHalfAtItsCutoff) {
  for (const double remembering : {1.0, 0.7}) {
    const LearningFilter filter{.cutoff = kCutoff, .remembering = remembering};
    EXPECT_EQ(Q_at(filter, 0.0), remembering);
    EXPECT_NEAR(Q_at(filter, kCutoff), 0.5 * remembering, kRounding);
    EXPECT_NEAR(Q_at(filter, 2.0 * kCutoff), remembering / 17.0, kRounding);
    EXPECT_NEAR(Q_at(filter, 0.5 * kCutoff), remembering / (1.0 + 1.0 / 16.0), kRounding);
  }
}

TEST(LearningFilter, InvertsWhereTheAxisFollowsAndHardlyWhereItDoesNot) {
  const LearningFilter filter{.cutoff = kCutoff};
  for (double angle = -3.0; angle < 3.1; angle += 0.5) {
    const Complex P = std::polar(1.0, angle), L = L_of(filter, P);
    EXPECT_LT(std::abs(L * P - 1.0), kNotInverted);
    EXPECT_NEAR(std::abs(L * P - 1.0), kNotInverted / (1.0 + kNotInverted), kRounding);
    // 1/P of P = 2, too; most at |P| = c: 1/(2 c); then less and less
    EXPECT_NEAR(std::abs(L_of(filter, 2.0 * P) * 2.0 * P - 1.0), kNotInverted / 4.0, 1e-5);
    EXPECT_NEAR(std::abs(L_of(filter, 0.05 * P)), 10.0, kRounding);
    EXPECT_NEAR(std::arg(L_of(filter, 0.05 * P) * P), 0.0, kRounding);
    EXPECT_NEAR(std::abs(L_of(filter, 1e-4 * P)), 1e-4 / kNotInverted, 1e-6);
  }
  for (double size = 0.0; size < 3.0; size += 0.01) {
    EXPECT_LE(std::abs(L_of(filter, size)), 10.0 + kRounding);
  }
  EXPECT_EQ(L_of(filter, 0.0), 0.0);
}

TEST(LearningFilter, MultipliesWithItsGain) {
  const Complex P(0.3, -0.8);
  const LearningFilter half{.cutoff = kCutoff, .gain = 0.5}, whole{.cutoff = kCutoff};
  EXPECT_LE(std::abs(L_of(half, P) - 0.5 * L_of(whole, P)), kRounding);
}

TEST(NextOffset, PassesASinusoidOfTheOffsetByQ) {
  const LearningFilter filter{.cutoff = kCutoff, .remembering = 0.9};
  for (const double f : {1.0, 10.0, 40.0, 97.0, 400.0}) {
    const std::vector<Joints> u = sinusoid(f);
    const auto next = next_offset(u, nothing(u), kH, filter, {1}, one);
    ASSERT_EQ(next.size(), u.size());
    EXPECT_LE(std::abs(amplitude(next, f) - Q_at(filter, f)), kRounding) << f;  // without a lag
  }
}

TEST(NextOffset, PassesASinusoidOfTheErrorByQAndL) {
  const LearningFilter filter{.cutoff = kCutoff, .gain = 0.8};
  const auto P = [](int, double f) { return 0.6 / Complex(1.0, f / 30.0); };
  for (const double f : {5.0, 40.0, 60.0}) {
    const std::vector<Joints> e = sinusoid(f);
    const auto next = next_offset(nothing(e), e, kH, filter, {1}, P);
    EXPECT_LE(std::abs(amplitude(next, f) - Q_at(filter, f) * L_of(filter, P(1, f))), 1e-6) << f;
  }
}

// L of a delay looks ahead by it, whether it is whole rows or not.
TEST(NextOffset, AdvancesTheErrorByTheDelayOfTheAxis) {
  const LearningFilter filter{.cutoff = kCutoff};
  for (const double delay : {5.0 * kH, 2.3 * kH}) {
    const auto P = [&](int, double f) { return std::polar(1.0, -2.0 * kPi * f * delay); };
    for (const double f : {3.0, 20.0, 55.0}) {
      const std::vector<Joints> e = sinusoid(f);
      const auto next = next_offset(nothing(e), e, kH, filter, {1}, P);
      for (std::size_t n = 1000; n < 2000; ++n) {
        const double t = static_cast<double>(n) * kH + delay;
        EXPECT_NEAR(next[n][1],
                    Q_at(filter, f) / (1.0 + kNotInverted) * std::cos(2.0 * kPi * f * t), 1e-6);
      }
    }
  }
}

TEST(NextOffset, AsksForTheResponseOfEachJointUpToHalfTheRateOfTheRows) {
  const std::vector<Joints> u = recording(100, 0, [](double) { return 0.0; });
  std::array<double, kJoints> lowest, highest;
  lowest.fill(1e9);
  highest.fill(-1.0);
  next_offset(u, u, kH, {.cutoff = kCutoff}, {0, 3}, [&](int joint, double f) {
    lowest[static_cast<std::size_t>(joint)] = std::min(lowest[static_cast<std::size_t>(joint)], f);
    highest[static_cast<std::size_t>(joint)] =
        std::max(highest[static_cast<std::size_t>(joint)], f);
    return 1.0;
  });
  for (const std::size_t joint : {0U, 3U}) {
    EXPECT_EQ(lowest[joint], 0.0);
    EXPECT_NEAR(highest[joint], 0.5 / kH, kRounding);
  }
  EXPECT_EQ(highest[1], -1.0) << "not offset";
}

TEST(NextOffset, KeepsAConstantToItsEnds) {
  for (const int rows : {1, 2, 37, 1000}) {
    const std::vector<Joints> u = recording(rows, 2, [](double) { return 3.0; });
    const auto next = next_offset(u, nothing(u), kH, {.cutoff = kCutoff}, {2}, one);
    for (const Joints& row : next) EXPECT_NEAR(row[2], 3.0, kRounding) << rows;
    const auto forgetting =
        next_offset(u, nothing(u), kH, {.cutoff = kCutoff, .remembering = 0.75}, {2}, one);
    for (const Joints& row : forgetting) EXPECT_NEAR(row[2], 2.25, kRounding) << rows;
  }
}

// Behind its end a recording turns back to its beginning, smoothly but at once: that much is seen.
constexpr double kTurn = 1e-3;  // share of the difference between the ends

// At both ends the recording goes on from its last row: it is filtered as if it were longer, also
// where the step is next to the end.
TEST(NextOffset, TakesItsEndsForStandstills) {
  const LearningFilter filter{.cutoff = kCutoff};
  for (const double at : {0.05, 0.5, 0.95, 0.995}) {  // of the recording
    for (const int rows : {1001, 824, 825}) {         // 1024 less 2 * 4 / (40 Hz 1 ms) rows: 824
      const double there = (std::floor(at * (rows - 1)) + 0.5) * kH;  // between two rows
      const auto step = [&](double t) { return t < there ? -1.0 : 2.0; };
      const std::vector<Joints> u = recording(rows, 0, step);
      const std::vector<Joints> longer =
          recording(rows + 2000, 0, [&](double t) { return step(t - 1.0); });
      const auto next = next_offset(u, nothing(u), kH, filter, {0}, one);
      const auto expected = next_offset(longer, nothing(longer), kH, filter, {0}, one);
      double most = 0.0;
      for (std::size_t n = 0; n < next.size(); ++n) {
        most = std::max(most, std::abs(next[n][0] - expected[n + 1000][0]));
      }
      EXPECT_LE(most, 3.0 * kTurn) << at << ", " << rows;
    }
  }
}

TEST(NextOffset, DoesNotCarryAnEndIntoTheOther) {
  const auto ramp = [](double t) { return std::clamp((t - 0.4) / 0.2, 0.0, 1.0); };
  for (const int rows : {1000, 824, 5000}) {
    const std::vector<Joints> u = recording(rows, 0, ramp);
    const auto next = next_offset(u, nothing(u), kH, {.cutoff = kCutoff}, {0}, one);
    for (std::size_t n = 0; n < 200; ++n) EXPECT_NEAR(next[n][0], 0.0, kTurn) << n;
    for (std::size_t n = 700; n < next.size(); ++n) EXPECT_NEAR(next[n][0], 1.0, kTurn) << n;
  }
}

TEST(NextOffset, LeavesOtherJointsAtNothing) {
  std::vector<Joints> u = sinusoid(3.0);
  for (Joints& row : u) row.setConstant(row[1]);
  const auto next = next_offset(u, u, kH, {.cutoff = kCutoff}, {0, 4}, one);
  for (const Joints& row : next) EXPECT_EQ(row.segment<3>(1), Eigen::Vector3d::Zero());
  EXPECT_GT(std::abs(amplitude(next, 3.0, 0)), 1.9);
  EXPECT_NEAR(std::abs(amplitude(next, 3.0, 0) - amplitude(next, 3.0, 4)), 0.0, kRounding);
  EXPECT_TRUE(next_offset({}, {}, kH, {.cutoff = kCutoff}, {0}, one).empty());
}

TEST(ShareLeft, HasClosedForms) {
  const LearningFilter filter{.cutoff = kCutoff, .gain = 1.5, .remembering = 0.8};
  const double L = 1.5 / (1.0 + kNotInverted);
  EXPECT_NEAR(share_left(filter, 0.0, 1.0, 1.0), 0.8 * (L - 1.0), kRounding);
  EXPECT_NEAR(share_left(filter, kCutoff, 1.0, 1.0), 0.4 * (L - 1.0), kRounding);
  EXPECT_NEAR(share_left(filter, 0.0, 1.0, -1.0), 0.8 * (1.0 + L), kRounding);
  EXPECT_NEAR(share_left(filter, 0.0, 1.0, {0.0, 1.0}), 0.8 * std::hypot(1.0, L), kRounding);
  EXPECT_NEAR(share_left(filter, 0.0, 1.0, 0.0), 0.8, kRounding) << "nothing is learnt";
}

TEST(LimitOfError, HasClosedForms) {
  const LearningFilter filter{.cutoff = kCutoff};
  EXPECT_EQ(limit_of_error(filter, 0.0, 1.0, 0.7), 0.0) << "what repeats at rest is learnt";
  EXPECT_NEAR(std::abs(limit_of_error(filter, kCutoff, 1.0, 1.0 + kNotInverted) - 0.5), 0.0,
              kRounding);
  EXPECT_NEAR(std::abs(limit_of_error(filter, 1e6, 1.0, 1.0) - 1.0), 0.0, kRounding)
      << "far beyond the cutoff nothing is";
  const LearningFilter forgetting{.cutoff = kCutoff, .remembering = 0.8};
  EXPECT_NEAR(std::abs(limit_of_error(forgetting, 0.0, 1.0, 1.0 + kNotInverted) - 0.2), 0.0,
              kRounding);
}

// A plant with a first-order lag of T, as the rows see it: y_n = y_(n-1) + share (u_n - y_(n-1)).
struct Lag {
  double share;
  Complex at(double f) const {
    return share / (1.0 - (1.0 - share) * std::polar(1.0, -2.0 * kPi * f * kH));
  }
  std::vector<Joints> of(const std::vector<Joints>& u) const {
    std::vector<Joints> y = u;
    for (std::size_t n = 1; n < y.size(); ++n) y[n] = y[n - 1] + share * (u[n] - y[n - 1]);
    return y;
  }
};

// Runs of a plant that repeats its error: e_(k+1) - e of the limit falls by the share that is left,
// whatever the plant is known to be.
TEST(NextOffset, LetsErrorsFallByTheShareLeftToTheirLimit) {
  const LearningFilter filter{.cutoff = kCutoff, .gain = 0.7, .remembering = 0.97};
  const Lag actual{0.15}, known{0.25};
  for (const double f : {2.0, 15.0, 40.0}) {
    const std::vector<Joints> e_0 = sinusoid(f);
    const Complex limit = limit_of_error(filter, f, known.at(f), actual.at(f)) * amplitude(e_0, f);
    const double share = share_left(filter, f, known.at(f), actual.at(f));
    ASSERT_LT(share, 0.9);
    std::vector<Joints> u = nothing(e_0);
    double away = std::abs(amplitude(e_0, f) - limit);
    for (int k = 0; k < 8; ++k) {
      std::vector<Joints> e = actual.of(u);
      for (std::size_t n = 0; n < e.size(); ++n) e[n] = e_0[n] - e[n];
      const double now = std::abs(amplitude(e, f) - limit);
      if (k > 0) {
        EXPECT_NEAR(now, share * away, 1e-6) << f << ", run " << k;
      }
      away = now;
      u = next_offset(u, e, kH, filter, {1}, [&](int, double at) { return known.at(at); });
    }
    EXPECT_LE(away, 1.01 * std::pow(share, 7) * std::abs(amplitude(e_0, f) - limit) + 1e-6);
  }
}

TEST(NextOffset, MovesAwayWhereNoErrorContracts) {
  const LearningFilter filter{.cutoff = kCutoff};
  const std::vector<Joints> e_0 = sinusoid(2.0);
  ASSERT_NEAR(share_left(filter, 2.0, 1.0, 2.5), 1.5, 0.01);
  std::vector<Joints> u = nothing(e_0), e = e_0;
  for (int k = 0; k < 5; ++k) {
    u = next_offset(u, e, kH, filter, {1}, one);
    for (std::size_t n = 0; n < e.size(); ++n) e[n] = e_0[n] - 2.5 * u[n];
  }
  EXPECT_NEAR(std::abs(amplitude(e, 2.0)), std::pow(share_left(filter, 2.0, 1.0, 2.5), 5), 1e-3);
}

}  // namespace
}  // namespace servomill::strategies::learning_filter_test
