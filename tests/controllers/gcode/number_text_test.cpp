#include "controllers/gcode/number_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <limits>
#include <string>

namespace servomill::controllers {
namespace {

// As a library for exact decimals prints it, without zeros at the end.
std::string exact_text(double x, int decimals) {
  std::string text = fmt::format("{:.{}f}", x, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

TEST(FixedText, HasNoZerosBehindTheLastDigit) {
  EXPECT_EQ(fixed_text(10.5, 3), "10.5");
  EXPECT_EQ(fixed_text(100.0, 3), "100");
  EXPECT_EQ(fixed_text(-0.05, 2), "-0.05");
  EXPECT_EQ(fixed_text(-0.0004, 3), "0");
  EXPECT_EQ(fixed_text(0.0, 5), "0");
  EXPECT_EQ(fixed_text(1250.0, 0), "1250");
  EXPECT_EQ(fixed_text(9.9996, 3), "10");
}

// A tie of decimals is none of doubles but where it has few digits; those go to the even digit.
TEST(FixedText, RoundsTheDoubleItselfWhereItLiesNearATie) {
  EXPECT_EQ(fixed_text(0.125, 2), "0.12");
  EXPECT_EQ(fixed_text(0.375, 2), "0.38");
  EXPECT_EQ(fixed_text(1.005, 2), "1");     // the double is below
  EXPECT_EQ(fixed_text(1.115, 2), "1.11");  // below
  EXPECT_EQ(fixed_text(2.675, 2), "2.67");  // below
  EXPECT_EQ(fixed_text(1.0e15 + 0.5, 0), "1000000000000000");
}

TEST(FixedText, IsTheExactDecimalOfAnyNumber) {
  boost::random::mt19937 random(1);
  const boost::random::uniform_real_distribution<double> magnitude(-12.0, 17.0), sign(-1.0, 1.0);
  const boost::random::uniform_int_distribution<int> any_decimals(0, 14), any_tie(0, 2'000'000);
  for (int n = 0; n < 200'000; ++n) {
    const double x = std::copysign(std::pow(10.0, magnitude(random)), sign(random));
    const int decimals = any_decimals(random);
    ASSERT_EQ(fixed_text(x, decimals), exact_text(x, decimals)) << fmt::format("{}", x);
    const double tie = (any_tie(random) + 0.5) * 1e-6;  // halves of a step of six decimals
    for (const double y : {tie, std::nextafter(tie, 0.0), std::nextafter(tie, 3.0)}) {
      ASSERT_EQ(fixed_text(y, 6), exact_text(y, 6)) << fmt::format("{}", y);
    }
  }
}

TEST(SignificantText, HasTwelveDigits) {
  EXPECT_EQ(significant_text(1.0 / 3.0), "0.333333333333");
  EXPECT_EQ(significant_text(123456789.0123), "123456789.012");
  EXPECT_EQ(significant_text(1e-9), "0.000000001");
  EXPECT_EQ(significant_text(999999999999.9), "1000000000000");
}

}  // namespace
}  // namespace servomill::controllers
