#include "plant/vocabulary/sine_and_cosine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <numbers>

namespace servomill::sine_and_cosine_test {
namespace {

using Two [[gnu::vector_size(16)]] = double;

constexpr int kAngles = 200000;
// One unit in the last place of 1. Half of it are two roundings of the angle less its multiple of
// pi/2, a quarter that of the result, the rest what is rounded in the series.
constexpr double kUnit = 0x1p-52;
// Near their zeros sine and cosine are as small as what is left of the angle, all of whose bits
// count.
constexpr double kRelative = 0x1p-51;

template <class F>
void for_angles(double largest, F f) {
  boost::random::mt19937 random(7);
  boost::random::uniform_real_distribution<double> angle(-largest, largest);
  for (int n = 0; n < kAngles; ++n) f(angle(random));
}

// The largest error of either.
double error_at(double x) {
  const auto [sine, cosine] = sine_and_cosine(x);
  const long double s = std::sin(static_cast<long double>(x)),
                    c = std::cos(static_cast<long double>(x));
  return static_cast<double>(std::max(std::abs(sine - s), std::abs(cosine - c)));
}

TEST(SineAndCosine, AreWithinAUnitInTheLastPlaceOfOne) {
  for (const double largest : {0.8, 7.0, 1e3, 1e5, kLargestAngle}) {
    double worst = 0.0;
    for_angles(largest, [&](double x) { worst = std::max(worst, error_at(x)); });
    EXPECT_LT(worst, kUnit) << largest;
  }
}

TEST(SineAndCosine, KeepTheirBitsNearMultiplesOfAQuarterTurn) {
  for (int n = -600000; n <= 600000; n += n > -1000 && n < 1000 ? 1 : 997) {
    const double x = n * (std::numbers::pi / 2.0);
    const auto [sine, cosine] = sine_and_cosine(x);
    const bool is_odd = n % 2 != 0;
    const double small = is_odd ? cosine : sine, large = is_odd ? sine : cosine;
    const long double exact =
        is_odd ? std::cos(static_cast<long double>(x)) : std::sin(static_cast<long double>(x));
    EXPECT_LE(std::abs(small - exact), kRelative * std::abs(exact)) << n;
    EXPECT_EQ(std::abs(large), 1.0) << n;
    EXPECT_LT(error_at(x), kUnit) << n;
  }
}

TEST(SineAndCosine, AreExactAtZero) {
  EXPECT_EQ(sine_and_cosine(0.0).sine, 0.0);
  EXPECT_EQ(sine_and_cosine(0.0).cosine, 1.0);
  EXPECT_EQ(sine_and_cosine(1e-300).sine, 1e-300);
}

TEST(SineAndCosine, AreOddAndEvenInEveryBit) {
  for_angles(1e3, [](double x) {
    const auto plus = sine_and_cosine(x), minus = sine_and_cosine(-x);
    ASSERT_EQ(plus.sine, -minus.sine) << x;
    ASSERT_EQ(plus.cosine, minus.cosine) << x;
  });
}

TEST(SineAndCosine, OfLanesHaveTheBitsOfNumbers) {
  for_angles(1e5, [](double x) {
    const auto lanes = sine_and_cosine(Two{x, 0.7 * x});
    for (int n = 0; n < 2; ++n) {
      const auto one = sine_and_cosine(n == 0 ? x : 0.7 * x);
      ASSERT_EQ(lanes.sine[n], one.sine) << x;
      ASSERT_EQ(lanes.cosine[n], one.cosine) << x;
    }
  });
}

TEST(SineAndCosine, AreThoseOfTheLibraryFromTheLargestAngleOn) {
  EXPECT_FALSE(is_large(std::nextafter(kLargestAngle, 0.0)));
  EXPECT_TRUE(is_large(kLargestAngle));
  EXPECT_TRUE(is_large(-kLargestAngle));
  EXPECT_TRUE(is_large(std::nan("")));
  EXPECT_EQ(large_sine_and_cosine(1e9).sine, std::sin(1e9));
  EXPECT_EQ(large_sine_and_cosine(1e9).cosine, std::cos(1e9));
}

}  // namespace
}  // namespace servomill::sine_and_cosine_test
