/// Feedback strategies that are written for one run.
#include "strategies/single_run_feedback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/counting_new.h"

namespace servomill::strategies::single_run_feedback_test {
namespace {

constexpr double kPeriod = 60e-6;  // s

// Looks at everything that it is given, and remembers.
struct Summing {
  using State = double;
  Joints settle(const Reading& now, State& sum) const {
    sum = 0.0;
    return 1e-3 * now.Q_fb;
  }
  Joints displacement(const Reading& now, State& sum) const {
    sum += std::sin(now.Q_fb[0] + now.t) + now.s * now.dQ_ref[1];
    return sum * now.Q_fb;
  }
};

Joints position(std::size_t lane, std::size_t n) {
  const double x = 0.1 + 0.01 * static_cast<double>(lane) + 1e-4 * static_cast<double>(n);
  return Joints{x, -x, 0.3 * x, 0.2, -0.1};
}

Reading reading(std::size_t lane, std::size_t n) {
  Reading now;
  now.t = static_cast<double>(n) * kPeriod;
  now.s = 1e-3 * static_cast<double>(n * (lane + 1));
  now.dQ_ref.setConstant(0.1);
  now.Q_fb = position(lane, n);
  return now;
}

constexpr std::size_t kPeriods = 24;

std::vector<Joints> alone(std::size_t lane, std::size_t together) {
  SingleRunFeedback<Summing> part("summing", {}, kPeriod);
  part.observe(reading(lane, 0), lane);
  part.settle(position(lane, 0), lane);
  std::vector<Joints> out;
  for (std::size_t n = 0; n < kPeriods; n += together) {
    JointLanes Q{};
    for (std::size_t k = 0; k < together; ++k) {
      part.observe(reading(lane, n + k), lane);
      for (int j = 0; j < kJoints; ++j) Q[j][k] = position(lane, n + k)[j];
    }
    out.push_back(part.advance(Q, together, lane));
  }
  return out;
}

TEST(SingleRunFeedback, GivesTheSameBitsInAnyLaneAndForAnyNumberOfRuns) {
  for (std::size_t runs = 1; runs <= kLaneWidth; ++runs) {
    SingleRunFeedback<Summing> part("summing", {}, kPeriod);
    LaneFlags lanes = {};
    for (std::size_t lane = 0; lane < runs; ++lane) {
      lanes[lane] = true;
      part.observe(reading(lane, 0), lane);
      part.settle(position(lane, 0), lane);
    }
    std::vector<std::vector<Joints>> expected;
    for (std::size_t lane = 0; lane < runs; ++lane) expected.push_back(alone(lane, 1));
    for (std::size_t n = 0; n < kPeriods; ++n) {
      JointLanes Q;
      for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
        for (int j = 0; j < kJoints; ++j) Q[j][lane] = lanes[lane] ? position(lane, n)[j] : 1e300;
        if (lanes[lane]) part.observe(reading(lane, n), lane);
      }
      const JointLanes& d = part.advance(Q, lanes);
      for (std::size_t lane = 0; lane < runs; ++lane) {
        for (int j = 0; j < kJoints; ++j) EXPECT_EQ(d[j][lane], expected[lane][n][j]);
      }
    }
  }
}

TEST(SingleRunFeedback, GivesTheSameBitsInPeriodsThatWaited) {
  const std::vector<Joints> one_by_one = alone(3, 1), eight = alone(3, 8), four = alone(3, 4);
  for (std::size_t n = 0; n < kPeriods / 8; ++n) EXPECT_EQ(eight[n], one_by_one[8 * n + 7]);
  for (std::size_t n = 0; n < kPeriods / 4; ++n) EXPECT_EQ(four[n], one_by_one[4 * n + 3]);
}

TEST(SingleRunFeedback, ActsAPeriodAfterItsReading) {
  SingleRunFeedback<Summing> part("summing", {}, kPeriod);
  const Joints settled = part.settle(position(0, 0), 0);
  EXPECT_EQ(settled, Joints(1e-3 * position(0, 0)));
  FeedbackPart& any = part;
  EXPECT_EQ(any.advance(position(0, 1)), settled);
  EXPECT_EQ(any.advance(position(0, 2)), Joints(std::sin(position(0, 1)[0]) * position(0, 1)));
}

TEST(SingleRunFeedback, DoesNotAllocate) {
  SingleRunFeedback<Summing> part("summing", {}, kPeriod);
  part.settle(position(0, 0), 0);
  JointLanes Q{};
  LaneFlags lanes = {};
  lanes.fill(true);
  const std::size_t before = allocations;
  for (std::size_t n = 0; n < 100; ++n) {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) part.observe(reading(lane, n), lane);
    part.advance(Q, lanes);
  }
  EXPECT_EQ(allocations, before);
}

// Fails from x = 1 m on: by an exception, or silently.
struct Failing {
  using State = int;
  Joints settle(const Reading&, State&) const { return Joints::Constant(1e-6); }
  Joints displacement(const Reading& now, State&) const {
    if (now.Q_fb[0] < 1.0) return Joints::Constant(2e-6);
    if (throws) throw std::runtime_error("x beyond 1 m");
    return Joints::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  bool throws;
};

TEST(SingleRunFeedback, EndsItsOwnRunWhereItFails) {
  for (const bool throws : {true, false}) {
    SingleRunFeedback<Failing> part("failing", {throws}, kPeriod);
    part.settle(Joints::Zero(), 0);
    part.settle(Joints::Zero(), 1);
    LaneFlags lanes = {};
    lanes[0] = lanes[1] = true;
    JointLanes Q{};
    part.advance(Q, lanes);
    EXPECT_EQ(part.failure(0), "");
    Q[0][1] = 1.0;
    part.advance(Q, lanes);
    EXPECT_EQ(part.failure(0), "");
    EXPECT_EQ(part.failure(1),
              throws ? "strategy failing: displacement: x beyond 1 m"
                     : "strategy failing: displacement returned a value that is not finite");
    const JointLanes& d = part.advance(Q, lanes);
    EXPECT_EQ(d[0][0], 2e-6);
    EXPECT_EQ(d[0][1], 2e-6);  // the last that was good
    part.settle(Joints::Zero(), 0);
    EXPECT_EQ(part.failure(0), "");
  }
}

}  // namespace
}  // namespace servomill::strategies::single_run_feedback_test
