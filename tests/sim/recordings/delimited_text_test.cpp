#include "sim/recordings/delimited_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace servomill::sim::recordings::delimited_text_test {
namespace {

TEST(TextLines, KeepTheirNumbers) {
  const auto lines = text_lines("a\r\nb\n\n  \nc\nd");
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0].text, "a");
  EXPECT_EQ(lines[1].text, "b");
  EXPECT_EQ(lines[1].number, 2);
  EXPECT_EQ(lines[2].number, 5);
  EXPECT_EQ(lines[3].number, 6);
}

TEST(Fields, QuotesKeepASeparatorAndBlanksAreTaken) {
  const auto fields = split_fields("  1.5 ;\"a;b\"; ", ';');
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_EQ(fields[0].text, "1.5");
  EXPECT_EQ(fields[0].column, 3);
  EXPECT_EQ(fields[1].text, "a;b");
  EXPECT_EQ(fields[2].text, "");
}

TEST(Fields, AnyNumberOfBlanksIsOneSeparator) {
  const auto fields = split_fields(" 1 \t 2   3 ", ' ');
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_EQ(fields[2].text, "3");
  EXPECT_EQ(fields[2].column, 10);
}

TEST(Numbers, HaveOneDecimalSign) {
  EXPECT_EQ(parse_number("1.5", '.'), 1.5);
  EXPECT_EQ(parse_number("+1,5e3", ','), 1500.0);
  EXPECT_FALSE(parse_number("1,5", '.'));
  EXPECT_FALSE(parse_number("1.5", ','));
  EXPECT_FALSE(parse_number("1.5mm", '.'));
  EXPECT_FALSE(parse_number("+-1", '.'));
  EXPECT_FALSE(parse_number("-", '.'));
}

TEST(Numbers, MissingOnesAreNaNAndTooLargeOnesInfinite) {
  EXPECT_TRUE(std::isnan(parse_number("", '.').value()));
  EXPECT_TRUE(std::isnan(parse_number("NaN", ',').value()));
  EXPECT_TRUE(std::isinf(parse_number("1e999", '.').value()));
  EXPECT_EQ(parse_number("1e-999", '.'), 0.0);
}

TEST(Texts, OfLatin1BecomeUtf8) {
  EXPECT_EQ(as_utf8("\xB5m"), "\u00B5m");
  EXPECT_EQ(as_utf8("\u00B5m"), "\u00B5m");
}

TEST(Headings, NameAndUnit) {
  EXPECT_EQ(parse_heading(" s actual X [mm]").name, "s actual X");
  EXPECT_EQ(parse_heading(" s actual X [mm]").unit, "mm");
  EXPECT_EQ(parse_heading("current (A)").unit, "A");
  EXPECT_EQ(parse_heading("[A]").name, "[A]");
  EXPECT_EQ(parse_heading("plain").unit, "");
}

TEST(Headings, NamesMayEndWithTheirUnit) {
  EXPECT_EQ(heading_with_suffix({"time_ms", ""}).name, "time");
  EXPECT_EQ(heading_with_suffix({"t_s", ""}).unit, "s");
  EXPECT_EQ(heading_with_suffix({"X_mm", ""}).name, "X_mm");
  EXPECT_EQ(heading_with_suffix({"X_mm", ""}).unit, "mm");
  EXPECT_EQ(heading_with_suffix({"v_X_mm_per_s2", ""}).unit, "mm/s^2");
  EXPECT_EQ(heading_with_suffix({"joint_A", ""}).unit, "");
  EXPECT_EQ(heading_with_suffix({"_mm", ""}).unit, "");
  EXPECT_EQ(heading_with_suffix({"X_mm", "inch"}).unit, "inch");
  EXPECT_EQ(name_without_unit("X_mm"), "X");
  EXPECT_EQ(name_without_unit("joint_A"), "joint_A");
}

TEST(Units, OfTimeInSeconds) {
  EXPECT_EQ(seconds_of("us"), 1e-6);
  EXPECT_EQ(seconds_of(as_utf8("\xB5s")), 1e-6);
  EXPECT_FALSE(seconds_of("mm"));
}

}  // namespace
}  // namespace servomill::sim::recordings::delimited_text_test
