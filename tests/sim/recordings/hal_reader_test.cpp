#include "sim/recordings/hal_reader.h"

#include <gtest/gtest.h>

#include "tests/text.h"

namespace servomill::sim::recordings::hal_reader_test {
namespace {

using Values = std::vector<double>;

// As halscope writes it: a blank behind every value, an empty line in front of the rows, no line
// end behind the last one.
const std::string kScope =
    "Sampling period is 1000000 nSec \n\njoint.0.f-error +0.50000000000000 pid.x.out "
    "-1.00000000000000 \njoint.0.f-error +0.25000000000000 pid.x.out +2.00000000000000 ";

std::string scope_refusal(const std::string& text) {
  try {
    parse_halscope(text, "a.log");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string sampler_refusal(const std::string& text) {
  try {
    parse_halsampler(text, "a.txt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Halscope, PinsOverTheSamplingPeriod) {
  const Recording recording = parse_halscope(kScope, "a.log");
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].name, "joint.0.f-error");
  EXPECT_EQ(recording.channels[0].samples, (Values{0.5, 0.25}));
  EXPECT_EQ(recording.channels[1].name, "pid.x.out");
  EXPECT_EQ(recording.channels[1].samples, (Values{-1.0, 2.0}));
  EXPECT_EQ(recording.bases[0].unit, "s");
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 0.001}));
}

TEST(Halscope, DecimalCommaAndOtherUnit) {
  const Recording recording =
      parse_halscope("Sampling period is 500000 ns\nx +1,5 \nx -2,25 \n", "a.log");
  EXPECT_EQ(recording.channels[0].samples, (Values{1.5, -2.25}));
  EXPECT_EQ(recording.bases[0].values, (Values{0.0, 0.0005}));
}

TEST(Halscope, BadInput) {
  const std::string head = "Sampling period is 1000 nSec\n";
  EXPECT_EQ(scope_refusal("Sampling period is 1000"),
            "a.log:1: error: the sampling period is truncated");
  EXPECT_EQ(scope_refusal("Sampling period is 0 nSec\nx 1\n"),
            "a.log:1:20: error: the sampling period must be > 0");
  EXPECT_EQ(scope_refusal("Sampling period is 9 mm\nx 1\n"),
            "a.log:1:22: error: 'mm' is not a unit of time; known are s, ms, us, ns, min and h");
  EXPECT_EQ(scope_refusal(head), "a.log: error: contains no channel");
  EXPECT_EQ(scope_refusal(head + "x\n"), "a.log:2: error: a pin without its value");
  EXPECT_EQ(scope_refusal(head + "x 1 y 2\nx 1\nx 1 y 2\n"),
            "a.log:3: error: 2 fields in a line, the first one has 4");
  EXPECT_EQ(scope_refusal(head + "x 1 y 2\nx 1 y"),
            "a.log:3: error: 3 fields in a line, the first one has 4, and the file ends here: it "
            "is truncated");
  EXPECT_EQ(scope_refusal(head + "x 1\ny 1\n"), "a.log:3:1: error: pin 'y' in place of 'x'");
  EXPECT_EQ(scope_refusal(head + "x 1\nx on\n"), "a.log:3:3: error: 'on' is not a number");
  EXPECT_EQ(scope_refusal(head + "x 1\nx inf\n"), "a.log:3:3: error: 'inf' is infinite");
  EXPECT_EQ(scope_refusal(head + "x 1 x 2\n"),
            "a.log: error: channels 1 and 2 are both called 'x'");
}

TEST(Halsampler, SampleNumbersAreTheBase) {
  EXPECT_TRUE(is_halsampler("7 0.5 1\n8 0.25 0\n"));
  const Recording recording = parse_halsampler("7 0.5 1\n8 0.25 0\noverrun\n11 0.1 1\n", "a.txt");
  EXPECT_EQ(recording.bases[0].unit, "1");
  EXPECT_EQ(recording.bases[0].values, (Values{7, 8, 11}));
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].name, "column 2");
  EXPECT_EQ(recording.channels[0].samples, (Values{0.5, 0.25, 0.1}));
  EXPECT_EQ(recording.notes, std::vector<std::string>{"1 overrun: samples were lost"});
}

TEST(Halsampler, TablesWithHeadingsAndPlainColumnsAreOthers) {
  EXPECT_FALSE(is_halsampler("t x\n0 1\n1 2\n"));
  EXPECT_FALSE(is_halsampler("0.5 1\n0.25 2\n"));
  EXPECT_FALSE(is_halsampler("0;1\n1;2\n"));
}

TEST(Halsampler, BadInput) {
  EXPECT_EQ(sampler_refusal("0 1\n1 2\n1 3\n"),
            "a.txt:3: error: sample number 1 after 1; must increase");
  EXPECT_EQ(sampler_refusal("0 1\n1 2\n2\n3 4\n5 6\n"),
            "a.txt:3: error: 1 field in a line, the "
            "first one has 2");
  EXPECT_EQ(sampler_refusal("0.5 1\noverrun\n0.25 2\n"),
            "a.txt:2: error: samples were lost here, and rows without sample numbers do not say "
            "how many: record with halsampler -t");
  EXPECT_EQ(sampler_refusal("0 1\n1 2\n2 on\n"), "a.txt:3:3: error: 'on' is not a number");
}

}  // namespace
}  // namespace servomill::sim::recordings::hal_reader_test
