/// Circles and lines against the closed forms of linear servo loops (w = v / R).
///
/// Two axes go around a circle; what their loops do to a sine gives the radius that the machine
/// really makes, and how unequal they are the ellipse.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::circle_test {
namespace {

constexpr double kRadius = 50000.0;  // um
constexpr double kKv = 500.0 / 6.0;  // 1/s, 5 m/min/mm
constexpr double kWv = 200.0;        // rad/s, velocity loop of X and Y
constexpr double kTv = 0.2e-3;       // s, velocity period of CC424
// The motor's speed leads the measured one by half a period: speed is a difference over Tv.
constexpr double kLead = 0.5 * kTv;
constexpr double kFormTol = 2e-3;  // share: higher powers of w / Kv, stiffness of the drive

// Two circles about zero at constant feed (mm/min), the second of them recorded as `circle`.
model::Scenario circle(double feed, const std::string& toml) {
  return small_scenario(fmt::format("G17\nG64 P0.001\nG0 X50\nG3 X50 Y0 I-50 F{0}\n(MSG, circle)\n"
                                    "G3 X50 Y0 I-50 F{0}\n(MSG, out)\nG3 X50 Y0 I-50 F{0}\nM30\n",
                                    feed),
                        toml + "\n[[case]]\nname = \"alone\"\n");
}

struct Harmonics {
  double mean = 0.0;    // um, mean radius minus nominal
  double sine = 0.0;    // um, of the second harmonic: a sin 2 theta
  double cosine = 0.0;  // um
};

// Radius over the angle of the second circle, as a Fourier series in the angle of the setpoint.
Harmonics radius_of(const model::Scenario& scenario, const char* signal = "true_linear") {
  const run::CaseOutput out = run_named_case(scenario, "alone");
  const records::Series& s = out.result.servo;
  const auto name = std::find(out.sections.begin(), out.sections.end(), "circle");
  const auto index = static_cast<double>(name - out.sections.begin());
  const std::size_t section = *s.column("section"), x = *s.column(signal, 'X'),
                    y = *s.column(signal, 'Y');
  Harmonics h;
  double count = 0.0;
  for (std::size_t n = 0; n < s.rows(); ++n) {
    if (s.at(n, section) != index) continue;
    const double theta = std::atan2(s.at(n, y), s.at(n, x));
    const double r = 1000.0 * std::hypot(s.at(n, x), s.at(n, y)) - kRadius;
    h.mean += r;
    h.sine += 2.0 * r * std::sin(2.0 * theta);
    h.cosine += 2.0 * r * std::cos(2.0 * theta);
    count += 1.0;
  }
  EXPECT_GT(count, 100.0);
  return {h.mean / count, h.sine / count, h.cosine / count};
}

// Axes without quantisation, and friction only where `axis` says so.
std::string loops(const std::string& nc,
                  const std::string& axis = "motor_viscous_friction = 0.0\n") {
  std::string out = "[machine_override.nc]\nKv = \"5 m/min/mm\"\n" + nc;
  for (const char* letter : {"X", "Y"}) {
    out += fmt::format(
        "[machine_override.axis.{}]\nscale_step = 0.0\nmotor_step = 0.0\n"
        "slide_viscous_friction = 0.0\n{}",
        letter, axis);
  }
  return out;
}
constexpr const char* kLagMode = "velocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n";
constexpr const char* kVelocityForwardOnly = "acceleration_feed_forward = 0.0\n";
constexpr const char* kNoIntegral = "motor_viscous_friction = 0.0\nvelocity_reset_time_ms = 0.0\n";

double omega(double feed) { return feed / 60.0 * 1000.0 / kRadius; }  // rad/s; feed in mm/min

// Position loop in lag mode over a velocity loop of delay tau: R w^2 / (2 Kv^2) (2 Kv tau - 1).
double in_lag_mode(double feed, double tau) {
  const double q = omega(feed) / kKv;
  return 0.5 * kRadius * q * q * (2.0 * kKv * tau - 1.0);
}

TEST(Circle, ShrinksUnderAPositionLoopAlone) {
  for (const double feed : {2000.0, 4000.0}) {
    const double radius = radius_of(circle(feed, loops(kLagMode))).mean;
    const double expected = in_lag_mode(feed, -kLead);
    EXPECT_NEAR(radius, expected, kFormTol * std::abs(expected)) << feed;
    // the form without the lead is off by its stated share
    const double plain = kRadius * (1.0 / std::hypot(1.0, omega(feed) / kKv) - 1.0);
    EXPECT_NEAR(radius / plain, 1.0 + kKv * kTv, kFormTol) << feed;
  }
}

TEST(Circle, ShrinksLessWithViscousFrictionBehindTheIntegral) {
  // W = 1 - s b / Ki: the velocity loop lags by b / Ki
  constexpr double kViscous = 0.05, kKp = 3.4396, kTn = 0.02;
  const double tau = kViscous / (kKp / kTn) - kLead;
  const double expected = in_lag_mode(4000.0, tau);
  const double radius =
      radius_of(
          circle(4000.0, loops(kLagMode, fmt::format("motor_viscous_friction = {}\n", kViscous))))
          .mean;
  EXPECT_NEAR(radius, expected, 3.0 * kFormTol * std::abs(expected));  // Kp of X; Y has 9 % less
}

TEST(Circle, OfAProportionalVelocityLoopGrowsOrShrinksWithTwiceKvOverItsBandwidth) {
  const double tau = 1.0 / kWv - kLead;
  const double expected = in_lag_mode(4000.0, tau);
  EXPECT_NEAR(radius_of(circle(4000.0, loops(kLagMode, kNoIntegral))).mean, expected,
              0.01 * kRadius * std::pow(omega(4000.0) / kKv, 2) / 2.0);
}

TEST(Circle, GrowsWithVelocityFeedForwardAlone) {
  // + R w^2 / (Kv wv)
  const double w = omega(4000.0);
  const double expected = kRadius * w * w / kKv * (1.0 / kWv - kLead);
  EXPECT_NEAR(radius_of(circle(4000.0, loops(kVelocityForwardOnly, kNoIntegral))).mean, expected,
              0.01 * expected);
}

TEST(Circle, KeepsItsRadiusWithFullFeedForward) {
  const double w = omega(4000.0);
  const double unforwarded = kRadius * w * w / kKv / kWv;
  EXPECT_LT(std::abs(radius_of(circle(4000.0, loops(""))).mean), 0.05 * unforwarded);
}

TEST(Circle, IsAnEllipseWithUnequalKv) {
  // radial (v / 2) (1 / Kv_x - 1 / Kv_y) sin 2 theta, counter-clockwise
  const double other = 60.0;  // 1/s, of Y
  const Harmonics h =
      radius_of(circle(2000.0, loops(kLagMode) + fmt::format("Kv = \"{} 1/s\"\n", other)));
  const double v = 2000.0 / 60.0 * 1000.0;  // um/s
  const double expected = 0.5 * v * (1.0 / kKv - 1.0 / other);
  EXPECT_NEAR(h.sine, expected, 0.01 * std::abs(expected));
  EXPECT_LT(std::abs(h.cosine), 0.05 * std::abs(expected));
}

TEST(Circle, OnAMachineOutOfSquareIsAnEllipseAtFortyFiveDegrees) {
  // 1/2 R gamma sin 2 theta: the diagonals differ by 2 R gamma
  constexpr double kGamma = 50e-6;
  const model::Scenario scenario = circle(
      2000.0,
      "machine_errors = \"machine\"\n[errors.machine]\nEC0Y = { um_per_m = 50.0 }\n" + loops(""));
  const Harmonics ideal = radius_of(circle(2000.0, loops("")));
  const Harmonics h = radius_of(scenario, "tool_position_true");
  EXPECT_NEAR(std::abs(h.sine), 0.5 * kRadius * kGamma, 0.01 * 0.5 * kRadius * kGamma);
  EXPECT_LT(std::abs(ideal.sine), 0.01);
}

TEST(Line, WithUnequalKvRunsBesideItself) {
  // (v / 2) sin 2 alpha (1 / Kv_x - 1 / Kv_y)
  const double other = 60.0, alpha = std::atan2(30.0, 60.0);
  const model::Scenario scenario = small_scenario(
      "G0 X-30 Y-15\nG1 X30 Y15 F2000\nM30\n",
      loops(kLagMode) + fmt::format("Kv = \"{} 1/s\"\n", other) + "\n[[case]]\nname = \"alone\"\n");
  const run::CaseOutput out = run_named_case(scenario, "alone");
  const auto rows = rows_within(out.result.servo, 10.0, 20.0);
  const double v = 2000.0 / 60.0 * 1000.0;  // um/s
  const double expected = 0.5 * v * std::sin(2.0 * alpha) * std::abs(1.0 / kKv - 1.0 / other);
  EXPECT_NEAR(mean_of(out.result.servo, "contour_error", '\0', rows), expected, 0.01 * expected);
}

}  // namespace
}  // namespace servomill::sim::circle_test
