// The offset at a place of a planned program.
#include "strategies/path_offset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "planned_motion.h"

namespace servomill::strategies::path_offset_test {
namespace {

using namespace planned_motion;

PathOffset offset_of(const std::vector<double>& rows_of_Y, std::size_t every = 1,
                     double feed_per_row = 10 * um) {
  PathTimes times{.h = kH, .s = {}, .every = every};
  for (std::size_t n = 0; n < (rows_of_Y.size() - 1) * every + 1; ++n) {
    times.s.push_back(static_cast<double>(n) / static_cast<double>(every) * feed_per_row);
  }
  std::vector<Joints> rows;
  for (const double one : rows_of_Y) rows.push_back(Joints::Unit(1) * one);
  return {std::make_shared<const PathTimes>(std::move(times)), std::move(rows)};
}

std::vector<double> rows_of(const auto& f, int rows = 20) {
  std::vector<double> out;
  for (int n = 0; n < rows; ++n) out.push_back(f(static_cast<double>(n)));
  return out;
}

TEST(PathTimes, HaveARowForEverySoManyInstants) {
  PathTimes times{.h = kH, .s = std::vector<double>(9, 0.0), .every = 4};
  EXPECT_EQ(times.rows(), 3U);
  EXPECT_NEAR(times.row_period(), 4.0 * kH, kRounding);
  times.s.push_back(0.0);
  EXPECT_EQ(times.rows(), 3U) << "10 instants: rows at 0, 4, 8";
  times.s.resize(13);
  EXPECT_EQ(times.rows(), 4U);
}

// A uniform cubic B-spline with control points x^k at the whole numbers x is x, x^2 + 1/3, x^3 + x.
TEST(PathOffset, ReproducesWhatItsSplineDoes) {
  const PathOffset constant = offset_of(rows_of([](double) { return 3.0; })),
                   linear = offset_of(rows_of([](double x) { return 2.0 - x; })),
                   square = offset_of(rows_of([](double x) { return x * x; })),
                   cube = offset_of(rows_of([](double x) { return x * x * x; }));
  for (double x = 1.0; x < 18.0; x += 0.0625) {  // where both neighbours exist
    EXPECT_NEAR(constant.at(x)[1], 3.0, kRounding);
    EXPECT_NEAR(linear.at(x)[1], 2.0 - x, 20.0 * kRounding);
    EXPECT_NEAR(square.at(x)[1], x * x + 1.0 / 3.0, 400.0 * kRounding);
    EXPECT_NEAR(cube.at(x)[1], x * x * x + x, 8000.0 * kRounding);
    EXPECT_EQ(cube.at(x)[0], 0.0);
    EXPECT_EQ(cube.at(x).tail<3>(), (Joints::Zero().tail<3>()));
  }
}

std::vector<double> random_rows(unsigned seed, int rows = 20) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return rows_of([&](double) { return normal(random); }, rows);
}

// Each piece is a cubic: differences of four of its points are its derivatives.
TEST(PathOffset, HasContinuousAccelerationAndTheThirdDifferenceOfItsRowsAsJerk) {
  const std::vector<double> u = random_rows(1);
  const PathOffset offset = offset_of(u);
  constexpr double kD = 0.25;
  constexpr double kTol = 1e-11;  // rounding, by kD^3
  const auto y = [&](double x) { return offset.at(x)[1]; };
  for (std::size_t n = 2; n + 3 < u.size(); ++n) {
    const auto x = static_cast<double>(n);
    const auto jerk = [&](double side) {  // of the piece before (-) or behind (+)
      return side *
             (y(x + 3 * side * kD) - 3 * y(x + 2 * side * kD) + 3 * y(x + side * kD) - y(x)) /
             std::pow(kD, 3);
    };
    const auto acceleration = [&](double side) {
      return (2 * y(x) - 5 * y(x + side * kD) + 4 * y(x + 2 * side * kD) - y(x + 3 * side * kD)) /
             (kD * kD);
    };
    const auto velocity = [&](double side) {
      return side *
             (-11 * y(x) + 18 * y(x + side * kD) - 9 * y(x + 2 * side * kD) +
              2 * y(x + 3 * side * kD)) /
             (6 * kD);
    };
    EXPECT_NEAR(jerk(1.0), u[n + 2] - 3 * u[n + 1] + 3 * u[n] - u[n - 1], 100 * kTol);
    EXPECT_NEAR(acceleration(1.0), acceleration(-1.0), kTol);
    EXPECT_NEAR(acceleration(1.0), u[n + 1] - 2 * u[n] + u[n - 1], kTol);
    EXPECT_NEAR(velocity(1.0), velocity(-1.0), kTol);
    EXPECT_NEAR(velocity(1.0), 0.5 * (u[n + 1] - u[n - 1]), kTol);
    EXPECT_NEAR(y(x - 1e-12), y(x), kTol);
  }
}

// The spline has sinc^4 f of a frequency f (per row) that its rows have; the rest are images at f
// plus whole numbers.
TEST(PathOffset, HasTheFourthPowerOfASincOfAFrequency) {
  constexpr int kPeriods = 10;
  constexpr int kSteps = 64;  // within a row
  for (const double f : {0.05, 0.125, 0.25, 0.5}) {
    const double w = 2.0 * std::numbers::pi * f;
    const int rows = static_cast<int>(std::lround(kPeriods / f));
    const PathOffset offset =
        offset_of(rows_of([&](double x) { return std::cos(w * (x - 2.0)); }, rows + 5));
    std::complex<double> sum = 0.0;
    for (int k = 0; k < rows * kSteps; ++k) {
      const double x = 2.0 + static_cast<double>(k) / kSteps;
      sum += offset.at(x)[1] * std::polar(1.0, -w * (x - 2.0));
    }
    const double sinc = std::sin(0.5 * w) / (0.5 * w);
    // at half the rate of the rows the image at -f falls on f
    const double expected = std::pow(sinc, 4) * (f == 0.5 ? 2.0 : 1.0);
    EXPECT_NEAR(std::abs(2.0 * sum / static_cast<double>(rows * kSteps)), expected, 1e-6) << f;
    EXPECT_NEAR(std::arg(sum), 0.0, 1e-6) << f;
  }
}

TEST(PathOffset, HoldsItsEndsBeyondThem) {
  const std::vector<double> u = {5.0, 5.0, 1.0, 2.0, 7.0, 7.0};
  for (const std::size_t every : {1U, 3U}) {
    const PathOffset offset = offset_of(u, every);
    const auto last = static_cast<double>(5 * every);
    for (const double beyond : {0.0, 0.5, 3.0, 1e6}) {
      EXPECT_NEAR(offset.at(-beyond)[1], 5.0, kRounding);
      EXPECT_NEAR(offset.at(last + beyond)[1], 7.0, kRounding);
    }
  }
  const PathOffset single = offset_of({4.0});
  for (const double n : {-1.0, 0.0, 2.5}) EXPECT_NEAR(single.at(n)[1], 4.0, kRounding);
}

TEST(PathOffset, OfEverySoManyInstantsIsThatOfItsRows) {
  const std::vector<double> u = random_rows(2);
  const PathOffset dense = offset_of(u), sparse = offset_of(u, 4);
  for (double row = 0.0; row < 20.0; row += 0.1) {
    EXPECT_NEAR(sparse.at(4.0 * row)[1], dense.at(row)[1], 10.0 * kRounding) << row;
  }
}

TEST(PathOffset, AtAPlaceIsThatOfTheInstantThere) {
  const std::vector<double> u = random_rows(3);
  for (const std::size_t every : {1U, 4U}) {
    const PathOffset offset = offset_of(u, every);
    const auto& s = offset.times->s;
    for (std::size_t n = 0; n < s.size(); ++n) {
      EXPECT_NEAR(offset.at_place(s[n])[1], offset.at(static_cast<double>(n))[1], kRounding) << n;
      if (n + 1 == s.size()) break;
      const double between = s[n] + 0.3 * (s[n + 1] - s[n]);
      EXPECT_NEAR(offset.at_place(between)[1], offset.at(static_cast<double>(n) + 0.3)[1],
                  10.0 * kRounding)
          << n;
    }
    EXPECT_EQ(offset.at_place(-1.0)[1], offset.at(0.0)[1]);
    EXPECT_EQ(offset.at_place(1.0)[1], offset.at(1e9)[1]);
  }
}

// Offset of Y of 5 um that swings at 7 Hz.
std::vector<Joints> swinging(const PathTimes& times) {
  std::vector<Joints> out(times.rows(), Joints::Zero());
  for (std::size_t n = 0; n < out.size(); ++n) {
    const double t = static_cast<double>(n) * times.row_period();
    out[n][1] = 5 * um * std::sin(2.0 * std::numbers::pi * 7.0 * t);
  }
  return out;
}

TEST(RestAtStandstills, HoldsTheMeanWhereThePathStands) {
  for (const std::size_t every : {1U, 4U}) {
    const TwoMoves motion(kFeed, 0.1);
    PathTimes times = times_of(motion, 0.05);
    times.every = every;
    const std::vector<Joints> before = swinging(times);
    std::vector<Joints> after = before;
    rest_at_standstills(times, after);
    const auto first =
        static_cast<std::size_t>(std::ceil(motion.move.duration() / times.row_period()));
    const auto last = static_cast<std::size_t>(motion.departure() / times.row_period());
    double mean = 0.0;
    for (std::size_t n = first; n <= last; ++n) mean += before[n][1];
    mean /= static_cast<double>(last - first + 1);
    for (std::size_t n = first; n <= last; ++n) EXPECT_NEAR(after[n][1], mean, 1e-9 * um) << n;
    for (std::size_t n = 0; n < after.size(); ++n) EXPECT_EQ(after[n][0], 0.0);
  }
}

TEST(RestAtStandstills, ChangesNothingElsewhereAndGoesOnSmoothly) {
  const TwoMoves motion(kFeed, 0.1);
  const PathTimes times = times_of(motion, 0.0);
  const std::vector<Joints> before = swinging(times);
  std::vector<Joints> after = before;
  rest_at_standstills(times, after);
  double sharpest = 0.0, elsewhere = 0.0;
  int same = 0;
  for (std::size_t n = 1; n + 1 < after.size(); ++n) {
    const double t = static_cast<double>(n) * kH;
    const auto second = [&](const std::vector<Joints>& u) {
      return std::abs(u[n + 1][1] - 2.0 * u[n][1] + u[n - 1][1]) / (kH * kH);
    };
    sharpest = std::max(sharpest, second(after));
    elsewhere = std::max(elsewhere, second(before));
    const bool is_near = t > motion.move.duration() - 0.031 && t < motion.departure() + 0.031;
    if (is_near || t > motion.duration() - 0.031) continue;
    EXPECT_EQ(after[n], before[n]) << n;
    ++same;
  }
  EXPECT_GT(same, 1000);
  // a change of 10 um within 30 ms, 10 x^3 - 15 x^4 + 6 x^5: 5.77 of 10 um / (30 ms)^2
  EXPECT_LE(sharpest, 5.8 * 10 * um / (0.03 * 0.03) + 2.0 * elsewhere);
}

TEST(RestAtStandstills, LeavesAConstantAndAPathThatGoesOn) {
  PathTimes times = times_of(TwoMoves(kFeed, 0.1));
  std::vector<Joints> constant(times.rows(), Joints::Constant(3 * um));
  rest_at_standstills(times, constant);
  for (const Joints& one : constant) {
    EXPECT_NEAR((one - Joints::Constant(3 * um)).norm(), 0.0, 1e-9 * um);
  }
  for (std::size_t n = 0; n < times.s.size(); ++n) times.s[n] = static_cast<double>(n) * um;
  const std::vector<Joints> before = swinging(times);
  std::vector<Joints> after = before;
  rest_at_standstills(times, after);
  EXPECT_EQ(after, before);
}

// A program has one offset for each place: at_place() depends on it.
TEST(RestAtStandstills, MakesTheOffsetOfAPlaceThatOfEveryInstantThere) {
  const TwoMoves motion(kFeed, 0.1);
  const auto times = std::make_shared<const PathTimes>(times_of(motion));
  PathOffset offset{times, swinging(*times)};
  rest_at_standstills(*times, offset.offset);
  const auto first = static_cast<std::size_t>(std::ceil(motion.move.duration() / kH));
  const auto last = static_cast<std::size_t>(motion.departure() / kH);
  for (std::size_t n = first + 1; n < last; ++n) {
    EXPECT_NEAR(offset.at(static_cast<double>(n))[1], offset.at_place(kL)[1], 0.01 * um) << n;
  }
}

TEST(PathOffsetPart, EntersBehindTheFilterAndBeginsDisplaced) {
  const auto offset = std::make_shared<const PathOffset>(offset_of({4 * um, 4 * um, 4 * um, 0.0}));
  const auto part = path_offset_part(offset);
  EXPECT_EQ(part->entry().entry, EntryPoint::feed_forward);
  EXPECT_EQ(part->entry().time_constant, 0.0);
  EXPECT_EQ(part->entry().dead_time, 0.0);
  for (const double q : {0.0, 0.1}) {
    EXPECT_EQ(part->offset(Joints::Constant(q)), offset->offset.front());
  }
  EXPECT_EQ(part->failure(), "");
}

TEST(PathOffsetPart, FollowsThePlaceOfTheRunWithAStateOfItsOwn) {
  const TwoMoves motion(kFeed, 0.05);
  const auto times = std::make_shared<const PathTimes>(times_of(motion));
  const auto offset = std::make_shared<const PathOffset>(PathOffset{times, swinging(*times)});
  const auto same = path_offset_part(offset), slower = path_offset_part(offset);
  PathPlace place(*times);
  const TwoMoves slow(0.5 * kFeed, 0.02);
  for (int n = 0; n * kH < slow.duration(); ++n) {
    Reading now;
    now.t = n * kH;
    now.s = motion.at(now.t);
    now.Q_ref.setConstant(0.3);
    EXPECT_LE((same->advance(now) - offset->at(n)).norm(), 1e-6 * um) << n;
    now.s = slow.at(now.t);
    EXPECT_EQ(slower->advance(now), offset->at(place.advance(now.t, now.s))) << n;
  }
}

}  // namespace
}  // namespace servomill::strategies::path_offset_test
