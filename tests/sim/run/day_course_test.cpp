// A day of a machine that warms up.
#include "sim/run/day_course.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::day_course_test {
namespace {

constexpr double kCapacity = 20000.0, kConductance = 10.0;  // J/K, W/K
constexpr double kTau = kCapacity / kConductance;           // s
constexpr double kGrowth = -2.0;                            // um/K along Z

const char* const kStrokes =
    "G17 G21 G90 G94 G64 P0.001\nS6000 M3\nG1 X50 F6000\nG1 X0\nG1 X50\nG1 X0\nM5\nG4 P1\nM30\n";

std::string heat(const std::string& sources) {
  return "[machine_override.heat]\nstart_degC = 20.0\n"
         "[machine_override.heat.surroundings.room]\nmean_degC = 20.0\n"
         "[machine_override.heat.body.head]\ncapacity_J_per_K = 20000.0\n"
         "conductance_W_per_K = { room = 10.0 }\n"
         "errors_per_K = { EZZ = { constant_um = -2.0 }, EXX = { um_per_m = 10.0 } }\n"
         "[machine_override.heat.source]\n" +
         sources;
}

const std::string kPump = "pump = { body = \"head\", kind = \"constant\", power_W = 100.0 }\n";
const std::string kPlace =
    "[[day.place]]\nname = \"centre\"\nat = { X_mm = 0.0, Y_mm = 0.0, Z_mm = 100.0, B_deg = 0.0, "
    "C_deg = 0.0 }\ntool_length_mm = 100.0\n"
    "[[day.place]]\nname = \"right\"\nat = { X_mm = 200.0, Y_mm = 0.0, Z_mm = 100.0, B_deg = 0.0, "
    "C_deg = 0.0 }\ntool_length_mm = 100.0\n";

std::string sampled(const std::string& minutes) {
  return "[[case]]\nname = \"one\"\n[day]\nsample_min = " + minutes + "\n" + kPlace;
}

std::string phase(const std::string& keys) { return "[[day.phase]]\n" + keys + "\n"; }

DayCourse day_of(const std::string& phases, const std::string& sources = kPump,
                 const char* program = kStrokes) {
  const std::string toml =
      "[[case]]\nname = \"one\"\n[day]\nsample_min = 1.0\n" + kPlace + phases + heat(sources);
  const CaseOutput out = run_named_case(small_scenario(program, toml), "one");
  return *out.day;
}

double rise(double t) { return 100.0 / kConductance * (1.0 - std::exp(-t / kTau)); }

// --- closed forms -------------------------------------------------------------------------------

TEST(DayCourse, DriftsByTheClosedForm) {
  const DayCourse day = day_of(phase("activity = \"idle\"\nduration_min = 180"));
  ASSERT_EQ(day.time.size(), 181U);
  for (std::size_t n = 0; n < day.time.size(); ++n) {
    EXPECT_NEAR(day.time[n], 60.0 * static_cast<double>(n), 1e-9);
    EXPECT_NEAR(celsius(day.temperatures[0][n]), 20.0 + rise(day.time[n]), 1e-9);
    EXPECT_NEAR(day.drift[0][n][2], kGrowth * um * rise(day.time[n]), 1e-12);
    EXPECT_NEAR(day.drift[1][n][0], 0.2 * 10e-6 * rise(day.time[n]), 1e-12);
  }
}

TEST(DayCourse, RefusesAPartThatGrows) {
  try {
    day_of(phase("activity = \"idle\"\nduration_min = 1"),
           kPump +
               "[machine_override.heat.part]\nbody = \"head\"\nexpansion = 1e-5\nfixed_at_mm = "
               "[0.0, 0.0, 0.0]\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(
        error.faults().front().message,
        "case one: [day] needs a part that does not grow (no heat.part): each cycle is another "
        "part, whose temperature the day does not follow");
  }
}

// ISO 230-3: range of the first 60 min, of the whole test, and when it is reached.
TEST(DayCourse, StatesTheRangesOfIso230Part3) {
  const DayCourse day = day_of(phase("activity = \"idle\"\nduration_min = 180"));
  const DriftRange& range = day.ranges.at(0);
  EXPECT_EQ(range.place, "centre");
  EXPECT_NEAR(range.first_hour[2], 2.0 * um * rise(3600.0), 1e-12);
  EXPECT_NEAR(range.whole[2], 2.0 * um * rise(10800.0), 1e-12);
  EXPECT_NEAR(range.reached[2], 10800.0, 1e-9);
  EXPECT_EQ(range.whole[4], 0.0);
}

// A room that swings, read every minute and twice a day: the same temperatures at the same time,
// and the range of the first 60 min.
TEST(DayCourse, DoesNotDependOnTheTimeBetweenReadings) {
  const auto day = [](const std::string& minutes) {
    const std::string toml = sampled(minutes) + phase("activity = \"idle\"\nduration_min = 1440") +
                             "[machine_override.heat.surroundings.hall]\namplitude_K = 5.0\n"
                             "[machine_override.heat.body.bed]\ncapacity_J_per_K = 40000.0\n"
                             "conductance_W_per_K = { hall = 10.0 }\n" +
                             heat(kPump);
    return *run_named_case(small_scenario(kStrokes, toml), "one").day;
  };
  const DayCourse often = day("1.0"), rarely = day("720.0");
  ASSERT_EQ(rarely.time.size(), 4U);  // at 0, 1, 12 and 24 h
  for (std::size_t body = 0; body < 2; ++body) {
    EXPECT_NEAR(often.temperatures[body][720], rarely.temperatures[body][2], 1e-5);
    EXPECT_NEAR(often.temperatures[body].back(), rarely.temperatures[body].back(), 1e-5);
  }
  EXPECT_NEAR(rarely.ranges[0].first_hour[2], often.ranges[0].first_hour[2], 1e-12);
  EXPECT_NEAR(rarely.ranges[0].first_hour[2], 2.0 * um * rise(3600.0), 1e-11);
}

// On a table that has turned by 90 degrees the drift still is along the axes of the machine, and
// the tilt of a column about X is an A.
TEST(DayCourse, DriftsAlongTheAxesOfTheMachine) {
  const std::string places =
      "[[day.place]]\nname = \"turned\"\nat = { X_mm = 200.0, Y_mm = 0.0, Z_mm = 100.0, B_deg = "
      "0.0, "
      "C_deg = 90.0 }\ntool_length_mm = 100.0\n";
  const std::string toml =
      "[[case]]\nname = \"one\"\n[day]\nsample_min = 60.0\n" + places +
      phase("activity = \"idle\"\nduration_min = 60") + heat(kPump) +
      "[machine_override.heat.body.column]\ncapacity_J_per_K = 20000.0\n"
      "conductance_W_per_K = { room = 10.0 }\nerrors_per_K = { EAZ = { constant_urad = 3.0 } }\n"
      "[machine_override.heat.source.oil]\nbody = \"column\"\nkind = \"constant\"\npower_W = "
      "100.0\n";
  const DayCourse day = *run_named_case(small_scenario(kStrokes, toml), "one").day;
  const std::array<double, kDrifts>& drift = day.drift[0].back();
  EXPECT_NEAR(drift[0], 0.2 * 10e-6 * rise(3600.0), 1e-9);
  EXPECT_NEAR(drift[3], 3e-6 * rise(3600.0), 1e-9);
  EXPECT_NEAR(drift[4], 0.0, 1e-9);
}

TEST(DayCourse, OfTheSpindleHasItsPower) {
  const DayCourse day = day_of(
      phase("activity = \"spindle\"\nduration_min = 60\nspeed_rpm = 3000") +
          phase("activity = \"idle\"\nduration_min = 60"),
      "s = { body = \"head\", kind = \"spindle\", speed_rpm = [0, 6000], power_W = [0, 200] }\n");
  EXPECT_NEAR(celsius(day.temperatures[0][60]), 20.0 + rise(3600.0), 1e-9);
  EXPECT_NEAR(celsius(day.temperatures[0][120]), 20.0 + rise(3600.0) * std::exp(-3600.0 / kTau),
              1e-9);
  EXPECT_NEAR(day.ranges[0].reached[2], 3600.0, 1e-9);
}

// A datum takes off the growth along Z, at the centre and everywhere; the scale stays.
TEST(DayCourse, TakesADatum) {
  const std::string rest = phase("activity = \"idle\"\nduration_min = 60");
  const std::string part = phase("activity = \"program\"\ncycles = 1");
  const DayCourse without = day_of(rest + part),
                  with = day_of(rest + phase("activity = \"probe\"\nplace = \"centre\"") + part);
  const double growth = 2.0 * um * rise(3600.0);
  ASSERT_EQ(without.cycles.size(), 1U);
  EXPECT_NEAR(without.cycles[0].rms, growth, 0.02 * growth);
  EXPECT_LT(with.cycles[0].most, 0.05 * 10e-6 * rise(3600.0) + 1e-12);  // X 0 to 50 mm
  EXPECT_GT(with.cycles[0].most, 0.04 * 10e-6 * rise(3600.0));
}

// Between two readings, too.
TEST(DayCourse, TakesADatumAtTheTemperaturesOfItsTime) {
  const DayCourse day = day_of(phase("activity = \"idle\"\nduration_min = 20.5") +
                               phase("activity = \"probe\"\nplace = \"centre\"") +
                               phase("activity = \"program\"\ncycles = 1"));
  EXPECT_LT(day.cycles.at(0).most, 0.05 * 10e-6 * rise(20.5 * 60.0) + 1e-12);
}

TEST(DayCourse, NotesThatIdealAxesHeatNothing) {
  const std::string motor =
      "m = { body = \"head\", kind = \"motor\", axis = \"X\", resistance = "
      "5.0 }\n";
  const CaseOutput out = run_named_case(
      small_scenario(kStrokes, "[[case]]\nname = \"one\"\nservo = \"ideal\"\n" + heat(motor)),
      "one");
  EXPECT_EQ(out.notes.back(),
            "case one: an ideal servo has no current: motors and friction generate no heat");
}

// --- repeated cycles ----------------------------------------------------------------------------

// The same program six times in one run, every tick of it simulated.
TEST(DayCourse, RepeatsACycleAsIfItWereSimulated) {
  const std::string sources =
      "m = { body = \"head\", kind = \"motor\", axis = \"X\", resistance = 5.0 }\n"
      "s = { body = \"head\", kind = \"spindle\", speed_rpm = [0, 6000], power_W = [10, 2000] }\n";
  const DayCourse day = day_of(phase("activity = \"program\"\ncycles = 6"), sources);
  std::string program = "G17 G21 G90 G94 G64 P0.001\n";
  for (int n = 0; n < 6; ++n) {
    program += "S6000 M3\nG1 X50 F6000\nG1 X0\nG1 X50\nG1 X0\nM5\nG4 P1\n";
  }
  const CaseOutput run = run_named_case(
      small_scenario(program + "M30\n", "[[case]]\nname = \"one\"\n" + heat(sources)), "one");
  const records::Series& servo = run.result.servo;
  const std::size_t T = servo.column("temperature_head").value();
  const std::size_t end = servo.rows() - 1;
  const double risen = servo.at(end, T) - 20.0;
  EXPECT_GT(risen, 0.5);
  EXPECT_NEAR(celsius(day.temperatures[0].back()) - 20.0, risen, 0.01 * risen);
}

// Position periods of which 0.1 s is no multiple: no power is lost or played too fast.
TEST(DayCourse, RepeatsACycleOfAnyPositionPeriod) {
  const std::string sources =
      "s = { body = \"head\", kind = \"spindle\", speed_rpm = [0, 6000], power_W = [0, 2000] }\n";
  const auto risen = [&](const std::string& period) {
    const std::string toml = sampled("1.0") + phase("activity = \"program\"\ncycles = 20") +
                             "[machine_override.nc]\nposition_period_us = " + period +
                             "\nvelocity_period_us = 600\n" + heat(sources);
    return celsius(run_named_case(
                       small_scenario("G17 G21 G90 G94 G64 P0.001\nG4 P60.0\nS6000 M3\nG1 X50 "
                                      "F1200\nG1 X0\nM30\n",
                                      toml),
                       "one")
                       .day->temperatures[0]
                       .back()) -
           20.0;
  };
  const double wanted = risen("600");
  EXPECT_GT(wanted, 2.0);
  EXPECT_NEAR(risen("3000"), wanted, 0.01 * wanted);
}

TEST(DayCourse, EndsAtTheLimitOfABody) {
  const DayCourse day =
      day_of(phase("activity = \"idle\"\nduration_min = 600"),
             "pump = { body = \"head\", kind = \"constant\", power_W = 1000.0 }\n");
  EXPECT_NE(day.stopped.find("degC, beyond its limits of -10 to 100 degC, 0.90 h after the start"),
            std::string::npos)
      << day.stopped;
  EXPECT_LT(day.time.back(), 3600.0);
}

}  // namespace
}  // namespace servomill::sim::run::day_course_test
