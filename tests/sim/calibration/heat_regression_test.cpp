// Errors per kelvin of temperature sensors from the drift of the tip.
#include "sim/calibration/heat_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plant/geometry/volumetric.h"
#include "plant/heat/temperature.h"
#include "plant/sensing/noise.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"
#include "sim/model/heat.h"

namespace servomill::sim::calibration::heat_regression_test {
namespace {

using plant::operator""_err;

const std::string kMachines = SERVOMILL_SOURCE_DIR "/scenarios/machines/";

const model::MachineSettings& machine() {
  static const auto kMachine =
      input::read_machine_description(kMachines + "hsm600u_heat.toml").machine;
  return *kMachine;
}

const std::vector<plant::ErrorName> kSought = {"EXX"_err, "EYY"_err, "EZZ"_err};

// True errors of the first two sensors.
std::vector<plant::ErrorModel> true_errors() {
  plant::ErrorModel ram, column;
  ram.component("EZZ"_err).polynomial = {-2.6 * um};
  ram.component("EYY"_err).polynomial = {-0.8 * um, 3e-6};
  column.component("EZZ"_err).polynomial = {1.2 * um};
  column.component("EXX"_err).polynomial = {0.3 * um, 10e-6};
  return {ram, column};
}

Joints pose(double x, double y, double c) {
  Joints Q = Joints::Zero();
  Q.head<3>() << x, y, 0.2;
  Q[4] = c;
  return Q;
}

// Two temperatures that rise with different time constants, read every 5 min for 8 h at each pose.
HeatReadings made_up(double noise, std::uint64_t seed = 0, bool alike = false) {
  HeatReadings out{"made up", {"ram", "column"}, {}};
  const std::vector<plant::ErrorModel> errors = true_errors();
  const std::vector<Joints> poses = {pose(0.0, 0.0, 0.0), pose(0.25, 0.0, 0.0),
                                     pose(-0.25, 0.0, 0.0), pose(0.0, 0.15, 0.0),
                                     pose(0.1, -0.15, 1.2)};
  Tick number = 0;
  for (int n = 0; n < 96; ++n) {
    const double t = 300.0 * n;
    const double ram = 8.0 * (1.0 - std::exp(-t / 1500.0));
    const double column = alike ? 0.5 * ram : 2.0 * (1.0 - std::exp(-t / 9000.0));
    const plant::VolumetricModel warm(machine().chain,
                                      scaled(errors[0], ram) + scaled(errors[1], column));
    for (const Joints& Q : poses) {
      HeatReading one{Q, {0.0, 0.0, -0.12}, {kelvin(20.0 + ram), kelvin(20.0 + column)}, {}};
      const Eigen::Vector3d dp = warm.first_order_error(Q, one.p_ST).dp_W;
      one.drift = plant::linear_jacobian(machine().chain, Q).transpose() * dp;
      one.drift += Eigen::Vector3d(5.0, -3.0, 2.0) * um;  // counts from anywhere
      const auto a = plant::white_noise({seed}, 0, number),
                 b = plant::white_noise({seed}, 1, number);
      one.drift += noise * Eigen::Vector3d(a[0], a[1], b[0]);
      ++number;
      out.rows.push_back(std::move(one));
    }
  }
  return out;
}

double true_value(const HeatTerm& term) {
  const std::vector<plant::ErrorModel> errors = true_errors();
  const auto& c = errors[static_cast<std::size_t>(term.sensor)].component(term.error);
  const std::size_t n = term.is_slope ? 1 : 0;
  return n < c.polynomial.size() ? c.polynomial[n] : 0.0;
}

TEST(HeatRegression, FindsWhatTheSensorsStandFor) {
  const HeatRegression found = regress(made_up(0.0), machine().chain, kSought);
  ASSERT_EQ(found.terms.size(), 10U);  // two sensors: three constants, slopes over X and Y
  EXPECT_EQ(found.numbers, 5U * 96U * 3U);
  for (const HeatTerm& term : found.terms) {
    EXPECT_NEAR(term.value, true_value(term), 1e-12) << to_string(term.error) << term.is_slope;
  }
  EXPECT_GT(found.before.z(), 3.0 * um);
  EXPECT_LT(found.after.norm(), 1e-12);
}

// Over many draws of noise the estimates scatter as their standard deviations state.
TEST(HeatRegression, StatesItsUncertainty) {
  constexpr int kDraws = 200;
  std::vector<double> squares(10, 0.0);
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const HeatRegression found = regress(made_up(0.5 * um, seed), machine().chain, kSought);
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const HeatTerm& term = found.terms[i];
      squares[i] += std::pow((term.value - true_value(term)) / term.sigma, 2);
    }
  }
  for (const double sum : squares) EXPECT_NEAR(sum / kDraws, 1.0, 0.35);  // 3.5 sigma of chi^2
}

// Tilts and location errors have no slope.
TEST(HeatRegression, SeeksSlopesOfErrorsAlongAxesOnly) {
  const HeatRegression found =
      regress(made_up(0.1 * um, 3), machine().chain, {"EZZ"_err, "EAX"_err, "EC0Y"_err});
  EXPECT_EQ(found.terms.size(), 6U);
  for (const HeatTerm& term : found.terms) EXPECT_FALSE(term.is_slope);
}

TEST(HeatRegression, TakesReadingsOfSomeDirectionsOnly) {
  HeatReadings readings = made_up(0.0);
  for (HeatReading& one : readings.rows) one.drift.head<2>().setConstant(std::nan(""));
  const HeatRegression found = regress(readings, machine().chain, {"EZZ"_err});
  ASSERT_EQ(found.terms.size(), 2U);
  EXPECT_NEAR(found.terms[0].value, -2.6 * um, 1e-12);
  EXPECT_NEAR(found.terms[1].value, 1.2 * um, 1e-12);
  EXPECT_EQ(found.numbers, 5U * 96U);
}

std::string refusal(const HeatReadings& readings, const std::vector<plant::ErrorName>& errors) {
  try {
    regress(readings, machine().chain, errors);
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "";
}

TEST(HeatRegression, RefusesWhatTheReadingsDoNotTell) {
  EXPECT_EQ(refusal(made_up(0.0, 0, true), {"EZZ"_err}),
            "cannot distinguish EZZ of ram, EZZ of column: their temperatures change in "
            "proportion; omit one, or measure where they differ");
  HeatReadings cold = made_up(0.0);
  for (HeatReading& one : cold.rows) one.T[1] = kelvin(20.0);
  EXPECT_EQ(refusal(cold, {"EZZ"_err}),
            "does not show EZZ of column: its sensor reading does not change, or the error does "
            "not affect the measured drift");
  HeatReadings few = made_up(0.0);
  few.rows.resize(5);
  EXPECT_EQ(refusal(few, kSought), "has too few readings for 10 unknowns");
}

// --- files --------------------------------------------------------------------------------------

struct Folder {
  Folder() : path(testing::TempDir() + "heat_regression_test/") {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path + name) << text;
    return path + name;
  }
  std::string path;
};

TEST(HeatReadings, ReadsATable) {
  const Folder folder;
  const std::string path =
      folder.write("day.csv",
                   "time_min,X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_mm,ram_degC,drift_Z_um,drift_X_um\n"
                   "# the second reading has no X\n"
                   "0,10,0,200,0,90,120,20.5,-1.5,0.25\n"
                   "5,10,0,200,0,90,120,21.0,-2.5,\n");
  const HeatReadings readings = read_heat_readings(path, machine());
  ASSERT_EQ(readings.rows.size(), 2U);
  EXPECT_EQ(readings.sensors, std::vector<std::string>{"ram"});
  const HeatReading& one = readings.rows[0];
  EXPECT_NEAR(one.Q[0], 0.01, 1e-15);
  EXPECT_NEAR(one.Q[4], 90.0 * deg, 1e-15);
  EXPECT_NEAR(one.p_ST.z(), -0.12, 1e-15);
  EXPECT_NEAR(one.T[0], 293.65, 1e-12);
  EXPECT_NEAR(one.drift.x(), 0.25 * um, 1e-18);
  EXPECT_TRUE(std::isnan(one.drift.y()));
  EXPECT_NEAR(one.drift.z(), -1.5 * um, 1e-18);
  EXPECT_TRUE(std::isnan(readings.rows[1].drift.x()));
}

TEST(HeatReadings, NamesAllFaultsOfATable) {
  const Folder folder;
  const auto faults = [&](const std::string& text) {
    std::string out;
    try {
      read_heat_readings(folder.write("day.csv", text), machine());
    } catch (const InputError& error) {
      for (const Fault& fault : error.faults()) {
        out += std::to_string(fault.place.line) + ": " + fault.message + "\n";
      }
    }
    return out;
  };
  EXPECT_EQ(faults("X_mm,Y_mm,Z_mm,B_deg,rams_degC\n0,0,0,0,20\n"),
            "0: needs a column C_deg: the position of every axis\n"
            "0: needs a column drift_X_um, drift_Y_um or drift_Z_um\n"
            "0: column rams_degC: the machine has no temperature sensor 'rams'; did you mean "
            "'ram'?; it has ram, column, bearing, table, bed\n");
  EXPECT_EQ(faults("X_mm,Y_mm,Z_mm,B_deg,C_deg,ram_degC,drift_Z_um\n0,0,0,0,0,,1\n"),
            "2: ram_degC is empty\n");
}

// The file is the machine with errors of its sensors, to the bit.
TEST(HeatRegression, IsReadBackFromItsFile) {
  const Folder folder;
  const HeatReadings readings = made_up(0.2 * um, 7);
  std::vector<plant::ErrorName> sought = kSought;
  sought.insert(sought.end(), {"EAX"_err, "EC0Y"_err});
  const HeatRegression found = regress(readings, machine().chain, sought);
  const std::string path = folder.path + "sensors.toml";
  input::write_identified_file(
      path,
      identified_file(found, readings,
                      input::machine_seen_from(path, kMachines + "hsm600u_heat.toml")),
      false);
  const auto read = input::read_machine_description(path).machine;
  ASSERT_EQ(read->heat->sensor_errors.size(), 2U);
  for (const HeatTerm& term : found.terms) {
    const plant::ThermalError& of =
        read->heat->sensor_errors[static_cast<std::size_t>(term.sensor)];
    EXPECT_EQ(read->heat->sensors[static_cast<std::size_t>(of.body)].name,
              found.sensors[static_cast<std::size_t>(term.sensor)]);
    const double value =
        term.error.is_location
            ? of.per_kelvin.location(term.error)
            : of.per_kelvin.component(term.error).polynomial.at(term.is_slope ? 1 : 0);
    EXPECT_NEAR(value, term.value, 1e-15 * (1.0 + std::abs(value)));
  }
}

}  // namespace
}  // namespace servomill::sim::calibration::heat_regression_test
