// Fanuc programs read by the rules of the manuals, and each rule pinned by an example.
#include "controllers/dialects/fanuc_reader.h"

#include <gtest/gtest.h>

#include <functional>

#include "plant/vocabulary/input_error.h"
#include "tests/controllers/dialects/action_text.h"
#include "tests/controllers/dialects/fanuc_examples.h"

namespace servomill::controllers::fanuc_reader_test {
namespace {

ControlSetup setup_of_examples() {
  ControlSetup setup;
  AxisWords G54, G55;
  G54 << 200.0 * mm, 250.0 * mm, -100.0 * mm, 0.0, 0.0, 0.0;
  G55 << 300.0 * mm, 200.0 * mm, -95.0 * mm, 0.0, 10.0 * deg, 0.0;
  setup.work_offset[0] = G54;
  setup.work_offset[1] = G55;
  setup.tool_length = {{1, 50.0 * mm}, {2, 55.5 * mm}, {3, 120.0 * mm}};
  return setup;
}

std::vector<FanucSettings> example_settings() { return all_fanuc_settings({true, true, true}); }

bool holds(std::string_view conditions, const FanucSettings& settings) {
  const std::string name = to_string(settings) + " ";
  for (std::size_t from = 0; from < conditions.size();) {
    const std::size_t end = std::min(conditions.find(' ', from), conditions.size());
    const std::string one = std::string(conditions.substr(from, end - from)) + " ";
    if (name.find(one) == std::string::npos) return false;
    from = end + 1;
  }
  return true;
}

std::string read(const FanucExample& example, const FanucSettings& settings,
                 const FanucRules& rules = {}) {
  try {
    return text_of(read_fanuc(example.program, "", setup_of_examples(), settings, rules));
  } catch (const InputError& error) {
    const Fault& fault = error.faults().front();
    return fmt::format("error: {}:{}: {}", fault.place.line, fault.place.column, fault.message);
  }
}

TEST(FanucReader, ExamplesWorkedOutByHand) {
  int read_examples = 0;
  for (const FanucExample& example : fanuc_examples()) {
    int count = 0;
    for (const FanucSettings& settings : example_settings()) {
      if (!holds(example.settings, settings)) continue;
      ++count;
      EXPECT_EQ(read(example, settings), example.actions)
          << example.name << " with " << to_string(settings);
    }
    EXPECT_GT(count, 0) << example.name;
    ++read_examples;
  }
  EXPECT_GE(read_examples, 30);
}

// A rule that could be wrong without any example failing would not be pinned.
TEST(FanucReader, EveryWrongRuleFailsAnExample) {
  using Change = std::function<void(FanucRules&)>;
  const std::vector<std::pair<const char*, Change>> wrong = {
      {"an inch has 25 mm", [](FanucRules& r) { r.inch_in_mm = 25.0; }},
      {"no point: mm", [](FanucRules& r) { r.number_without_point_is_increments = false; }},
      {"absolute centres", [](FanucRules& r) { r.centre_is_from_begin = false; }},
      {"G2 counter-clockwise", [](FanucRules& r) { r.G2_is_clockwise = false; }},
      {"G18 is XZ", [](FanucRules& r) { r.G18_first_axis = 0; }},
      {"G43 subtracts", [](FanucRules& r) { r.G43_sign = -1.0; }},
      {"G53 keeps the length", [](FanucRules& r) { r.machine_position_cancels_length = false; }},
      {"G28 keeps the length", [](FanucRules& r) { r.reference_return_cancels_length = false; }},
      {"G49 never moves", [](FanucRules& r) { r.G49_alone_moves_Z = false; }},
      {"G43 never moves", [](FanucRules& r) { r.G43_alone_moves_Z = false; }},
      {"the length always returns", [](FanucRules& r) { r.length_returns_only_with_EVO = false; }},
      {"G53 in work coordinates", [](FanucRules& r) { r.G53_ignores_work_offset = false; }},
      {"G53 is modal", [](FanucRules& r) { r.G53_is_for_one_block = false; }},
      {"G28 goes straight home", [](FanucRules& r) { r.G28_goes_through_a_point = false; }},
      {"always around", [](FanucRules& r) { r.rolls_over_by_shorter_way = false; }},
      {"M6 stays in place", [](FanucRules& r) { r.tool_change_forgets_positions = false; }},
      {"M0 stays in place", [](FanucRules& r) { r.stop_forgets_positions = false; }},
      {"G31 reaches its end", [](FanucRules& r) { r.skip_forgets_positions = false; }},
      {"modes at the start", [](FanucRules& r) { r.modes_are_unknown_at_start = false; }},
      {"modes survive M6", [](FanucRules& r) { r.tool_change_forgets_modes = false; }},
      {"the spindle survives M6", [](FanucRules& r) { r.tool_change_forgets_spindle = false; }},
      {"F survives G93", [](FanucRules& r) { r.feed_mode_forgets_F = false; }},
      {"G4 X in ms", [](FanucRules& r) { r.dwell_X_in_s = 1e-3; }},
      {"G4 P in s", [](FanucRules& r) { r.dwell_P_in_increments = 1.0; }},
      {"feed along the helix", [](FanucRules& r) { r.helix_feed_is_along_arc = false; }},
      {"G93 per second", [](FanucRules& r) { r.inverse_time_is_per_minute = false; }},
      {"M9 stops flood only", [](FanucRules& r) { r.M9_stops_mist_and_flood = false; }},
      {"M4 is M3", [](FanucRules& r) { r.M4_is_counter_clockwise = false; }},
      {"G9 is modal", [](FanucRules& r) { r.exact_stop_G9_is_for_one_block = false; }},
  };
  EXPECT_GE(wrong.size(), 14U);
  for (const auto& [name, change] : wrong) {
    FanucRules rules;
    change(rules);
    int failing = 0;
    for (const FanucExample& example : fanuc_examples()) {
      for (const FanucSettings& settings : example_settings()) {
        if (holds(example.settings, settings)) {
          failing += read(example, settings, rules) != example.actions ? 1 : 0;
        }
      }
    }
    EXPECT_GT(failing, 0) << name;
  }
}

TEST(FanucReader, BlocksBehindASlash) {
  const FanucExample example{"", "", FANUC_BEGIN "G54 G0 X0.\n/X1.\nX2.\n", ""};
  ControlSetup setup = setup_of_examples();
  FanucSettings settings;
  settings.LRP = true;
  EXPECT_EQ(text_of(read_fanuc(example.program, "", setup, settings)),
            "6 rapid X200\n7 rapid X201\n8 rapid X202\n");
  setup.skips_blocks = true;
  EXPECT_EQ(text_of(read_fanuc(example.program, "", setup, settings)),
            "6 rapid X200\n8 rapid X202\n");
}

// 16 combinations; the length along the normal of the plane; axes that roll over.
TEST(FanucReader, SettingsOfControls) {
  EXPECT_EQ(all_fanuc_settings().size(), 17U);
  EXPECT_EQ(all_fanuc_settings({false, false, true}).size(), 18U);
  EXPECT_EQ(to_string(all_fanuc_settings().front()), "EVO=0 TOS=0 LRP=0 TLB=0 IS-B");
  EXPECT_EQ(to_string(all_fanuc_settings({false, false, true}).back()),
            "EVO=0 TOS=0 LRP=0 TLB=0 IS-B C ROA=1");
}

// A function that a control does not have is not in force, and its code is an alarm.
TEST(FanucReader, FunctionsThatTheControlDoesNotHave) {
  FanucSettings bare;
  bare.LRP = true;
  bare.has_polar = bare.has_scaling = bare.has_mirror = bare.has_surface_speed = bare.has_preset =
      false;
  const auto actions = [&](std::string_view program) { return read({"", "", program, ""}, bare); };
  const std::string bare_head = "G21\nG17 G40 G80 G90 G94 G69\nG52 X0.\n";
  EXPECT_EQ(actions(bare_head + "S100 M3\nG54 G0 X0.\n"), "4 spindle +100\n5 rapid X200\n");
  for (const std::string code : {"G15", "G50", "G50.1", "G92.1", "G97"}) {
    EXPECT_EQ(actions(code + "\n"),
              "error: 1:1: " + code + " causes an alarm on a control without this option");
  }
}

}  // namespace
}  // namespace servomill::controllers::fanuc_reader_test
