#include "sim/system/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace servomill::sim::system::utf8_test {
namespace {

TEST(Utf8, CountsTheBytesOfACharacter) {
  EXPECT_EQ(utf8_length("a"), 1U);
  EXPECT_EQ(utf8_length(std::string_view("\0", 1)), 1U);
  EXPECT_EQ(utf8_length("\xC3\xA4 and more"), 2U);  // U+00E4
  EXPECT_EQ(utf8_length("\xE2\x82\xAC"), 3U);       // U+20AC
  EXPECT_EQ(utf8_length("\xF4\x8F\xBF\xBF"), 4U);   // U+10FFFF, the last one
}

// RFC 3629, section 4: the syntax of UTF-8 byte sequences.
TEST(Utf8, RefusesAllElse) {
  EXPECT_EQ(utf8_length("\x80"), 0U) << "continuation byte first";
  EXPECT_EQ(utf8_length("\xE4hr"), 0U) << "Latin-1";
  EXPECT_EQ(utf8_length("\xC3"), 0U) << "cut short";
  EXPECT_EQ(utf8_length("\xC0\x80"), 0U) << "NUL in two bytes";
  EXPECT_EQ(utf8_length("\xE0\x9F\xBF"), 0U) << "U+07FF in three bytes";
  EXPECT_EQ(utf8_length("\xF0\x8F\xBF\xBF"), 0U) << "U+FFFF in four bytes";
  EXPECT_EQ(utf8_length("\xED\xA0\x80"), 0U) << "surrogate U+D800";
  EXPECT_EQ(utf8_length("\xF4\x90\x80\x80"), 0U) << "U+110000";
  EXPECT_EQ(utf8_length("\xF5\x80\x80\x80"), 0U) << "no such first byte";
}

TEST(Utf8, FindsTheStartOfACharacter) {
  const std::string text = "a\xE2\x82\xAC";
  EXPECT_EQ(utf8_start(text, 0), 0U);
  EXPECT_EQ(utf8_start(text, 1), 1U);
  EXPECT_EQ(utf8_start(text, 2), 1U);
  EXPECT_EQ(utf8_start(text, 3), 1U);
}

}  // namespace
}  // namespace servomill::sim::system::utf8_test
