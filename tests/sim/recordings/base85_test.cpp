#include "sim/recordings/base85.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

namespace servomill::sim::recordings::base85_test {
namespace {

constexpr std::string_view kDigits =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#$`()*+-/:;=?@[]^_{|}~";

std::string word(std::uint32_t value) {
  std::string out(5, '0');
  for (int i = 4; i >= 0; --i) {
    out[static_cast<std::size_t>(i)] = kDigits[value % 85];
    value /= 85;
  }
  return out;
}

std::string text_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return word(static_cast<std::uint32_t>(bits >> 32)) + word(static_cast<std::uint32_t>(bits));
}

TEST(Base85, RestoresEveryBit) {
  std::string why;
  const std::vector<double> values = {1.0, -2.5e-300, 3.14159, 1e308};
  std::string text;
  for (const double value : values) text += text_of(value) + "\n  ";
  EXPECT_EQ(base85_doubles(text, why), values);
  EXPECT_EQ(why, "");
  // 1.0 is 3FF00000 00000000: a point stands for four bytes of zeros
  EXPECT_EQ(base85_doubles(word(0x3FF00000) + "...", why), (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(why, "");
}

TEST(Base85, RefusesWhatIsNone) {
  std::string why;
  EXPECT_TRUE(base85_doubles("0000", why).empty());
  EXPECT_EQ(why, "ends within a number");
  EXPECT_TRUE(base85_doubles("~~~~~00000", why).empty());
  EXPECT_EQ(why, "five digits of base 85 exceed four bytes");
  EXPECT_TRUE(base85_doubles("0000\"", why).empty());
  EXPECT_EQ(why, "byte 34 is not a base-85 digit");
}

}  // namespace
}  // namespace servomill::sim::recordings::base85_test
