// Machines that warm up while they run.
#include "sim/engine/heat_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "plant/cutting/material.h"
#include "plant/heat/temperature.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::heat_run_test {
namespace {

const std::string kCase = "[[case]]\nname = \"one\"\n";
const std::string kRecord = "[record]\nperiod_ms = 0.2\n";  // as the position loop

// One body in a room of 20 degC, at 20 degC, whose heat lowers the tip by 2 um/K.
std::string heat(const std::string& source) {
  return "[machine_override.heat]\nstart_degC = 20.0\n"
         "surroundings = { room = { mean_degC = 20.0 } }\n"
         "[machine_override.heat.body.head]\ncapacity_J_per_K = 500.0\n"
         "conductance_W_per_K = { room = 4.0 }\n"
         "errors_per_K = { EZZ = { constant_um = -2.0 } }\n"
         "[machine_override.heat.source]\ns = { body = \"head\", " +
         source + " }\n";
}

const char* const kStrokes =
    "G17 G21 G90 G94 G64 P0.001\nS6000 M3\nG1 X50 F6000\nG1 X0\nG1 X50\nG1 X0\nM5\nG4 P1\nM30\n";

run::CaseOutput run_of(const std::string& source, const std::string& more = "") {
  return run_named_case(small_scenario(kStrokes, kRecord + more + kCase + heat(source)), "one");
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double last(const records::Series& servo, const std::string& signal, char label = ' ') {
  const auto column = label == ' ' ? servo.column(signal) : servo.column(signal, label);
  return servo.at(servo.rows() - 1, column.value());
}

TEST(HeatRun, RisesAndGrowsByTheClosedForm) {
  const run::CaseOutput out = run_of("kind = \"constant\", power_W = 800.0");
  const records::Series& servo = out.result.servo;
  const std::size_t T = servo.column("temperature_head").value(), time = 0;
  const std::size_t z = servo.column("tool_deviation", 'Z').value();
  const run::CaseOutput cold = run_named_case(small_scenario(kStrokes, kRecord + kCase), "one");
  const records::Series& rigid = cold.result.servo;
  const std::size_t z_cold = rigid.column("tool_deviation", 'Z').value();
  ASSERT_EQ(servo.rows(), rigid.rows());
  EXPECT_GT(servo.at(servo.rows() - 1, time), 3.0);
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    const double t = HeatBalance::kStep * std::floor(servo.at(n, time) / HeatBalance::kStep + 1e-9);
    const double rise = 200.0 * (1.0 - std::exp(-4.0 / 500.0 * t));
    const double measured = servo.at(n, T) - 20.0;
    EXPECT_NEAR(measured, rise, 1e-9) << servo.at(n, time);
    EXPECT_NEAR(servo.at(n, z) - rigid.at(n, z_cold), -2.0 * measured, 1e-4) << servo.at(n, time);
  }
}

// An axis that is measured at its motor goes further on a warm screw. As an error of the body that
// the screw is, and as the growth of the screw in the loop: the same between two rests.
TEST(HeatRun, OfAScrewIsItsGrowthWhereTheMotorMeasures) {
  const auto stroke = [](const std::string& machine, const std::string& feedback) {
    const run::CaseOutput out = run_named_case(
        small_scenario("G21 G90 G94\nG4 P0.3\nG1 X50 F3000\nG4 P0.5\nM30\n",
                       kRecord + kCase + "[machine_override.nc]\nposition_feedback = \"" +
                           feedback + "\"\n" + machine),
        "one");
    const records::Series& servo = out.result.servo;
    const std::size_t x = servo.column("tool_position_true", 'X').value();
    return servo.at(servo.rows() - 1, x) - servo.at(1000, x);  // mm
  };
  const std::string growth =
      "[machine_override.axis.X.screw]\nexpansion = 11.5e-6\nfixed_at = "
      "\"200 mm\"\ntemperature_rise = 10.0\n";
  const std::string body =
      "[machine_override.heat]\nstart_degC = 30.0\nsurroundings = { room = { mean_degC = 30.0 } }\n"
      "[machine_override.heat.body.screw]\ncapacity_J_per_K = 500.0\nconductance_W_per_K = { room "
      "= 4.0 }\nerrors_per_K = { EXX = { um_per_m = 11.5, constant_um = -2.3 } }\n";
  const double cold = stroke("", "motor");
  constexpr double kLonger = 11.5e-6 * 10.0 * 50.0;  // mm
  EXPECT_NEAR(stroke(growth, "motor") - cold, kLonger, 2e-6);
  EXPECT_NEAR(stroke(body, "motor") - cold, kLonger, 2e-6);
  EXPECT_NEAR(stroke(growth, "scale") - stroke("", "scale"), 0.0, 0.01 * kLonger);
}

TEST(HeatRun, OfAMotorIsResistanceTimesTheSquareOfItsCurrent) {
  const run::CaseOutput out = run_of("kind = \"motor\", axis = \"X\", resistance = 0.5");
  const records::Series& servo = out.result.servo;
  const std::size_t i = servo.column("current_linear", 'X').value();
  double energy = 0.0;  // J, of the recording at each position period
  const HeatCourse& course = out.result.heat;
  const auto rows = static_cast<std::size_t>(
      std::lround(static_cast<double>(course.power.size()) * course.step / 0.2e-3));
  for (std::size_t n = 0; n < rows; ++n) energy += 0.5 * servo.at(n, i) * servo.at(n, i) * 0.2e-3;
  EXPECT_GT(energy, 1.0);
  EXPECT_NEAR(sum_of(course.power) * course.step, energy, 1e-3 * energy);
}

// From rest to rest, the work of the motor is that of friction: viscous, here.
TEST(HeatRun, OfFrictionIsTheWorkThatViscousFrictionTakes) {
  const run::CaseOutput out = run_of("kind = \"friction\", axis = \"X\"");
  const records::Series& servo = out.result.servo;
  const std::size_t v = servo.column("velocity_linear", 'X').value();
  constexpr double r = 20.0 * mm / (2.0 * std::numbers::pi);
  constexpr double b = 1500.0 + 0.01 / (r * r);  // N s/m, of slide and motor
  double work = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    work += b * std::pow(servo.at(n, v) * mm, 2) * 0.2e-3;
  }
  EXPECT_GT(work, 10.0);
  EXPECT_NEAR(sum_of(out.result.heat.power) * out.result.heat.step, work, 2e-3 * work);
}

TEST(HeatRun, OfTheSpindleFollowsItsSpeed) {
  const run::CaseOutput out =
      run_of("kind = \"spindle\", speed_rpm = [0, 4000, 8000], power_W = [10.0, 50.0, 150.0]");
  const std::vector<double>& power = out.result.heat.power;
  EXPECT_NEAR(power[5], 100.0, 1e-9);     // at 6000 1/min, after M3
  EXPECT_NEAR(power.back(), 10.0, 1e-9);  // after M5
}

// Without start_degC the machine has been on for days: 100 W over 4 W/K are in it already, and
// stay.
TEST(HeatRun, BeginsSettledWithTheMachineOn) {
  std::string settled = heat("kind = \"constant\", power_W = 100.0");
  settled.erase(settled.find("start_degC = 20.0\n"), std::string("start_degC = 20.0\n").size());
  const run::CaseOutput out =
      run_named_case(small_scenario(kStrokes, kRecord + kCase + settled), "one");
  const records::Series& servo = out.result.servo;
  const std::size_t T = servo.column("temperature_head").value();
  EXPECT_NEAR(servo.at(0, T), 45.0, 1e-9);
  EXPECT_NEAR(servo.at(servo.rows() - 1, T), 45.0, 1e-9);
}

// Every reading has its own noise, of the standard deviation that is asked for; the tip does not
// feel it.
TEST(HeatRun, ReadsItsSensorsWithNoise) {
  const std::string source = "kind = \"constant\", power_W = 0.0";
  const run::CaseOutput out = run_named_case(
      small_scenario(
          "G1 X50 F150\nM30\n",
          "[record]\nperiod_ms = 100\n" + kCase + heat(source) +
              "[machine_override.heat.sensor]\nram = { body = \"head\", noise_K = 0.1 }\n"),
      "one");
  const records::Series& servo = out.result.servo;
  const std::size_t column = servo.column("sensor_ram").value();
  double sum = 0.0, squares = 0.0;
  const auto n = static_cast<double>(servo.rows());
  ASSERT_GT(n, 180.0);
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    sum += servo.at(row, column) - 20.0;
    squares += std::pow(servo.at(row, column) - 20.0, 2);
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 4.0 * 0.1 / std::sqrt(2.0 * n));
  EXPECT_NEAR(last(servo, "temperature_head"), 20.0, 1e-9);
}

TEST(HeatRun, StopsAtTheLimitOfABody) {
  const model::Scenario scenario =
      small_scenario(kStrokes, kRecord + kCase + heat("kind = \"constant\", power_W = 20000.0"));
  static const StopFlag kNever = false;
  std::atomic<float> progress = 0.0F;
  const run::CaseOutput out =
      run::run_case(preparation::PreparedCase(scenario, scenario.cases.front()), kNever, progress);
  EXPECT_FALSE(out.result.outcome.finished);
  EXPECT_NE(out.result.outcome.reason.find("head is at 10"), std::string::npos)
      << out.result.outcome.reason;
  EXPECT_NE(out.result.outcome.reason.find("degC, beyond its limits of -10 to 100 degC"),
            std::string::npos)
      << out.result.outcome.reason;
}

// In a slot of depth a, two shares of the power of spindle and feed:
// P = w N a R / (2 pi) (2 Ktc c + pi Kte) + F v, with R and the feed from the program.
double slot_power() {
  const plant::CuttingCoefficients& K = plant::find_material("42CrMo4")->typical;
  constexpr double a = 2 * mm, R = 4 * mm, pi = std::numbers::pi;
  constexpr double speed = 4775 * rpm, feed = 1394 * mm / 60.0, c = 1394.0 / (4775.0 * 4) * mm;
  const double torque = 4 * a * R / (2.0 * pi) * (2.0 * K.Ktc * c + pi * K.Kte);
  return speed * torque + feed * (a * K.Krc * c + 4.0 * a / pi * K.Kre);
}

double power_in_slot(const run::CaseOutput& out) {
  const std::vector<double>& power = out.result.heat.power;
  return *std::max_element(power.begin(), power.end());
}

TEST(HeatRun, OfTheCutIsThePowerOfSpindleAndFeed) {
  const std::string share = "kind = \"cutting\", share = 0.25";
  const std::string cut = kTool + kBlock + kSteel;
  for (const char* servo : {"", "servo = \"ideal\"\n"}) {
    const run::CaseOutput out =
        run_named_case(small_scenario(kSlot, cut + kRecord + kCase + servo + heat(share)), "one");
    EXPECT_NEAR(power_in_slot(out), 0.25 * slot_power(), 1e-3 * slot_power()) << servo;
    EXPECT_EQ(out.result.heat.power.back(), 0.0) << "out of the block";
  }
}

// Teeth that are resolved heat with their average.
TEST(HeatRun, OfTheCutIsTheSameForSingleTeeth) {
  const std::string share = "kind = \"cutting\", share = 1.0";
  const std::string teeth = kTool + kBlock + kSteel + "force = \"instantaneous\"\n";
  const run::CaseOutput out =
      run_named_case(small_scenario(kSlot, teeth + kRecord + kCase + heat(share)), "one");
  EXPECT_NEAR(power_in_slot(out), slot_power(), 5e-3 * slot_power());
}

// A part of aluminium at 30 degC, held at X = 10 mm: a point 40 mm off shrinks by 40 mm alpha dT.
TEST(HeatRun, OfThePartIsTakenOffWhereItIsMeasured) {
  const std::string part =
      "[machine_override.heat.part]\nbody = \"head\"\nexpansion = \"23.5 um/m/K\"\n"
      "fixed_at_mm = [10.0, 0.0, 0.0]\n";
  const auto x_at_the_end = [&](const std::string& more, const std::string& start) {
    std::string warm = heat("kind = \"constant\", power_W = 0.0") + more;
    warm.replace(warm.find("20.0"), 4, start);
    warm.replace(warm.find("mean_degC = 20.0"), 16, "mean_degC = " + start);
    const run::CaseOutput out = run_named_case(
        small_scenario("G1 X50 F6000\nG4 P0.5\nM30\n", kRecord + kCase + warm), "one");
    return last(out.result.servo, "tool_position_true", 'X');
  };
  const double strain = 23.5e-6 * 10.0;
  EXPECT_NEAR(x_at_the_end(part, "30.0"), 10.0 + 40.0 / (1.0 + strain), 2e-5);
  EXPECT_NEAR(x_at_the_end(part, "20.0"), 50.0, 2e-5) << "at the reference temperature";
  EXPECT_NEAR(x_at_the_end("", "30.0"), 50.0, 2e-5) << "without a part";
}

// Ideal axes need no current; the spindle heats all the same.
TEST(HeatRun, OfIdealAxesHasTheSpindle) {
  const std::string source = "kind = \"spindle\", speed_rpm = [0, 8000], power_W = [0.0, 400.0]";
  const run::CaseOutput out = run_named_case(
      small_scenario(kStrokes, kRecord + kCase + "servo = \"ideal\"\n" + heat(source)), "one");
  const records::Series& servo = out.result.servo;
  EXPECT_GT(last(servo, "temperature_head"), 20.5);
  EXPECT_NEAR(last(servo, "tool_deviation", 'Z'), -2.0 * (last(servo, "temperature_head") - 20.0),
              1e-4);
}

// Powers of an hour and a half take no more memory than those of an hour, and are the same work.
TEST(HeatRun, CourseOfALongRunIsBounded) {
  const model::Scenario scenario = small_scenario(
      kStrokes,
      kRecord + kCase + heat("kind = \"spindle\", speed_rpm = [0, 6000], power_W = [0.0, 60.0]"));
  HeatBalance balance(scenario.machine);
  const auto of_hour = static_cast<int>(std::lround(3600.0 / HeatBalance::kStep));
  const auto of_step = static_cast<int>(std::lround(HeatBalance::kStep / 0.2e-3));
  double work = 0.0;
  HeatInputs now;
  for (int step = 0; step < of_hour * 3 / 2 + 1; ++step) {
    now.spindle = step % 7 * 90.0;  // rad/s
    const double power = 60.0 * now.spindle / (6000.0 * 2.0 * std::numbers::pi / 60.0);
    work += power * HeatBalance::kStep;
    for (int n = 0; n < of_step; ++n) balance.advance(now);
  }
  EXPECT_EQ(balance.steps(), of_hour * 3 / 2 + 1);
  const HeatCourse course = std::move(balance).course();
  EXPECT_LE(course.power.size(), 36'000U);
  EXPECT_DOUBLE_EQ(course.step, 2.0 * HeatBalance::kStep);
  EXPECT_NEAR(sum_of(course.power) * course.step, work, 1e-9 * work);
}

}  // namespace
}  // namespace servomill::sim::engine::heat_run_test
