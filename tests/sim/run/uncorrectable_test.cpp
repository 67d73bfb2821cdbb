/// Errors that strategies cannot correct are reported and recorded.
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::uncorrectable_test {
namespace {

// Pitch of X, 0.2 urad a millimetre: the tool tilts with x, most at the end of line 3. B stands at
// 30 deg, where B and C could turn the tool either way; the rapid move does not count.
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94\nG0 X-90 B30\nG1 X60 F6000\nG1 X-20 Y10\nG0 X-150\nM30\n";
const std::string kErrors =
    "machine_errors = \"machine\"\n[errors.machine]\nEBX = { polynomial_urad = [0.0, 0.2] }\n";

std::string one_case(const std::string& name, const std::string& more) {
  return "[[case]]\nname = \"" + name +
         "\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = \"feedback\"\nmodel = \"machine\"\n" +
         more;
}

TEST(Uncorrectable, IsToldWithItsSizeAndLine) {
  const model::Scenario scenario =
      small_scenario(kProgram, kErrors + one_case("linear", "action = \"compensate\"\n") +
                                   one_case("all", "action = \"compensate\"\naxes = \"all\"\n") +
                                   one_case("generates", "action = \"impose\"\n"));
  const std::vector<std::string> notes = run_named_case(scenario, "linear").notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(
      notes[0].ends_with("small.ngc:3: warning: case linear: strategy feedback cannot correct 18.0 "
                         "urad of the tool axis here, the largest found"))
      << notes[0];
  EXPECT_TRUE(run_named_case(scenario, "all").notes.empty());
  EXPECT_TRUE(run_named_case(scenario, "generates").notes.empty());
}

TEST(Uncorrectable, IsRecordedWhereTheScenarioAsksForIt) {
  const model::Scenario scenario =
      small_scenario(kProgram, kErrors + "[record]\nuncorrectable = true\n" +
                                   one_case("linear", "action = \"compensate\"\n") +
                                   one_case("all", "action = \"compensate\"\naxes = \"all\"\n") +
                                   one_case("generates", "action = \"impose\"\n"));
  const records::Series linear = run_named_case(scenario, "linear").result.servo;
  const auto tip = linear.column("uncorrectable_tcp"), axis = linear.column("uncorrectable_axis");
  ASSERT_TRUE(tip && axis);
  const std::size_t x = linear.column("ref_linear", 'X').value();
  constexpr double kTol = 1e-4;  // urad, of slopes of 2e-4 m/m
  for (std::size_t n = 0; n < linear.rows(); ++n) {
    EXPECT_NEAR(linear.at(n, *axis), 0.2 * std::abs(linear.at(n, x)), kTol);
    EXPECT_NEAR(linear.at(n, *tip), 0.0, 1e-6);
  }
  const records::Series all = run_named_case(scenario, "all").result.servo;
  for (std::size_t n = 0; n < all.rows(); ++n) {
    const double B = all.at(n, all.column("ref_rotary", 'B').value());
    if (B > 2.0) {
      EXPECT_NEAR(all.at(n, all.column("uncorrectable_axis").value()), 0.0, kTol) << B;
    }
  }
  EXPECT_FALSE(run_named_case(scenario, "generates").result.servo.column("uncorrectable_tcp"));
}

}  // namespace
}  // namespace servomill::sim::run::uncorrectable_test
