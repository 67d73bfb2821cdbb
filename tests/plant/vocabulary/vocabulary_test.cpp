#include <gtest/gtest.h>

#include <array>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/simd.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::vocabulary_test {
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

TEST(SimdLevel, IsTheBestThatThereIsUnlessNamed) {
  EXPECT_EQ(simd_level_named(""), simd_levels().back());
  EXPECT_EQ(simd_levels().front(), SimdLevel::baseline);
  for (const SimdLevel level : simd_levels()) EXPECT_EQ(simd_level_named(name_of(level)), level);
}

std::string refused_level(std::string_view name) {
  try {
    return std::string("accepted as ").append(name_of(simd_level_named(name)));
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(SimdLevel, RefusesNamesThatAreNone) {
  EXPECT_EQ(refused_level("avx3"),
            "SERVOMILL_SIMD: error: 'avx3' is not a SIMD level; must be one of baseline, avx2, "
            "avx512; did "
            "you mean 'avx2'?");
  EXPECT_EQ(refused_level("AVX-512"),
            "SERVOMILL_SIMD: error: 'AVX-512' is not a SIMD level; must be one of baseline, avx2, "
            "avx512");
}

TEST(SimdLevel, RefusesWhatTheMachineLacks) {
  const auto there = simd_levels();
  if (there.size() == kSimdLevels.size()) GTEST_SKIP() << "this machine has all";
  const std::string first_lacking(name_of(kSimdLevels[there.size()]));
  EXPECT_EQ(refused_level(first_lacking)
                .find("SERVOMILL_SIMD: error: " + first_lacking +
                      " is not supported by this processor or binary; supported are: base"),
            0U);
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
}  // namespace servomill::vocabulary_test
