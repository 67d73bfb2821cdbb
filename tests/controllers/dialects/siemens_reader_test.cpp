#include "controllers/dialects/siemens_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "plant/vocabulary/input_error.h"
#include "tests/controllers/dialects/siemens_examples.h"

namespace servomill::controllers::siemens_reader_test {
namespace {

TEST(SiemensReader, ReadsEveryExampleForEverySettingAsWorkedOut) {
  EXPECT_GE(siemens_examples().size(), 30U);
  std::set<std::string> names;
  for (const SiemensExample& example : siemens_examples()) {
    EXPECT_TRUE(names.insert(example.name).second) << example.name;
    int read = 0;
    for (const SiemensSettings& settings : siemens_example_settings()) {
      if (!example.applies(settings)) continue;
      ++read;
      EXPECT_EQ(siemens_actions(example, settings), example.expected)
          << example.name << " with " << to_string(settings);
    }
    EXPECT_GT(read, 0) << example.name;
  }
}

TEST(SiemensReader, HasASettingForEveryCombination) {
  std::set<std::string> seen;
  for (const SiemensSettings& s : siemens_example_settings()) {
    seen.insert(to_string(s));
  }
  EXPECT_EQ(seen.size(), 34U);
  EXPECT_EQ(siemens_example_settings().size(), 34U);
  EXPECT_EQ(all_siemens_settings().size(), 32U);
}

struct WrongRule {
  const char* name;
  bool SiemensRules::*rule;
};

constexpr WrongRule kWrongRules[] = {
    {"length_is_added", &SiemensRules::length_is_added},
    {"D_acts_in_its_block", &SiemensRules::D_acts_in_its_block},
    {"length_needs_a_line", &SiemensRules::length_needs_a_line},
    {"SUPA_suppresses_offset", &SiemensRules::SUPA_suppresses_offset},
    {"SUPA_ends_with_its_block", &SiemensRules::SUPA_ends_with_its_block},
    {"increment_needs_same_offset", &SiemensRules::increment_needs_same_offset},
    {"IC_ends_with_its_block", &SiemensRules::IC_ends_with_its_block},
    {"centre_counts_from_start", &SiemensRules::centre_counts_from_start},
    {"G2_is_clockwise", &SiemensRules::G2_is_clockwise},
    {"G18_is_ZX", &SiemensRules::G18_is_ZX},
    {"negative_CR_is_long", &SiemensRules::negative_CR_is_long},
    {"TURN_adds_turns", &SiemensRules::TURN_adds_turns},
    {"CIP_passes_its_point", &SiemensRules::CIP_passes_its_point},
    {"CIP_point_is_absolute", &SiemensRules::CIP_point_is_absolute},
    {"equal_ends_are_full_circle", &SiemensRules::equal_ends_are_full_circle},
    {"G71_leaves_F", &SiemensRules::G71_leaves_F},
    {"F_ends_with_its_kind", &SiemensRules::F_ends_with_its_kind},
    {"F_of_G4_is_time", &SiemensRules::F_of_G4_is_time},
    {"G60_rapid_may_bend", &SiemensRules::G60_rapid_may_bend},
    {"G9_ends_with_its_block", &SiemensRules::G9_ends_with_its_block},
    {"MEAS_forgets_positions", &SiemensRules::MEAS_forgets_positions},
    {"ADIS_is_of_G641", &SiemensRules::ADIS_is_of_G641},
    {"stop_acts_after_motion", &SiemensRules::stop_acts_after_motion},
    {"stop_forgets_positions", &SiemensRules::stop_forgets_positions},
    {"macro_forgets_state", &SiemensRules::macro_forgets_state},
    {"offset_rotates", &SiemensRules::offset_rotates},
    {"AC_is_not_shortest", &SiemensRules::AC_is_not_shortest},
};
static_assert(sizeof(SiemensRules) == std::size(kWrongRules) * sizeof(bool));

std::vector<std::string> examples_that_find(bool SiemensRules::*rule) {
  SiemensRules wrong;
  wrong.*rule = false;
  std::vector<std::string> found;
  for (const SiemensExample& example : siemens_examples()) {
    for (const SiemensSettings& settings : siemens_example_settings()) {
      if (!example.applies(settings)) continue;
      if (siemens_actions(example, settings, wrong) == example.expected) continue;
      found.push_back(example.name);
      break;
    }
  }
  return found;
}

TEST(SiemensReader, EveryWrongRuleIsFoundByAnExample) {
  for (const WrongRule& wrong : kWrongRules) {
    const std::vector<std::string> found = examples_that_find(wrong.rule);
    EXPECT_FALSE(found.empty()) << wrong.name;
    EXPECT_LT(found.size(), siemens_examples().size()) << wrong.name;
  }
}

// The safe frame of every program, with the head that rule 1 of unknown modes asks for.
TEST(SiemensReader, TheSafeFrameMeansTheSameForAllSettings) {
  const SiemensExample frame{
      "",
      "SUPA G0 Z=-5 D0\nT1 M6\nG17 G40 G90 G94 G710 G54\nTRANS\nS1000 M3\nG0 X10 Y10\nG0 Z5 "
      "D1\nM8\n"
      "G1 Z-1 F200\nG1 X50\nM9\nSUPA G0 Z=-5 D0\nM5",
      {"3 rapid Z-5 machine", "4 tool 1", "7 spindle +1000", "8 rapid X110 Y210 ~",
       "9 rapid (X110) (Y210) Z355 H1", "10 coolant 2", "11 feed (X110) (Y210) Z349 F200 H1",
       "12 feed X150 (Y210) (Z349) F200 H1", "13 coolant 0", "14 rapid (X150) (Y210) Z-5 machine",
       "15 spindle off 0"}};
  for (const SiemensSettings& settings : siemens_example_settings()) {
    if (!settings.M6_is_macro) continue;
    EXPECT_EQ(siemens_actions(frame, settings), frame.expected);
  }
  SiemensExample known = frame;  // without a macro Z is still known after the change
  known.expected[1] = "4 tool 1 (Z-5)";
  known.expected[3] = "8 rapid X110 Y210 (Z-5) ~";
  for (const SiemensSettings& settings : siemens_example_settings()) {
    if (settings.M6_is_macro) continue;
    EXPECT_EQ(siemens_actions(known, settings), known.expected);
  }
}

TEST(SiemensReader, TheSwitchForSkippedBlocksLeavesThemOut) {
  ControlSetup setup = siemens_example_setup();
  setup.skips_blocks = true;
  const auto actions = read_siemens("/G1 X1\n/T1 M6\nM30", "p.mpf", setup, {});
  ASSERT_EQ(actions.size(), 1U);
  EXPECT_EQ(actions[0].kind, ActionKind::end);
  EXPECT_EQ(actions[0].line, 3);
}

TEST(SiemensReader, MotionsCarryToolAndLength) {
  ControlSetup setup = siemens_example_setup();
  setup.start[0] = 0.001;
  const auto actions = read_siemens(
      "G710 G17 G40 G90 G94 G54\nTRANS\nT1 M6\nG17 G40 G90 G94 G54\nG0 X1 D0\nZ1 D1\nM30", "p.mpf",
      setup, {.M6_is_macro = false});
  ASSERT_EQ(actions.size(), 4U);
  EXPECT_EQ(actions[0].end[0], 0.001);  // the start is known
  EXPECT_EQ(actions[1].tool, 1);
  EXPECT_EQ(actions[1].tool_offset, 0);
  EXPECT_EQ(actions[2].tool_offset, 1);
}

}  // namespace
}  // namespace servomill::controllers::siemens_reader_test
