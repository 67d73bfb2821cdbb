// Simulation of G95.
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::feed_per_revolution_sim_test {
namespace {

TEST(FeedPerRevolution, RunsAsTheSameFeedPerMinute) {
  const auto duration_of = [](const std::string& program) {
    const model::Scenario scenario = small_scenario(program, "[[case]]\nname = \"one\"\n");
    const CaseOutput output = run_named_case(scenario, "one");
    return output.duration;
  };
  EXPECT_EQ(duration_of("S1000 M3\nG95 G1 X5 F2\nM2\n"), duration_of("G1 X5 F2000\nM2\n"));
}

TEST(FeedPerRevolution, OfASpindleThatStandsStillIsRefused) {
  const model::Scenario scenario =
      small_scenario("S1000\nG0 X1\nG95 G1 X5 F2\nM2\n", "[[case]]\nname = \"one\"\n");
  try {
    preparation::PreparedCase(scenario, *scenario.find_case("one"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "small.ngc:3: error: feed per revolution (G95) with the spindle stopped would "
                 "never end: start the spindle (M3 S...) or use G94");
  }
}

}  // namespace
}  // namespace servomill::sim::run::feed_per_revolution_sim_test
