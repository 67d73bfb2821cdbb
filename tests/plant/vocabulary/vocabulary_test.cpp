#include <gtest/gtest.h>

#include <array>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/ticks.h"

namespace servomill {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"table", "gcode", "feedback", "none"};

TEST(NearestName, FindsATransposedLetter) { EXPECT_EQ(nearest_name("tabel", kNames), "table"); }
TEST(NearestName, FindsAMissingLetter) { EXPECT_EQ(nearest_name("tabl", kNames), "table"); }
TEST(NearestName, FindsTwoWrongLettersInALongWord) {
  EXPECT_EQ(nearest_name("feetback", kNames), "feedback");
  EXPECT_EQ(nearest_name("feetbeck", kNames), "feedback");
}
TEST(NearestName, IsEmptyWhenNothingIsNear) { EXPECT_EQ(nearest_name("harmonic", kNames), ""); }

TEST(InputError, PrintsOneLineAFaultInOrderOfPlace) {
  const InputError error({{{"m.toml", 7, 3}, "second"}, {{"m.toml", 2, 1}, "first"}});
  EXPECT_STREQ(error.what(), "m.toml:2:1: error: first\nm.toml:7:3: error: second");
}
TEST(InputError, LeavesOutWhatIsUnknownOfThePlace) {
  EXPECT_STREQ(InputError({"m.toml"}, "cannot be read").what(), "m.toml: error: cannot be read");
}

TEST(JointLayout, PutsProgramWordsIntoTheMachinesOrder) {
  const JointLayout layout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};
  AxisWords words;
  words << 1, 2, 3, 4, 5, 6;
  Joints Q;
  Q << 1, 2, 3, 5, 6;
  EXPECT_EQ(layout.joints(words), Q);
  words[3] = 0.0;  // the machine has no A
  EXPECT_EQ(layout.words(Q), words);
}

TEST(WholeTicks, AcceptsMultiplesAndRefusesTheRest) {
  EXPECT_EQ(whole_ticks(0.6e-3, 10e-6), 60);
  EXPECT_EQ(whole_ticks(0.0, 10e-6), 0);
  EXPECT_FALSE(whole_ticks(0.605e-4, 10e-6).has_value());
  EXPECT_FALSE(whole_ticks(-1e-3, 10e-6).has_value());
}

}  // namespace
}  // namespace servomill
