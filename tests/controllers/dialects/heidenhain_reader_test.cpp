// The reader of Heidenhain programs against examples worked out by hand.
#include "controllers/dialects/heidenhain_reader.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "heidenhain_examples.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::heidenhain_reader_test {
namespace {

std::string actions_of(const HeidenhainExample& example, bool has_frame,
                       const HeidenhainRules& rules = {}) {
  const std::string program = has_frame ? heidenhain_program(example.program) : example.program;
  return describe(read_heidenhain(program, "t.h", example.setup, example.settings, rules),
                  has_frame ? kFrameLines : 0);
}

struct NamedExample {
  HeidenhainExample example;
  bool has_frame = true;
};

std::vector<NamedExample> all_examples() {
  std::vector<NamedExample> all;
  for (const auto& e : heidenhain_line_examples()) all.push_back({e, true});
  for (const auto& e : heidenhain_circle_examples()) all.push_back({e, true});
  for (const auto& e : heidenhain_cycle_examples()) all.push_back({e, true});
  for (const auto& e : heidenhain_whole_examples()) all.push_back({e, false});
  return all;
}

TEST(HeidenhainReader, ReadsEveryExampleAsWorkedOutByHand) {
  const auto all = all_examples();
  EXPECT_GE(all.size(), 30u);
  for (const auto& [example, has_frame] : all) {
    SCOPED_TRACE(example.name);
    try {
      EXPECT_EQ(actions_of(example, has_frame), example.actions);
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

bool is_noticed(const HeidenhainRules& rules) {
  for (const auto& [example, has_frame] : all_examples()) {
    try {
      if (actions_of(example, has_frame, rules) != example.actions) return true;
    } catch (const InputError&) {
      return true;
    }
  }
  return false;
}

struct NamedRule {
  const char* name;
  bool HeidenhainRules::*rule;
};

#define RULE(name) \
  { #name, &HeidenhainRules::name }
constexpr NamedRule kRules[] = {RULE(fmax_acts_in_its_block_only),
                                RULE(f_is_modal),
                                RULE(f_is_in_tenths_of_inch),
                                RULE(ft_is_in_seconds),
                                RULE(increments_start_at_position),
                                RULE(m91_counts_from_machine_datum),
                                RULE(m91_drops_tool_length),
                                RULE(m91_acts_in_its_block_only),
                                RULE(m3_acts_at_block_start),
                                RULE(m5_acts_at_block_end),
                                RULE(m13_switches_coolant),
                                RULE(tool_call_forgets_positions),
                                RULE(probe_returns),
                                RULE(tool_call_changes_length),
                                RULE(delta_length_adds),
                                RULE(stop_forgets_positions),
                                RULE(stop_switches_off),
                                RULE(dr_plus_is_counter_clockwise),
                                RULE(equal_ends_make_full_circle),
                                RULE(cc_alone_takes_position),
                                RULE(increments_of_cc_start_at_position),
                                RULE(ipa_counts_revolutions),
                                RULE(zx_angle_starts_at_z),
                                RULE(shift_adds),
                                RULE(shift_replaces_shift),
                                RULE(rotation_is_counter_clockwise),
                                RULE(mirror_reverses_arcs),
                                RULE(preset_changes_offset),
                                RULE(dwell_is_in_seconds),
                                RULE(m126_takes_shorter_path),
                                RULE(unknown_is_refused)};
#undef RULE

TEST(HeidenhainReader, ExamplesNoticeEveryWrongRule) {
  EXPECT_FALSE(is_noticed({}));
  EXPECT_EQ(std::size(kRules), sizeof(HeidenhainRules)) << "every rule is in the list";
  for (const NamedRule& rule : kRules) {
    HeidenhainRules rules;
    rules.*(rule.rule) = false;
    EXPECT_TRUE(is_noticed(rules)) << rule.name;
  }
}

// Each setting is changed by itself, so that none hides what another does.
TEST(HeidenhainReader, SettingsDifferInOneEach) {
  const auto all = all_heidenhain_settings(true);
  ASSERT_EQ(all.size(), 10u);
  EXPECT_EQ(to_string(all[0]), "usual settings");
  EXPECT_EQ(to_string(all[3]), "rotary display below 360 deg, MP7682 bit 2");
  EXPECT_EQ(to_string(all[8]), "M6 does not halt");
  for (const auto& settings : all) EXPECT_TRUE(settings.has_tilting);
  EXPECT_TRUE(all.front().is_rapid_straight);
  EXPECT_FALSE(all.back().is_rapid_straight);
  EXPECT_TRUE(all.back().is_shorter_path_usual);
  EXPECT_FALSE(all_heidenhain_settings(false).front().has_tilting);
}

// A program means the same under all settings, or verification must notice a difference.
TEST(HeidenhainReader, SettingsMatterWhereTheyAct) {
  const auto meanings = [](const std::string& lines) {
    std::vector<std::string> kinds;
    for (const auto& settings : all_heidenhain_settings(false)) {
      const auto text = describe(
          read_heidenhain(heidenhain_program(lines), "t.h", heidenhain_example_setup(), settings),
          kFrameLines);
      if (std::find(kinds.begin(), kinds.end(), text) == kinds.end()) kinds.push_back(text);
    }
    return kinds.size();
  };
  EXPECT_EQ(meanings("L X+1 F100 M3\n"), 1u);
  EXPECT_EQ(meanings("L X+1 FMAX\n"), 2u);
  EXPECT_EQ(meanings("L X+1 F100 M1\n"), 2u);
  EXPECT_EQ(meanings("L X+1 F100\nL M136\nL X+2 F1\n"), 2u);
}

}  // namespace
}  // namespace servomill::controllers::heidenhain_reader_test
