/// Motion that strategies ask the axes for: judged of every one of them against the limits.
#include "sim/run/demanded_motion.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/model/scenario.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::demanded_motion_test {
namespace {

using evaluation::AxisDemand;

constexpr double kPeriod = 0.2 * ms;
constexpr double kRounding = 1e-3;  // share of a limit

// X as fast as it can be, with 2 mm/m of error: 0.4 % more or less of its speed is a share of 1e-3.
const std::string kErrors =
    "imposed = \"machine\"\n[errors.machine]\nEXX = { um_per_m = 2000.0 }\n";
constexpr const char* kFast =
    "G17 G21 G90 G94\nG4 P0.2\nG1 X300 F60000\nG4 P1\nG1 X0\nG4 P0.2\nM30\n";

std::string one_case(const std::string& name, const std::string& strategy,
                     const std::string& more = "") {
  return "[[case]]\nname = \"" + name + "\"\n" + more +
         (strategy.empty() ? "" : "[[case.strategy]]\n" + strategy);
}

std::string knowing(const std::string& strategy) {
  return "model = \"machine\"\naction = \"impose\"\n" + strategy;
}

const AxisDemand& of(const CaseOutput& one, char axis) {
  for (const AxisDemand& demand : one.demands) {
    if (demand.axis == axis) return demand;
  }
  throw std::logic_error("no such axis");
}

std::string note_of_limits(const CaseOutput& one) {
  for (const std::string& note : one.notes) {
    if (note.find(" limits: ") != std::string::npos) return note;
  }
  return "none";
}

// A path on the limit of X: what adds 2 mm/m to it takes 0.2 % more, what rewrites the program is
// planned within the limit, what takes it away leaves 0.2 %.
TEST(Demands, AreThoseOfPathAndOffsetOfEveryKindOfStrategy) {
  const std::string table =
      "type = \"table\"\nlayout = \"continuous\"\ninjection_point = \"feed_forward\"\n";
  const model::Scenario scenario = small_scenario(
      kFast,
      kErrors + one_case("plain", "") + one_case("table", knowing(table)) +
          one_case("lagging", knowing("type = \"table\"\nlayout = \"continuous\"\n"
                                      "injection_point = \"position_command\"\n")) +
          one_case("feedback", knowing("type = \"feedback\"\n")) +
          one_case("ideal_feedback", knowing("type = \"feedback\"\n"), "servo = \"ideal\"\n") +
          one_case("ideal_table", knowing(table), "servo = \"ideal\"\n") +
          one_case("taken", "model = \"machine\"\naction = \"compensate\"\n" + table) +
          one_case("gcode", knowing("type = \"gcode\"\n")));
  const auto share = [&](const char* name) {
    return of(run_named_case(scenario, name), 'X').motion[0].share();
  };
  constexpr double kRounded = 1e-4;  // of the lag of the loops, which ends within the motion
  EXPECT_NEAR(share("plain"), 1.0, 1e-6);
  for (const char* name : {"table", "lagging", "feedback", "ideal_feedback", "ideal_table"}) {
    EXPECT_NEAR(share(name), 1.002, kRounded) << name;
  }
  EXPECT_NEAR(share("taken"), 0.998, kRounded);
  EXPECT_LE(share("gcode"), 1.0 + kRounding);
}

TEST(Demands, TellTheLargestOffsetOfAnAxis) {
  const model::Scenario scenario = small_scenario(
      kFast, kErrors + one_case("table", knowing("type = \"table\"\nlayout = \"continuous\"\n")) +
                 one_case("feedback", knowing("type = \"feedback\"\nmax_um = 1000.0\n")));
  const CaseOutput table = run_named_case(scenario, "table"),
                   feedback = run_named_case(scenario, "feedback");
  EXPECT_NEAR(of(table, 'X').offset, 600 * um, 0.01 * um) << "2 mm/m at 300 mm";
  EXPECT_NEAR(of(feedback, 'X').offset, 601.2 * um, 0.01 * um)
      << "2 mm/m of what the scales read: 300.6 mm";
  EXPECT_EQ(of(table, 'Y').offset, 0.0);
  EXPECT_TRUE(of(table, 'X').is_linear);
  EXPECT_FALSE(of(table, 'C').is_linear);
}

// The same differences of the recorded commands, row after row.
TEST(Demands, OfASetpointAreDifferencesOfWhatIsRecorded) {
  const std::string swinging =
      "[errors.machine]\nEYX = { harmonic = { amplitude_um = 25.0, "
      "period_mm = 12.0 } }\n[record]\nperiod_ms = 0.2\n"
      "resolution_nm = 0.0\n";
  const CaseOutput one = run_named_case(
      small_scenario(
          "G21 G90 G94\nG1 X60 F12000\nM30\n",
          swinging + one_case("one",
                              "type = \"table\"\nmodel = \"machine\"\nbase_axis = "
                              "\"X\"\nfrom_mm = -10.0\nto_mm = 100.0\nspacing_mm = 1.6384\n"
                              "injection_point = \"feed_forward\"\n")),
      "one");
  const records::Series& servo = one.result.servo;
  const std::size_t y = *servo.column("cmd_linear", 'Y');
  std::array<double, 3> largest = {};
  for (std::size_t n = 3; n < servo.rows(); ++n) {
    const auto x = [&](std::size_t back) { return servo.at(n - back, y) * mm; };
    const std::array<double, 3> now = {
        (x(0) - x(1)) / kPeriod, (x(0) - 2.0 * x(1) + x(2)) / std::pow(kPeriod, 2),
        (x(0) - 3.0 * x(1) + 3.0 * x(2) - x(3)) / std::pow(kPeriod, 3)};
    for (std::size_t k = 0; k < 3; ++k) largest[k] = std::max(largest[k], std::abs(now[k]));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(of(one, 'Y').motion[k].size, largest[k], 1e-6 * largest[k]) << k;
  }
  // kinks of the table: a change of slope of 25 um (2 pi/12 mm)^2 1.6 mm at 0.2 m/s, in a period
  EXPECT_GT(of(one, 'Y').motion[2].share(), 2.0);
}

TEST(Demands, BeyondLimitsAreReportedWithTheirPlaces) {
  const std::string steep = "[errors.machine]\nEYX = { polynomial_um = [0.0, 0.0, 40.0] }\n";
  const model::Scenario scenario =
      small_scenario("G21 G90 G94\nG1 X60 F12000\nM30\n",
                     steep + one_case("plain", "") +
                         one_case("one",
                                  "type = \"table\"\nmodel = \"machine\"\nlayout = \"continuous\"\n"
                                  "injection_point = \"feed_forward\"\n"));
  EXPECT_EQ(note_of_limits(run_named_case(scenario, "plain")), "none");
  const CaseOutput one = run_named_case(scenario, "one");
  // y = -40 um/mm2 x^2: y''' = -2 (40 /m) (3 v a + x j) and, at most, y' = 2 (40 /m) x v
  const AxisDemand& y = of(one, 'Y');
  ASSERT_GT(y.motion[0].share(), 1.01);
  EXPECT_TRUE(note_of_limits(one).starts_with(fmt::format(
      "small.ngc: warning: case one: path and offset together exceed limits: velocity of Y by "
      "{:.0f} % of 0.666667 m/s (line 2, {:.4g} s), acceleration of Y by ",
      100.0 * (y.motion[0].share() - 1.0), y.motion[0].time)))
      << note_of_limits(one);
}

// The largest jerks of a corner come from the term in the velocity commands.
TEST(Demands, OfCrossCoupledControlAreWhatItsVelocitiesDisplace) {
  const model::Scenario scenario = small_scenario(
      "G17 G21 G90 G94\nG4 P0.2\nG1 X40 F6000\nG1 Y40\nG4 P0.2\nM30\n",
      "[machine_override.nc]\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n"
      "path_tolerance_um = 50.0\n" +
          one_case("plain", "") + one_case("contour", "type = \"contour\"\n"));
  const CaseOutput plain = run_named_case(scenario, "plain"),
                   contour = run_named_case(scenario, "contour");
  EXPECT_EQ(of(plain, 'X').offset, 0.0);
  EXPECT_GT(of(contour, 'X').offset, 1 * um);
  EXPECT_GT(of(contour, 'X').motion[2].share(), of(plain, 'X').motion[2].share());
}

TEST(Demands, ComeBackFromTheResultFileAsQuantities) {
  const std::string quantities =
      "[[quantity]]\nname = \"axis_offset\"\naxis = \"X\"\n"
      "[[quantity]]\nname = \"velocity_demand\"\naxis = \"X\"\n"
      "[[quantity]]\nname = \"acceleration_demand\"\naxis = \"X\"\n"
      "[[quantity]]\nname = \"jerk_demand\"\naxis = \"C\"\n";
  const model::Scenario scenario = small_scenario(
      kFast, kErrors + quantities +
                 one_case("one", knowing("type = \"table\"\nlayout = \"continuous\"\n"
                                         "injection_point = \"feed_forward\"\n")));
  const CaseOutput one = run_named_case(scenario, "one");
  const evaluation::CaseData data = one.data();
  const auto rows = evaluation::compare(scenario.quantities, {&data, 1});
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_NEAR(rows[0].value, 600.0, 0.01);
  EXPECT_NEAR(rows[1].value, 100.2, 0.01);
  EXPECT_DOUBLE_EQ(rows[2].value, 100.0 * of(one, 'X').motion[1].share());
  EXPECT_EQ(rows[3].value, 0.0) << "C stands";

  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / ("demands_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  {
    RunStore store(folder / "out.h5", true, scenario);
    store.add(one);
    store.commit(rows);
  }
  const StoredRun stored = read_run(folder / "out.h5");
  const auto again = evaluation::compare(stored.quantities, stored.cases);
  ASSERT_EQ(again.size(), rows.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_NEAR(again[n].value, rows[n].value, 1e-9 * std::abs(rows[n].value)) << n;
  }
  const AxisDemand &before = of(one, 'X'), &after = stored.cases[0].demands.at(0);
  EXPECT_EQ(after.motion[2].line, before.motion[2].line);
  EXPECT_DOUBLE_EQ(after.motion[2].time, before.motion[2].time);
  EXPECT_EQ(stored.cases[0].demands.size(), one.demands.size());
  fs::remove_all(folder);
}

}  // namespace
}  // namespace servomill::sim::run::demanded_motion_test
