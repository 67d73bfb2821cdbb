#include "plant/sensing/reference_marks.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "plant/vocabulary/units.h"
#include "tests/counting_new.h"

namespace servomill::plant::reference_marks_test {
namespace {

constexpr double kPeriod = 20 * um;           // LS 486C
constexpr double kFeedbackSample = 0.5 * mm;  // travel between samples in most tests
constexpr double kRounding = 1e-15;           // m, of coordinates below 2 m

ReferenceMarks metre() { return ReferenceMarks(marks_of_scale(kPeriod, 1000, -0.5, 0.5)); }

ReferenceMarks ron() { return ReferenceMarks(marks_of_revolution(18000, 1000)); }

double uniform(boost::random::mt19937_64& engine, double from, double to) {
  return boost::random::uniform_real_distribution<double>(from, to)(engine);
}

TEST(ReferenceMarks, StandWhereTheScaleHasThem) {
  const ReferenceMarks marks = metre();
  EXPECT_NEAR(marks.position(0), -0.5, kRounding);
  EXPECT_NEAR(marks.position(1), -0.5 + 10.02 * mm, kRounding);
  EXPECT_NEAR(marks.position(2), -0.5 + 20 * mm, kRounding);
  EXPECT_NEAR(marks.position(3), -0.5 + 30.04 * mm, kRounding);
  EXPECT_NEAR(marks.position(100), 0.5, kRounding);
  EXPECT_TRUE(marks.has(0) && marks.has(100));
  EXPECT_FALSE(marks.has(-1) || marks.has(101));
  EXPECT_EQ(marks.position(-1), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(marks.position(101), std::numeric_limits<double>::infinity());
}

TEST(ReferenceMarks, HaveEveryDistanceOnce) {
  const ReferenceMarks marks = metre();
  std::set<std::int64_t> distances;
  for (int m = 0; m < 100; ++m) distances.insert(marks.periods(m + 1) - marks.periods(m));
  EXPECT_EQ(distances.size(), 100u);
}

// The maker's "position known after at most 20 mm", to a period.
TEST(ReferenceMarks, AreTwoWithinTheNominalIncrement) {
  const ReferenceMarks marks = metre();
  for (int m = 0; m + 2 <= 100; ++m) {
    EXPECT_LE(marks.position(m + 2) - marks.position(m), 20.02 * mm + kRounding) << m;
  }
}

TEST(ReferenceMarks, AreFoundFromTheCoordinate) {
  for (const ReferenceMarks& marks : {metre(), ron()}) {
    for (int m = 0; m <= 36; ++m) {
      const double at = marks.position(m);
      EXPECT_EQ(marks.above(at), m + 1);
      EXPECT_EQ(marks.above(std::nextafter(at, -9.0)), m);
    }
  }
  EXPECT_EQ(metre().above(-7.0), 0);
  EXPECT_EQ(metre().above(7.0), 101);
}

TEST(Decode, FindsEveryPairOfNeighboursInBothDirections) {
  const ReferenceMarks marks = metre();
  for (int m = 0; m < 100; ++m) {
    const std::int64_t M = marks.periods(m + 1) - marks.periods(m);
    EXPECT_EQ(marks.decode(M, +1), marks.periods(m)) << m;
    EXPECT_EQ(marks.decode(-M, -1), marks.periods(m + 1)) << m;
  }
}

TEST(Decode, KnowsNoOtherDistances) {
  const ReferenceMarks marks = metre();  // 50 intervals: 450 .. 499 and 501 .. 550
  for (const int D : {-1, 1}) {
    EXPECT_FALSE(marks.decode(449, D));
    EXPECT_TRUE(marks.decode(450, D));
    EXPECT_FALSE(marks.decode(500, D));
    EXPECT_TRUE(marks.decode(550, D));
    EXPECT_FALSE(marks.decode(551, D));
    EXPECT_FALSE(marks.decode(0, D));
  }
}

// The danger of a displacement while homing: one period less or more is a valid code.
TEST(Decode, OfACountWrongByOneIsAWholeIncrementAway) {
  const ReferenceMarks marks = metre();
  const std::int64_t M = marks.periods(21) - marks.periods(20);
  EXPECT_EQ(*marks.decode(M + 1, 1) - *marks.decode(M, 1), 1000);  // 20 mm
  EXPECT_EQ(*marks.decode(M - 1, 1) - *marks.decode(M, 1), -1000);
}

TEST(Decode, FindsEveryPairOfARotaryEncoder) {
  const ReferenceMarks marks = ron();
  EXPECT_NEAR(marks.position(36), 2 * std::numbers::pi, 1e-14);
  for (int m = -72; m < 72; ++m) {
    const std::int64_t M = marks.periods(m + 1) - marks.periods(m);
    const auto on_the_circle = [](std::int64_t n) { return (n % 18000 + 18000) % 18000; };
    EXPECT_EQ(on_the_circle(*marks.decode(M, +1)), on_the_circle(marks.periods(m))) << m;
    EXPECT_EQ(on_the_circle(*marks.decode(M, -1)), on_the_circle(marks.periods(m + 1))) << m;
  }
}

// Drives straight from a to b with the displacement d(x); the first fault, if any.
template <typename Displacement>
std::optional<MarkFault> drive(MarkMonitor& monitor, double a, double b, Displacement d,
                               double sample = kFeedbackSample) {
  const int steps = static_cast<int>(std::ceil(std::abs(b - a) / sample));
  std::optional<MarkFault> first;
  for (int n = 1; n <= steps; ++n) {
    const double x = a + (b - a) * n / steps;
    const auto fault = monitor.advance(x, x + d(x));
    if (!first) first = fault;
  }
  return first;
}

TEST(MarkMonitor, NeverComplainsWithoutDisplacement) {
  boost::random::mt19937_64 engine(6);
  for (const ReferenceMarks& marks : {metre(), ron()}) {
    MarkMonitor monitor(marks);
    double x = 0.0;
    monitor.start(x, x);
    for (int n = 0; n < 100000; ++n) {
      // steps from far below to far above the distance of the marks, beyond the ends as well
      const double size = std::pow(10.0, uniform(engine, -6.0, 0.0));
      x += uniform(engine, -size, size);
      if (std::abs(x) > 1.0) x = 0.0;
      EXPECT_FALSE(monitor.advance(x, x)) << n;
    }
  }
}

TEST(MarkMonitor, NeverComplainsAboutReversalsAtAMark) {
  const ReferenceMarks marks = metre();
  const double at = marks.position(41);
  MarkMonitor monitor(marks);
  monitor.start(at - 1 * mm, at - 1 * mm);
  for (const double by : {0.0, -1e-9, 0.0, 1e-9, -1e-9, 1e-9, 0.0, 0.0, 12e-3, -12e-3, 0.0}) {
    EXPECT_FALSE(monitor.advance(at + by, at + by)) << by;
  }
}

TEST(MarkMonitor, NeverComplainsAboutAConstantDisplacement) {
  MarkMonitor monitor(metre());
  monitor.start(-0.4, -0.4 + 123.4 * um);
  EXPECT_FALSE(drive(monitor, -0.4, 0.4, [](double) { return 123.4 * um; }));
}

// The law: half a period of change between two neighbouring marks is the limit.
TEST(MarkMonitor, ComplainsWhenTheDisplacementChangesByMoreThanHalfAPeriod) {
  const ReferenceMarks marks = metre();
  const double a = marks.position(50), b = marks.position(51);
  for (const int sense : {-1, 1}) {
    for (const int way : {-1, 1}) {
      const auto ramp = [&](double change) {
        return [=](double x) { return sense * change * (x - a) / (b - a); };
      };
      const double from = way > 0 ? a - 1 * mm : b + 1 * mm;
      const double to = way > 0 ? b + 1 * mm : a - 1 * mm;
      MarkMonitor monitor(marks);
      monitor.start(from, from + ramp(0.499 * kPeriod)(from));
      EXPECT_FALSE(drive(monitor, from, to, ramp(0.499 * kPeriod)));
      monitor.start(from, from + ramp(0.501 * kPeriod)(from));
      const auto fault = drive(monitor, from, to, ramp(0.501 * kPeriod));
      ASSERT_TRUE(fault);
      EXPECT_EQ(fault->expected, way * (marks.periods(51) - marks.periods(50)));
      EXPECT_EQ(fault->counted, fault->expected + way * sense);
      EXPECT_EQ(fault->from, way > 0 ? a : b);
      EXPECT_EQ(fault->to, way > 0 ? b : a);
    }
  }
}

TEST(MarkMonitor, AllowsAsManyPeriodsAsItIsReported) {
  const ReferenceMarks marks = metre();
  const auto ramp = [](double x) { return 3.4 * kPeriod * x / (10 * mm); };  // 3.4 in 10 mm
  MarkMonitor strict(marks, 2), lenient(marks, 4);
  strict.start(0.0, 0.0);
  lenient.start(0.0, 0.0);
  EXPECT_TRUE(drive(strict, 0.0, 0.1, ramp));
  EXPECT_FALSE(drive(lenient, 0.0, 0.1, ramp));
}

TEST(MarkMonitor, ComplainsOfAMarkThatMovedWhileTheSlideTurnedRound) {
  const ReferenceMarks marks = metre();
  const double at = marks.position(51);
  MarkMonitor monitor(marks);
  monitor.start(at - 1 * mm, at - 1 * mm);
  EXPECT_FALSE(monitor.advance(at + 1 * mm, at + 1 * mm));
  EXPECT_FALSE(monitor.advance(at + 1 * mm, at + 1 * mm + 11 * um));  // at rest, displaced
  EXPECT_EQ(monitor.advance(at - 1 * mm, at - 1 * mm + 11 * um), (MarkFault{at, at, 1, 0}));
}

TEST(MarkMonitor, TakesTheReadingAtTheMarkBetweenSamples) {
  const ReferenceMarks marks = metre();
  const double a = marks.position(50), b = marks.position(51);
  const auto linear = [&](double x) { return x + 0.49 * kPeriod * (x - a) / (b - a); };
  // samples far outside the two marks see a change of nearly a period
  MarkMonitor monitor(marks);
  monitor.start(a - 4 * mm, linear(a - 4 * mm));
  EXPECT_FALSE(monitor.advance(a + 4 * mm, linear(a + 4 * mm)));
  EXPECT_FALSE(monitor.advance(b + 4 * mm, linear(b + 4 * mm)));
}

TEST(MarkMonitor, TellsTheFirstOfSeveralMarksInOneStep) {
  const ReferenceMarks marks = metre();
  MarkMonitor monitor(marks);
  const double a = marks.position(50) - 1 * mm, b = marks.position(54) + 1 * mm;
  monitor.start(a, a);
  const auto fault = monitor.advance(b, b + 9 * kPeriod);  // 2.25 in 10.52 of 42 mm
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->from, marks.position(50));
  EXPECT_EQ(fault->to, marks.position(51));
  EXPECT_EQ(fault->counted - fault->expected, 2);
  // it has arrived: the way back without further change is counted from there
  EXPECT_FALSE(
      monitor.advance(marks.position(53) + 1 * mm, marks.position(53) + 1 * mm + 9 * kPeriod));
}

TEST(MarkMonitor, WatchesARotaryEncoderAllAround) {
  MarkMonitor monitor(ron());
  const double period = ron().params().period;
  monitor.start(-0.1, -0.1);
  EXPECT_FALSE(drive(
      monitor, -0.1, -20.0, [](double) { return 0.0; }, 0.05));
  EXPECT_FALSE(drive(
      monitor, -20.0, 20.0, [](double) { return 0.0; }, 0.05));
  const auto jump = [&](double x) { return x > 25.0 ? period : 0.0; };
  const auto fault = drive(monitor, 20.0, 30.0, jump, 0.01);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->counted, fault->expected + 1);
  EXPECT_TRUE(fault->from < 25.0 && 25.0 < fault->to);
}

// [G], experiment 1: +-150 um over 50 mm. Between marks 20 mm apart the displacement changes by up
// to 2 * 150 um sin(pi 20/50) = 285 um, 14 periods; between neighbours (up to 11 mm apart
// here) by up to 2 * 150 um sin(pi 11/50) = 191 um, 10.
TEST(MarkMonitor, SeesTheSineOfTheFirstExperiment) {
  const auto sine = [](double x) { return 150 * um * std::sin(2 * std::numbers::pi * x / 0.05); };
  const ReferenceMarks marks = metre();
  std::int64_t worst_of_neighbours = 0, worst_of_fixed = 0;
  for (int m = 0; m < 100; ++m) {
    const double a = marks.position(m), b = marks.position(m + 1);
    MarkMonitor monitor(marks);
    monitor.start(a - 0.1 * mm, a - 0.1 * mm + sine(a - 0.1 * mm));
    const auto fault = drive(monitor, a - 0.1 * mm, b + 0.1 * mm, sine, 0.01 * mm);
    const std::int64_t wrong = std::llround((sine(b) - sine(a)) / kPeriod);
    EXPECT_EQ(fault.has_value(), wrong != 0) << m;
    EXPECT_EQ(fault ? fault->counted - fault->expected : 0, wrong) << m;
    worst_of_neighbours = std::max(worst_of_neighbours, std::abs(wrong));
  }
  for (double x = 0.0; x < 0.05; x += 0.1 * mm) {
    const std::int64_t wrong = std::llround((sine(x + 20 * mm) - sine(x)) / kPeriod);
    worst_of_fixed = std::max(worst_of_fixed, std::abs(wrong));
  }
  EXPECT_EQ(worst_of_neighbours, 10);
  EXPECT_EQ(worst_of_fixed, 14);
}

TEST(MarkMonitor, DoesNotAllocate) {
  MarkMonitor monitor(metre());
  const std::size_t before = allocations;
  monitor.start(-0.4, -0.4);
  const bool complained = drive(monitor, -0.4, 0.4, [](double x) { return 0.01 * x; }).has_value();
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(complained);
}

TEST(Implausible, NamesWhatNoTrackCanBe) {
  using Faults = std::vector<std::string>;
  EXPECT_TRUE(implausible(metre().params()).empty());
  EXPECT_TRUE(implausible(ron().params()).empty());
  EXPECT_EQ(implausible({0.0, 1000, 5}), Faults{"period must be > 0"});
  EXPECT_EQ(implausible({kPeriod, 1001, 5}), Faults{"increment must be even and > 0"});
  EXPECT_EQ(implausible({kPeriod, 1000, 0}), Faults{"intervals must be >= 1"});
  EXPECT_EQ(implausible({kPeriod, 1000, 500}),
            Faults{"intervals must be < N / 2, or the code repeats"});
  EXPECT_TRUE(implausible({kPeriod, 1000, 499}).empty());
  EXPECT_EQ(implausible(marks_of_revolution(18500, 1000)),
            Faults{"increment must divide the periods of a revolution"});
}

}  // namespace
}  // namespace servomill::plant::reference_marks_test
