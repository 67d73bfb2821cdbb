#include "sim/standards/error_motion.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/sim/standards/reading_file.h"

namespace servomill::sim::standards::error_motion_test {

constexpr int kAngles = 360, kRevolutions = 20;
constexpr double kRounding = 1e-14;  // m

Eigen::ArrayXd angles() {
  return Eigen::ArrayXd::LinSpaced(kAngles, 0.0, 2.0 * std::numbers::pi * (kAngles - 1) / kAngles);
}

// Once, twice and three times a revolution: eccentricity, an ellipse, a triangle.
Eigen::ArrayXXd synchronous(double a1, double a2, double a3) {
  const Eigen::ArrayXd theta = angles();
  const Eigen::ArrayXd r =
      7.0 * um + a1 * (theta + 0.3).cos() + a2 * (2.0 * theta).cos() + a3 * (3.0 * theta).cos();
  return r.replicate(1, kRevolutions);
}

TEST(ErrorMotion, EccentricityIsTakenFromRadialNotFromAxial) {
  const Eigen::ArrayXXd r = synchronous(5.0 * um, 1.0 * um, 0.0);
  const ErrorMotion radial = evaluate_error_motion(angles(), r, Centre::least_squares_circle);
  EXPECT_NEAR(radial.synchronous, 2.0 * um, kRounding);
  EXPECT_NEAR(radial.total, 2.0 * um, kRounding);
  EXPECT_NEAR(radial.asynchronous, 0.0, kRounding);
  EXPECT_NEAR(radial.total_mrs, 2.0 * um, 1e-4 * um);
  const ErrorMotion axial = evaluate_error_motion(angles(), r, Centre::polar_chart);
  EXPECT_NEAR(axial.fundamental, 10.0 * um, kRounding);
  EXPECT_NEAR(axial.residual, 2.0 * um, kRounding);
  EXPECT_GT(axial.synchronous, 10.0 * um);
}

// A disturbance at half the rotational frequency: of opposite sign in every other revolution.
TEST(ErrorMotion, AsynchronousIsTheWidthOverTheRevolutions) {
  Eigen::ArrayXXd r = synchronous(0.0, 1.0 * um, 0.0);
  for (int j = 0; j < kRevolutions; ++j) r.col(j) += (j % 2 == 0 ? 0.4 : -0.4) * um;
  const ErrorMotion one = evaluate_error_motion(angles(), r, Centre::least_squares_circle);
  EXPECT_NEAR(one.asynchronous, 0.8 * um, kRounding);
  EXPECT_NEAR(one.synchronous, 2.0 * um, kRounding);
  EXPECT_NEAR(one.total, 2.8 * um, kRounding);
}

TEST(ErrorMotion, MinimumRadialSeparationIsNeverWider) {
  const Eigen::ArrayXXd r = synchronous(3.0 * um, 1.0 * um, 0.7 * um);
  const ErrorMotion one = evaluate_error_motion(angles(), r, Centre::least_squares_circle);
  EXPECT_LE(one.total_mrs, one.total + kRounding);
  EXPECT_GT(one.total_mrs, 0.5 * one.total);
}

std::string rows(int revolutions, double skip = 0.0) {
  std::string text = "revolution,angle_deg,x_um,y_um,z_um,x2_um,y2_um\n";
  for (int n = 1; n <= revolutions; ++n) {
    for (int k = 0; k < 36; ++k) {
      const double theta = (10.0 * k + (n == 2 ? skip : 0.0)) * deg;
      // an orbit of 0.5 um at twice the frequency: seen by a rotating sensitive direction as one of
      // once per revolution, which the centre takes away
      const double x = 0.5 * std::cos(2.0 * theta), y = 0.5 * std::sin(2.0 * theta);
      text += fmt::format("{},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", n, theta / deg, x, y,
                          0.2 * std::sin(theta), 3.0 * x, y);
    }
  }
  return text;
}

double value(const Report& report, std::string_view symbol) {
  for (const ReportValue& one : report.values) {
    if (one.symbol == symbol) return one.value;
  }
  ADD_FAILURE() << symbol;
  return 0.0;
}

TEST(ErrorMotion, SensorsOfAFile) {
  const ReadingFile file(rows(3));
  const Report report = rotation_report(read_rotation(file.path(), 50.0 * mm));
  constexpr double kDigits = 1e-12;  // m, of what is written
  EXPECT_NEAR(value(report, "radial_x_synchronous"), 1.0 * um, kDigits);
  EXPECT_NEAR(value(report, "radial_rotating_synchronous"), 0.0, kDigits);
  EXPECT_NEAR(value(report, "axial_fundamental"), 0.4 * um, kDigits);
  EXPECT_NEAR(value(report, "tilt_x_synchronous"), 2.0 * um / (50.0 * mm), kDigits / mm);
  EXPECT_NEAR(value(report, "tilt_y_synchronous"), 0.0, kDigits / mm);
}

TEST(ErrorMotion, FilesThatAreNoRevolutions) {
  const auto message = [](const std::string& text, double distance) {
    return message_of(text, [&](const std::string& path) { return read_rotation(path, distance); });
  };
  EXPECT_EQ(
      message(rows(2), 0.0),
      "--distance: error: is required with x2_um and y2_um: their distance from x_um and y_um");
  EXPECT_EQ(message(rows(2, 1.0), 0.05),
            "readings.csv:38:3: error: angle 1.000000 is 1 deg off that of the first revolution; "
            "readings must be triggered at the same angles");
  std::string text = rows(2);
  text.erase(text.rfind("2,350"));
  EXPECT_EQ(message(text, 0.05),
            "readings.csv:72: error: revolution 2 has 35 angles, the first 36: every revolution "
            "needs the same number");
  EXPECT_EQ(message("angle_deg,force\n0,1\n", 0.0),
            "readings.csv: error: has no sensor: columns x_um, y_um (radial), z_um (axial), x2_um, "
            "y2_um (radial at a second position)");
}

}  // namespace servomill::sim::standards::error_motion_test
