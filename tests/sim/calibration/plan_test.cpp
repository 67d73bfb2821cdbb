#include "sim/calibration/plan.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/structure.h"
#include "sim/calibration/make_up.h"
#include "sim/calibration/measurable.h"
#include "sim/calibration/plan_candidates.h"
#include "sim/model/machine.h"
#include "tests/number_of.h"
#include "tests/sim/calibration/shop.h"
#include "tests/text.h"

namespace servomill::sim::calibration::plan_test {
namespace {

model::MachineSettings gantry_machine() {
  model::MachineSettings machine;
  machine.chain = gantry();
  machine.nc.upper << 1.0, 0.8, 0.4, 0.0, 0.0;
  return machine;
}

PlanSettings a_day() {
  return {.instruments = {PlanInstrument::laser, PlanInstrument::level, PlanInstrument::square,
                          PlanInstrument::ballbar},
          .time = 8.0 * 3600.0,
          .tool_lengths = {0.15}};
}

const Plan& plan_of_a_day() {
  static const Plan plan = plan_calibration(gantry_machine(), a_day(), nullptr);
  return plan;
}

TEST(Plan, StaysWithinItsTimeAndBeatsLinesThroughTheMiddle) {
  const Plan& plan = plan_of_a_day();
  double time = 0.0;
  for (const PlannedSetUp& one : plan.set_ups) time += one.count * one.time;
  EXPECT_LE(time, a_day().time);
  EXPECT_LT(plan.after, 0.5 * plan.usual);
  EXPECT_LT(plan.usual, plan.before);
  EXPECT_LE(plan.bound, plan.after);
  EXPECT_NEAR(plan.efficiency, std::pow(plan.bound / plan.after, 2), 1e-12);
}

TEST(Plan, ComesNearTheBoundWhereThereIsTime) {
  PlanSettings week = a_day();
  week.time *= 5.0;
  const Plan plan = plan_calibration(gantry_machine(), week, nullptr);
  EXPECT_GT(plan.efficiency, 0.95);
  EXPECT_LE(plan.efficiency, 1.0 + 1e-9);
}

// The uncertainty of the plan is what machines that are measured by it turn out to have.
TEST(Plan, SimulatedMachinesConfirmIt) {
  const model::MachineSettings machine = gantry_machine();
  const Plan& plan = plan_of_a_day();
  readings::Readings empty = planned_readings(plan);
  CalibrationSettings forms;
  forms.form_linear.degree = 3;
  boost::random::mt19937_64 generator(1);
  boost::random::normal_distribution<double> normal;
  const Unknowns unknowns = calibrate(empty, machine.chain, forms).adjustment.unknowns;
  const int machines = number_of("SERVOMILL_CALIBRATIONS", 12);
  const Eigen::Vector3d p_ST(0.0, 0.0, -0.15);
  double worst = 0.0;
  std::vector<double> squares(8, 0.0);
  for (int m = 0; m < machines; ++m) {
    plant::ErrorModel truth;
    for (const SoughtLocation& location : unknowns.locations) {
      truth.location(location.name) = 50e-6 * normal(generator);
    }
    for (const SoughtFunction& f : unknowns.functions) {
      Eigen::VectorXd c(f.basis.size());
      for (double& x : c) x = (is_linear(f.name.direction) ? 10e-6 : 20e-6) * normal(generator);
      truth.component(f.name) = f.basis.function(c);
    }
    readings::Readings taken = empty;
    make_up(taken, machine.chain, truth, std::uint64_t(m));
    const Calibration found = calibrate(std::move(taken), machine.chain, forms);
    const plant::VolumetricModel actual(machine.chain, truth);
    const plant::VolumetricModel adjusted(machine.chain, found.adjustment.errors);
    for (unsigned corner = 0; corner < 8; ++corner) {
      Joints Q = Joints::Zero();
      for (int j = 0; j < 3; ++j) {
        Q[j] = machine.nc.upper[j] * ((corner >> unsigned(j) & 1U) != 0U ? 0.95 : 0.05);
      }
      squares[corner] +=
          (actual.error(Q, p_ST).dp_W - adjusted.error(Q, p_ST).dp_W).squaredNorm() / machines;
    }
  }
  for (const double one : squares) worst = std::max(worst, std::sqrt(one));
  std::printf("worst tip: planned %.3f um, simulated %.3f um\n", plan.after * 1e6, worst * 1e6);
  EXPECT_GT(worst, 0.6 * plan.after);
  EXPECT_LT(worst, 1.6 * plan.after);
}

TEST(Plan, AsksForNothingThatReadingsSayAlready) {
  const model::MachineSettings machine = gantry_machine();
  const Plan& first = plan_of_a_day();
  const readings::Readings taken = planned_readings(first);
  const Plan second = plan_calibration(machine, a_day(), &taken);
  EXPECT_NEAR(second.before, first.after, 1e-3 * first.after);
  EXPECT_LT(second.after, second.before);
}

TEST(Plan, RefusesMachinesWithoutTravelAndInstrumentsWithoutUse) {
  model::MachineSettings machine = gantry_machine();
  PlanSettings settings = a_day();
  settings.instruments = {PlanInstrument::probe};
  EXPECT_EQ(fault_messages([&] { plan_calibration(machine, settings, nullptr); }),
            "none of them applies to this machine\n");
  machine.nc.upper.setZero();
  EXPECT_EQ(fault_messages([&] { plan_calibration(machine, a_day(), nullptr); }),
            "has no travel_mm in the machine file; a plan needs it\n");
}

PlanSettings circles_only() {
  return {.instruments = {PlanInstrument::ballbar}, .time = 900.0, .tool_lengths = {0.15}};
}

// A circle of a ball bar takes 15 min (README.md).
TEST(Plan, RefusesATimeThatIsTooShortForAnySetUp) {
  PlanSettings settings = circles_only();
  settings.time = 899.0;
  EXPECT_EQ(fault_messages([&] { plan_calibration(gantry_machine(), settings, nullptr); }),
            "must be at least 0.25: the shortest set-up of these instruments takes 15 min\n");
  settings.time = 900.0;
  const Plan plan = plan_calibration(gantry_machine(), settings, nullptr);
  EXPECT_EQ(planned_readings(plan).groups.size(), 1U);
}

// Readings of a thousandth of their uncertainty leave less than one circle can lower.
TEST(Plan, RefusesATimeInWhichNothingIsGained) {
  readings::Readings taken = planned_readings(plan_of_a_day());
  for (readings::Group& group : taken.groups) group.uncertainty = 1e-3 * *group.uncertainty;
  PlanSettings settings = circles_only();
  EXPECT_EQ(fault_messages([&] { plan_calibration(gantry_machine(), settings, &taken); }),
            "no set-up of these instruments lowers the uncertainty of the TCP in this time; raise "
            "it or add --instruments\n");
}

// Two unknowns: one is determined, of the other less than is known already.
TEST(Measurable, PartsWhatSetUpsCannotTell) {
  Eigen::MatrixXd known = Eigen::Vector2d(4.0, 1.0).asDiagonal();
  Eigen::MatrixXd measured = Eigen::Vector2d(40.0, 0.05).asDiagonal();
  const Measurable parted = measurable({{measured, 1.0}}, known, 10.0);  // ten times: 400, 0.5
  ASSERT_EQ(parted.beyond.cols(), 1);
  EXPECT_NEAR(parted.beyond(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(parted.beyond(1, 0)), 1.0, 1e-12);  // its standard deviation
  EXPECT_TRUE(parted.projector.isApprox(Eigen::Matrix2d(Eigen::Vector2d(1.0, 0.0).asDiagonal())));
  EXPECT_EQ(measurable({{measured, 1.0}}, known, 30.0).beyond.cols(), 0);  // 1.5
}

// The variances of both parts add up to that of all, whatever has been taken.
TEST(Measurable, PartsAreIndependent) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(5, 5), B = Eigen::MatrixXd::Random(3, 5);
  const Eigen::MatrixXd known = A * A.transpose() + Eigen::MatrixXd::Identity(5, 5);
  const Eigen::MatrixXd measured = 1e3 * B.transpose() * B;  // of rank 3
  const Measurable parted = measurable({{measured, 1.0}}, known, 1.0);
  ASSERT_EQ(parted.beyond.cols(), 2);
  const Eigen::RowVectorXd k = Eigen::RowVectorXd::Random(5);
  const auto variance = [&](const Eigen::RowVectorXd& row) {
    return (row * (known + 0.3 * measured).inverse() * row.transpose())(0);
  };
  const double beyond = (k * parted.beyond).squaredNorm();
  EXPECT_NEAR(variance(k * parted.projector) + beyond, variance(k), 1e-9 * variance(k));
}

// A ball bar tells nothing of the table's C beside what no linear axis shares.
TEST(Plan, SaysWhatNoSetUpCanTell) {
  model::MachineSettings machine;
  machine.chain = plant::make_chain(plant::parse_structure("[w C A b X Y Z t]"));
  machine.nc.lower << -0.3, -0.3, -0.4, -1.0, 0.0;
  machine.nc.upper << 0.3, 0.3, 0.0, 1.0, 0.0;
  PlanSettings settings = a_day();
  settings.instruments = {PlanInstrument::ballbar};
  settings.time = 3600.0;
  const Plan day = plan_calibration(machine, settings, nullptr);
  EXPECT_GT(day.beyond, day.after);
  EXPECT_NE(std::find(day.untold.begin(), day.untold.end(), "EAC"), day.untold.end());
  EXPECT_EQ(std::find(day.untold.begin(), day.untold.end(), "EC0Y"), day.untold.end());
  EXPECT_LT(day.after, 0.9 * day.before);  // of what it tells
  EXPECT_NE(report(day, settings).find("errors that none of these set-ups determines"),
            std::string::npos);
  // levels see no turn about the vertical
  EXPECT_EQ(plan_of_a_day().untold, std::vector<std::string>{"ECZ"});
}

TEST(PlanCandidates, StayWithinTheTravel) {
  const model::MachineSettings machine = gantry_machine();
  for (const PlannedSetUp& one : plan_candidates(machine, a_day())) {
    EXPECT_GT(one.time, 0.0);
    for (const readings::Reading& row : one.group.rows) {
      for (int j = 0; j < 3; ++j) {
        EXPECT_GE(row.Q[j], -1e-12) << one.group.name;
        EXPECT_LE(row.Q[j], machine.nc.upper[j] + 1e-12) << one.group.name;
      }
    }
  }
}

}  // namespace
}  // namespace servomill::sim::calibration::plan_test
