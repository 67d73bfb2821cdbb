/// A feedback strategy under a name that the program has never seen: everything asks what a
/// strategy can do. This file takes the place of strategies/registry.cpp in its program.
#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"
#include "sim/run/budget.h"
#include "sim/run/budget_quantities.h"
#include "sim/run/run_output.h"
#include "strategies/feedback.h"
#include "strategies/none.h"
#include "strategies/table.h"
#include "tests/sim/small_scenario.h"

namespace servomill::strategies {
namespace {

Entry renamed(Entry entry, std::string_view name) {
  entry.name = name;
  return entry;
}

Entry without_hardware(Entry entry) {
  entry.uses_feedback_hardware = false;
  return entry;
}

}  // namespace

std::span<const Entry> entries() {
  static const std::array kEntries = {
      feedback_entry(), without_hardware(renamed(feedback_entry(), "forgetful")), none_entry(),
      renamed(feedback_entry(), "stranger"), table_entry()};
  return kEntries;
}

const Entry* find(std::string_view name) {
  for (const Entry& entry : entries()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> out;
  for (const Entry& entry : entries()) out.push_back(entry.name);
  return out;
}

}  // namespace servomill::strategies

namespace servomill::sim::run {
namespace {

constexpr const char* kProgram = "G21 G1 X20 F2400\nG1 X0\nM2\n";

// @param type     of the strategy of the case "one"
// @param changes  keys of that case
model::Scenario scenario(const std::string& type, const std::string& changes = "",
                         const std::string& root = "") {
  return small_scenario(kProgram,
                        "imposed = \"imposed\"\n"
                        "[errors.imposed]\n"
                        "EYX = { harmonic = { amplitude_um = 50.0, period_mm = 20.0 } }\n"
                        "EXX = { um_per_m = 100.0 }\n" +
                            root +
                            "[[case]]\nname = \"nominal\"\n"
                            "[[case]]\nname = \"one\"\n" +
                            changes + "[[case.strategy]]\ntype = \"" + type +
                            "\"\nmodel = \"imposed\"\naction = \"impose\"\n"
                            "max_rate_mm_per_s = 0.5\n"
                            "[[quantity]]\nname = \"imposed_error_residual\"\naxis = \"Y\"\n"
                            "baseline = \"nominal\"\n");
}

std::string refusal(const std::string& type, const std::string& changes) {
  try {
    scenario(type, changes);
  } catch (const InputError& error) {
    const std::string all = error.what();
    return all.substr(all.find(": error: "));
  }
  return "none";
}

RunOutput run(const model::Scenario& one) { return run_scenario(one, {}); }

TEST(UnknownFeedbackStrategy, HasTheHardwareAndGivesTheSameBits) {
  const RunOutput known = run(scenario("feedback")), strange = run(scenario("stranger"));
  for (std::size_t c = 0; c < known.cases.size(); ++c) {
    const records::Series& a = known.cases[c].result.servo;
    const records::Series& b = strange.cases[c].result.servo;
    ASSERT_EQ(a.rows(), b.rows());
    for (std::size_t row = 0; row < a.rows(); ++row) {
      for (std::size_t column = 0; column < a.width(); ++column) {
        ASSERT_EQ(a.at(row, column), b.at(row, column)) << a.signals().size() << " " << row;
      }
    }
  }
  ASSERT_EQ(strange.comparison.size(), 1U);
  EXPECT_EQ(strange.comparison[0].value, known.comparison[0].value);
  EXPECT_GT(strange.comparison[0].value, 1.0) << "um: the lag of real loops";
}

TEST(UnknownFeedbackStrategy, HasTheSameBudget) {
  const auto budget = [](const std::string& type) {
    const model::Scenario one = scenario(type);
    return find_budgets(one, budget_quantities(one)).at(0);
  };
  const Budget known = budget("feedback"), strange = budget("stranger");
  for (std::size_t c = 0; c < kCauses; ++c) {
    EXPECT_EQ(known.parts[c].present, strange.parts[c].present) << c;
    EXPECT_EQ(known.parts[c].signal.all(), strange.parts[c].signal.all()) << c;
  }
  for (const Cause cause : {Cause::delay, Cause::saturation, Cause::single_evaluation}) {
    EXPECT_TRUE(strange.parts[static_cast<std::size_t>(cause)].present) << info_of(cause).name;
  }
}

TEST(UnknownFeedbackStrategy, IsCalledByItsNameInMessages) {
  EXPECT_EQ(refusal("stranger", "feedback_hardware = false\n"),
            ": error: case[1].feedback_hardware = false; must not be false: the case has the "
            "strategy stranger");
  EXPECT_EQ(refusal("stranger", "[[case.strategy]]\ntype = \"feedback\"\nmodel = \"imposed\"\n"),
            ": error: case[1].strategy[1].type = \"stranger\"; a case has only one feedback "
            "hardware: this is the second strategy that uses it");
  const auto notes = run(scenario("stranger")).cases.at(1).notes;
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes[0].find("case one: strategy stranger: rate of the virtual displacement of Y "
                          "saturated at 0.5 mm/s"),
            std::string::npos)
      << notes[0];
}

TEST(UnknownFeedbackStrategy, IsRefusedIfItsEntryForgetsTheHardware) {
  try {
    run(scenario("forgetful"));
    FAIL() << "its signals would have no delay";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(),
                 "strategy forgetful displaces the feedback, but its entry in the registry lacks "
                 "uses_feedback_hardware");
  }
}

TEST(FeedbackHardware, IsInAllCasesAsSoonAsOneNeedsIt) {
  EXPECT_TRUE(scenario("stranger").cases[0].feedback_hardware);
  EXPECT_TRUE(scenario("stranger").cases[1].feedback_hardware);
  EXPECT_FALSE(small_scenario(kProgram, "[[case]]\nname = \"one\"\n").cases[0].feedback_hardware);
  EXPECT_TRUE(run(scenario("stranger")).comparison[0].note.empty());
}

TEST(FeedbackHardware, ThatSomeCasesLackIsReported) {
  const model::Scenario uneven =
      scenario("stranger", "", "[feedback_hardware]\nconnected = false\n");
  EXPECT_FALSE(uneven.cases[0].feedback_hardware);
  const RunOutput out = run(uneven);
  EXPECT_EQ(out.comparison.at(0).note,
            "the feedback hardware delays readings by 10 us, those of nominal by 0 us");
  EXPECT_EQ(
      out.cases[0].notes,
      std::vector<std::string>{
          "warning: the feedback hardware is connected in case 'one' but not in case 'nominal': "
          "readings of the latter lack its delay of 10 us, which is 0.4 um at the largest feed of "
          "2.4 m/min; set feedback_hardware.connected = true to connect it in all cases"});
}

TEST(FeedbackHardware, ThatSomeCasesLackCountsAtTheLargestFeedWithItsOverride) {
  const auto note_of = [](const char* program, double feed_override) {
    model::Scenario uneven =
        small_scenario(program,
                       "imposed = \"imposed\"\n[errors.imposed]\nEXX = { um_per_m = 100.0 }\n"
                       "[feedback_hardware]\nconnected = false\n[[case]]\nname = \"nominal\"\n"
                       "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"feedback\"\n"
                       "model = \"imposed\"\naction = \"impose\"\n");
    uneven.program.feed_override = feed_override;
    return run(uneven).cases[0].notes.at(0);
  };
  const char* faster = "G21 G1 X10 F2400\nG1 X20 F6000\nG1 X0 F1200\nM2\n";
  EXPECT_NE(note_of(faster, 1.0).find("10 us, which is 1 um at the largest feed of 6 m/min;"),
            std::string::npos)
      << note_of(faster, 1.0);
  EXPECT_NE(note_of(faster, 0.5).find("10 us, which is 0.5 um at the largest feed of 3 m/min;"),
            std::string::npos)
      << note_of(faster, 0.5);
  EXPECT_NE(note_of("G21 G0 X20\nM2\n", 1.0).find("delay of 10 us; set"), std::string::npos)
      << note_of("G21 G0 X20\nM2\n", 1.0);
}

TEST(Comparison, HasNoRowOfTheBaseItself) {
  model::Scenario all = scenario("feedback");
  EXPECT_EQ(all.quantities.at(0).cases, std::vector<std::string>{"one"});
  all.quantities[0].name = "lag_time";
  all.quantities[0].cases = {"nominal", "one"};  // as if asked for
  const auto rows = run(all).comparison;
  EXPECT_TRUE(std::isnan(rows.at(0).value)) << rows[0].value << " ms: of nothing";
  EXPECT_EQ(rows[0].note, "is compared with itself");
  EXPECT_TRUE(std::isfinite(rows.at(1).value));
}

}  // namespace
}  // namespace servomill::sim::run
