/// Structure that gives way to the acceleration of the axes, in whole runs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <complex>
#include <filesystem>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tests/sim/engine/circles.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::inertial_run_test {
namespace {

constexpr double kPi = std::numbers::pi;

const std::string kCase = "[[case]]\nname = \"one\"\n";
const std::string kRecord = "[record]\nperiod_ms = 0.2\n";

std::string structure(const std::string& pairs) {
  return "[machine_override.inertial_deflection]\n" + pairs;
}

std::vector<std::size_t> rows_of(const records::Series& servo, double section) {
  std::vector<std::size_t> rows;
  const std::size_t column = *servo.column("section");
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    if (servo.at(n, column) == section) rows.push_back(n);
  }
  return rows;
}

// Least-squares fit of X and Y of one signal to M (x, y) + constant, (x, y) the slides in mm.
Eigen::Matrix2d map_of(const records::Series& servo, const std::string& signal,
                       const std::vector<std::size_t>& rows) {
  const std::size_t x = *servo.column("true_linear", 'X'), e = *servo.column(signal, 'X');
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const std::size_t n : rows) {
    const Eigen::Vector3d a(servo.at(n, x), servo.at(n, x + 1), 1.0);
    normal += a * a.transpose();
    right += a * Eigen::RowVector2d(servo.at(n, e), servo.at(n, e + 1));
  }
  return (normal.inverse() * right).topRows<2>().transpose();
}

// Largest difference of two recordings in one signal over all rows and columns.
double difference(const records::Series& a, const records::Series& b, const std::string& signal) {
  EXPECT_EQ(a.rows(), b.rows());
  const std::size_t from = *a.column(signal, 'X'), to = *b.column(signal, 'X');
  double most = 0.0;
  for (std::size_t n = 0; n < std::min(a.rows(), b.rows()); ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      most = std::max(most, std::abs(a.at(n, from + c) - b.at(n, to + c)));
    }
  }
  return most;
}

// A point that turns at v on the radius R accelerates by (v/R)^2 R towards the centre: the tip is
// where I + (v/R)^2 K maps the slides.
TEST(InertialRun, maps_a_circle_by_the_identity_and_the_square_of_v_over_R_times_K) {
  constexpr double R = 20.0, v = 100.0;  // mm, mm/s
  const std::string pairs =
      "XX = { gain_um_per_m_s2 = 2.0 }\nXY = { gain_um_per_m_s2 = 0.6 }\nYX = { gain_um_per_m_s2 = "
      "-0.3 }\n"
      "YY = { gain_um_per_m_s2 = 1.0 }\n";
  const run::CaseOutput out = run_named_case(
      small_scenario(circles(R, 60.0 * v, 3), structure(pairs) + kCase + kRecord), "one");
  const records::Series& servo = out.result.servo;
  const auto rows = rows_of(servo, 1);
  const double turns = v / R;  // rad/s
  Eigen::Matrix2d K;
  K << 2.0, 0.6, -0.3, 1.0;                                                       // um/(m/s^2)
  const Eigen::Matrix2d deflection = map_of(servo, "inertial_deflection", rows);  // um/mm
  const Eigen::Matrix2d expected = turns * turns * K * 1e-3;                      // mm are 1e-3 m
  EXPECT_LE((deflection - expected).norm(), 1e-3 * expected.norm()) << deflection;
  // semi-axes of the path of the tip against those of the slides, by singular values
  const Eigen::Matrix2d tip = map_of(servo, "tool_position_true", rows);
  const Eigen::JacobiSVD<Eigen::Matrix2d> measured(tip),
      closed((Eigen::Matrix2d::Identity() + turns * turns * 1e-6 * K).eval());
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(measured.singularValues()[i] * R, closed.singularValues()[i] * R, 1e-6) << i;
  }
}

// With a mode, K is complex: k / (1 - r^2 + 2 i zeta r) with r = v / (R w).
TEST(InertialRun, maps_a_circle_by_the_response_of_a_mode) {
  constexpr double R = 2.0, v = 40.0, k = 1.0, f = 6.0, zeta = 0.2;  // mm, mm/s, um s^2/m, Hz
  const run::CaseOutput out = run_named_case(
      small_scenario(
          circles(R, 60.0 * v, 10),
          structure(fmt::format(
              "XX = {{ gain_um_per_m_s2 = {}, frequency_Hz = {}, damping = {} }}\n", k, f, zeta)) +
              kCase + kRecord),
      "one");
  const records::Series& servo = out.result.servo;
  const Eigen::Matrix2d map = map_of(servo, "inertial_deflection", rows_of(servo, 1));
  const double turns = v / R, r = turns / (2.0 * kPi * f);
  const std::complex<double> G = 1.0 / std::complex<double>(1.0 - r * r, 2.0 * zeta * r);
  const double scale = turns * turns * k * 1e-3;  // um/mm
  // clockwise: y is a quarter of a turn ahead of x
  EXPECT_NEAR(map(0, 0), scale * G.real(), 2e-3 * scale * std::abs(G));
  EXPECT_NEAR(map(0, 1), scale * G.imag(), 2e-3 * scale * std::abs(G));
  EXPECT_EQ(map(1, 0), 0.0);
}

const std::string kCorner =
    "G17 G21 G90 G94 G61\nG1 X60 F20000\n(MSG, corner)\nG4 P0.2\nG1 Y5\nM30\n";
const std::string kModes =
    "XX = { gain_um_per_m_s2 = 2.0, frequency_Hz = 45.0, damping = 0.04 }\n"
    "YX = { gain_um_per_m_s2 = 0.3 }\nYY = { gain_um_per_m_s2 = 0.8, frequency_Hz = 60.0, damping "
    "= 0.05 }\n";

// The machine stops: the tip swings on, and neither scale nor slide shows it.
TEST(InertialRun, overshoots_at_a_stop_and_decays_as_no_encoder_shows) {
  const std::string toml = kCase + kRecord;
  const run::CaseOutput rigid = run_named_case(small_scenario(kCorner, toml), "one");
  const run::CaseOutput bent =
      run_named_case(small_scenario(kCorner, structure(kModes) + toml), "one");
  for (const char* signal : {"meas_linear", "true_linear", "fb_linear", "current_linear"}) {
    EXPECT_EQ(difference(rigid.result.servo, bent.result.servo, signal), 0.0) << signal;
  }
  EXPECT_FALSE(rigid.result.servo.column("inertial_deflection", 'X').has_value());
  const records::Series& servo = bent.result.servo;
  const std::size_t e = *servo.column("inertial_deflection", 'X'), t = *servo.column("time"),
                    tip = *servo.column("tool_position_true", 'X'),
                    x = *servo.column("true_linear", 'X');
  const auto rows = rows_of(servo, 1);
  // the tip is at the slide plus the deflection
  for (const std::size_t n : rows) {
    ASSERT_NEAR((servo.at(n, tip) - servo.at(n, x)) * 1e3, servo.at(n, e), 2e-6);
  }
  // free decay from 60 ms after the stop on, when the loops have settled
  const double w = 2.0 * kPi * 45.0, decay = 0.04 * w, w_d = w * std::sqrt(1.0 - 0.04 * 0.04);
  const std::size_t first = rows.front() + 500;  // 100 ms
  constexpr std::size_t kStep = 25;              // 5 ms
  const double h = servo.at(first + kStep, t) - servo.at(first, t);
  double most = 0.0, worst = 0.0;
  for (std::size_t n = first; n < first + 250; ++n) {
    const double now = servo.at(n, e), next = servo.at(n + kStep, e),
                 last = servo.at(n + 2 * kStep, e);
    const double left = last - 2.0 * std::exp(-decay * h) * std::cos(w_d * h) * next +
                        std::exp(-2.0 * decay * h) * now;
    worst = std::max(worst, std::abs(left));
    most = std::max(most, std::abs(now));
  }
  EXPECT_GT(largest_of(servo, "inertial_deflection", 'X', rows), 0.1);  // um
  EXPECT_GT(most, 0.05);
  EXPECT_LE(worst, 0.01 * most);
  RecordProperty("largest_um", std::to_string(largest_of(servo, "inertial_deflection", 'X', rows)));
}

TEST(InertialRun, agrees_with_cvode) {
  const auto with = [](const std::string& integrator, const std::string& friction) {
    return run_named_case(
        small_scenario(kCorner, "[machine_override]\nintegrator = \"" + integrator +
                                    "\"\nfriction_model = \"" + friction + "\"\n" +
                                    structure(kModes) + kCase + kRecord),
        "one");
  };
  struct Limit {
    const char* friction;
    double um;
  };
  for (const Limit& one :
       {Limit{"none", 0.1e-3}, Limit{"lugre", 3e-3}, Limit{"set_valued", 3e-3}}) {
    const run::CaseOutput exact = with("exact", one.friction), cvode = with("cvode", one.friction);
    const double most = difference(exact.result.servo, cvode.result.servo, "inertial_deflection");
    EXPECT_LE(most, one.um) << one.friction;
    RecordProperty(std::string(one.friction) + "_nm", fmt::format("{:.2g}", most * 1e3));
  }
}

// The structure is coupled to the drives at the instants of a run; rows in between are more of
// them. The motion of the slides is the same to rounding, so that all that differs is the coupling.
TEST(InertialRun, halving_the_coupling_step_divides_the_error_by_four_at_least) {
  constexpr int kCoarse = 100, kExact = 10;  // us
  const auto with_rows_each = [](int us) {
    return run_named_case(
               small_scenario(
                   kCorner,
                   "[machine_override]\nfriction_model = \"none\"\n" +
                       structure("XX = { gain_um_per_m_s2 = 10000.0, frequency_Hz = 480.0, damping "
                                 "= 0.02 }\n") +
                       kCase + fmt::format("[record]\nperiod_ms = {}\n", us * 1e-3)),
               "one")
        .result.servo;
  };
  const records::Series exact = with_rows_each(kExact);
  const auto error_of = [&](int us) {
    const records::Series servo = with_rows_each(us);
    const std::size_t e = *servo.column("inertial_deflection", 'X'),
                      slide = *servo.column("true_linear", 'X');
    double most = 0.0;
    for (std::size_t n = 0; n * kCoarse / us < servo.rows(); ++n) {
      const std::size_t row = n * static_cast<std::size_t>(kCoarse / us),
                        same = n * static_cast<std::size_t>(kCoarse / kExact);
      if (same >= exact.rows()) break;
      EXPECT_NEAR(servo.at(row, slide), exact.at(same, slide), 1e-9);  // mm
      most = std::max(most, std::abs(servo.at(row, e) - exact.at(same, e)));
    }
    return most;
  };
  const double whole = error_of(kCoarse), half = error_of(kCoarse / 2);
  RecordProperty("whole_nm", fmt::format("{:.3g}", whole * 1e3));
  RecordProperty("half_nm", fmt::format("{:.3g}", half * 1e3));
  EXPECT_GT(whole, 1e-3);
  EXPECT_LE(half, whole / 4.0);
  EXPECT_NEAR(whole / half, 16.0, 3.0);  // the spline of the position is of order 4
}

TEST(InertialRun, of_ideal_axes_is_that_of_the_setpoint) {
  constexpr double R = 20.0, v = 100.0;
  const run::CaseOutput out = run_named_case(
      small_scenario(circles(R, 60.0 * v, 3),
                     structure("XX = { gain_um_per_m_s2 = 2.0 }\nYY = { gain_um_per_m_s2 = 1.0, "
                               "frequency_Hz = 60.0, damping = 0.2 }\n") +
                         kCase + "servo = \"ideal\"\n" + kRecord),
      "one");
  const records::Series& servo = out.result.servo;
  const Eigen::Matrix2d map = map_of(servo, "inertial_deflection", rows_of(servo, 1));
  const double scale = v * v / (R * R) * 1e-3, r = v / R / (2.0 * kPi * 60.0);
  const std::complex<double> G = 1.0 / std::complex<double>(1.0 - r * r, 2.0 * 0.2 * r);
  EXPECT_NEAR(map(0, 0), 2.0 * scale, 2e-3 * scale);
  EXPECT_NEAR(map(1, 1), G.real() * scale, 2e-3 * scale);
}

// Only one of the two cases has a deflection to record; each is as it is alone.
TEST(InertialRun, comes_back_from_its_file_beside_a_rigid_case) {
  const std::string bent =
      "[[case]]\nname = \"bent\"\nmachine_override = { inertial_deflection = { XX = { "
      "gain_um_per_m_s2 "
      "= "
      "1.0 } } }\n";
  const model::Scenario scenario = small_scenario(
      kCorner, kCase + bent + "[[quantity]]\nname = \"tool_deviation\"\naxis = \"X\"\n");
  const auto folder = std::filesystem::path(testing::TempDir()) / fmt::format("bent_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string path = folder / "bent.h5";
  run::RunStore store(path, false, scenario);
  for (const char* name : {"one", "bent"}) store.add(run_named_case(scenario, name));
  store.commit({});
  const run::StoredRun back = run::read_run(path);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(back.cases.size(), 2U);
  EXPECT_FALSE(back.cases[0].servo->column("inertial_deflection", 'X').has_value());
  EXPECT_TRUE(back.cases[1].servo->column("inertial_deflection", 'X').has_value());
  const auto both = run::run_scenario(scenario, {});
  EXPECT_EQ(both.cases[1].result.servo.by_rows(),
            run_named_case(scenario, "bent").result.servo.by_rows());
}

}  // namespace
}  // namespace servomill::sim::engine::inertial_run_test
