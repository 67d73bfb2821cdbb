/// Correction of the tip under acceleration: closed forms, and residuals with knowledge of several
/// quality.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/registry.h"
#include "tests/sim/small_scenario.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::inertia_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPeriod = 0.2 * ms;

std::unique_ptr<SetpointPart> part_with(const std::vector<std::pair<const char*, double>>& values) {
  const Entry& entry = *find("inertia");
  Parameters parameters = default_parameters(entry);
  for (const auto& [name, value] : values) parameters.set(name, value);
  return entry.make(parameters, Action::compensate, identified_with({}))->setpoint();
}

Reading swinging(double t, double W, double amplitude) {
  Reading now;
  now.t = t;
  now.Q_ref[1] = amplitude * std::cos(W * t);
  now.dQ_ref[1] = -amplitude * W * std::sin(W * t);
  now.ddQ_ref[1] = -amplitude * W * W * std::cos(W * t);
  return now;
}

// Slowly, gain times acceleration.
TEST(Inertia, offsets_each_direction_by_gain_times_acceleration) {
  const auto part = part_with({{"XY_um_per_m_s2", 0.5 * um}, {"ZY_um_per_m_s2", -1.5 * um}});
  for (int n = 0; n < 5000; ++n) {
    const Reading now = swinging(n * kPeriod, 2.0, 0.1);
    const Joints d = part->advance(now);
    if (n < 1000) continue;
    EXPECT_NEAR(d[0], 0.5 * um * now.ddQ_ref[1], 0.5 * um * 0.4 * 0.006);
    EXPECT_NEAR(d[2], -1.5 * um * now.ddQ_ref[1], 1.5 * um * 0.4 * 0.006);
    EXPECT_EQ(d[1], 0.0);
    EXPECT_EQ(d.tail<2>(), (Joints::Zero().tail<2>()));
  }
  EXPECT_EQ(part->entry().entry, EntryPoint::before_filter);
  EXPECT_EQ(part->offset(Joints::Constant(0.1)), Joints::Zero());
}

// In steady state o = k G W^2 x of the path x = r + o with it: o = k G W^2 / (1 - k G W^2) r, signs
// by s^2 = -W^2.
TEST(Inertia, follows_the_response_of_the_mode) {
  const double f = 45.0, zeta = 0.1, W = 2.0 * kPi * 30.0, k = 1.5 * um;
  const auto part = part_with({{"YY_um_per_m_s2", k}, {"Y_frequency_Hz", f}, {"Y_damping", zeta}});
  const double w = 2.0 * kPi * f;
  const std::complex<double> G = w * w / std::complex<double>(w * w - W * W, 2.0 * zeta * w * W);
  double worst = 0.0, largest = 0.0;
  for (int n = 0; n < 10000; ++n) {
    const double t = n * kPeriod;
    const double d = part->advance(swinging(t, W, 1e-3))[1];
    if (t < 1.0) continue;
    const std::complex<double> kGss = -k * W * W * G;
    const double closed = (1e-3 * kGss / (1.0 - kGss) * std::polar(1.0, W * t)).real();
    worst = std::max(worst, std::abs(d - closed));
    largest = std::max(largest, std::abs(closed));
  }
  EXPECT_LE(worst, 1e-5 * largest);  // cubic between two periods
}

constexpr const char* kStructure =
    "[machine_override.inertial_deflection]\n"
    "XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 55.0, damping = 0.05 }\n"
    "YX = { gain_um_per_m_s2 = 0.3, frequency_Hz = 55.0, damping = 0.05 }\n"
    "YY = { gain_um_per_m_s2 = 1.2, frequency_Hz = 45.0, damping = 0.04 }\n";
constexpr const char* kModes =
    "X_frequency_Hz = 55.0\nX_damping = 0.05\nY_frequency_Hz = 45.0\nY_damping = 0.04\n";
constexpr const char* kMoves =
    "G21 G90 G94 G64 P0.005\n(MSG, path)\nG1 X20 F6000\nG3 X20 Y20 J10\nG1 "
    "X0\nG1 Y5\nM30\n";

std::string correcting(double share, const char* modes = kModes) {
  return fmt::format(
      "[[case.strategy]]\ntype = \"inertia\"\nXX_um_per_m_s2 = {}\nYX_um_per_m_s2 = "
      "{}\nYY_um_per_m_s2 = {}\n{}",
      1.0 * share, 0.3 * share, 1.2 * share, modes);
}

sim::records::Series servo_of(const std::string& text, const char* program = kMoves) {
  return sim::run_named_case(
             sim::small_scenario(program,
                                 text + "[record]\nperiod_ms = 0.2\nresolution_nm = 0.0\n"),
             "one")
      .result.servo;
}

// Largest distance of the tip to that of a rigid machine at the same instant (um), in the section
// "path".
double away(const std::string& servo, const std::string& strategy,
            const std::string& structure = kStructure, const char* program = kMoves) {
  const std::string one = "[[case]]\nname = \"one\"\nservo = \"" + servo + "\"\n";
  const sim::records::Series bent = servo_of(structure + one + strategy, program),
                             rigid = servo_of(one, program);
  EXPECT_EQ(bent.rows(), rigid.rows());
  const std::size_t column = *bent.column("tool_position_true", 'X'),
                    there = *rigid.column("tool_position_true", 'X'),
                    section = *bent.column("section");
  double most = 0.0;
  for (std::size_t n = 0; n < std::min(bent.rows(), rigid.rows()); ++n) {
    if (bent.at(n, section) != 1.0) continue;
    most = std::max(most, std::hypot(bent.at(n, column) - rigid.at(n, there),
                                     bent.at(n, column + 1) - rigid.at(n, there + 1)));
  }
  return most * mm / um;
}

double ideal_residual(const std::string& strategy) { return away("ideal", strategy); }

// Law: with perfect knowledge of modes and ideal axes at most 0.2 % of the deflection are left, on
// corners, too.
TEST(Inertia, with_perfect_knowledge_leaves_two_per_mille_on_ideal_axes) {
  const double without = ideal_residual("");
  EXPECT_GT(without, 3.0);
  const double perfect = ideal_residual(correcting(1.0));
  RecordProperty("residual", fmt::format("{:.3f} of {:.3f} um", perfect, without));
  EXPECT_LE(perfect, 0.002 * without);
}

// Static gains, across too, on a circle of 5 rad/s: the filter of 100 Hz is 1 % late.
TEST(Inertia, with_static_gains_leaves_five_per_cent_on_a_circle) {
  constexpr const char* kCircles =
      "G17 G21 G90 G94 G64 P0.001\nG0 X20 Y0\nG2 X20 Y0 I-20 F6000\nG2 X20 Y0 "
      "I-20\n(MSG, path)\nG2 X20 Y0 I-20\n(MSG, end)\nG2 X20 Y0 I-20\nM30\n";
  const std::string fixed =
      "[machine_override.inertial_deflection]\nXX = { gain_um_per_m_s2 = 1.0 }\n"
      "YX = { gain_um_per_m_s2 = 0.3 }\nYY = { gain_um_per_m_s2 = 1.2 }\n";
  const double without = away("ideal", "", fixed, kCircles);
  const double perfect = away("ideal", correcting(1.0, ""), fixed, kCircles);
  RecordProperty("residual", fmt::format("{:.4f} of {:.4f} um", perfect, without));
  EXPECT_NEAR(without, 0.6, 0.1);  // 1.2 um per m/s^2 and more at 0.5 m/s^2
  EXPECT_LE(perfect, 0.05 * without);
}

TEST(Inertia, leaves_the_share_of_the_gain_that_is_not_known) {
  const double without = ideal_residual("");
  for (const double share : {0.8, 1.2}) {
    EXPECT_NEAR(ideal_residual(correcting(share)), 0.2 * without, 0.03 * without) << share;
  }
}

// Known as static, a mode leaves its transients.
TEST(Inertia, ranks_knowledge_of_the_mode_above_the_static_gain) {
  const double perfect = ideal_residual(correcting(1.0)),
               fixed = ideal_residual(correcting(1.0, ""));
  EXPECT_GT(fixed, 3.0 * perfect);
  EXPECT_LT(fixed, ideal_residual(""));
}

// Real loops follow the offset like the path.
TEST(Inertia, leaves_real_loops_five_per_cent) {
  const double without = away("cascade", ""), corrected = away("cascade", correcting(1.0));
  RecordProperty("residual", fmt::format("{:.3f} of {:.3f} um", corrected, without));
  EXPECT_GT(without, 3.0);
  EXPECT_LE(corrected, 0.05 * without);
}

std::string refusal(const std::string& keys) {
  try {
    sim::small_scenario("M30\n",
                        "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"inertia\"\n" + keys);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("error: ") + 7);
  }
  return "taken";
}

// Beyond k = (1 - damping^2) / w^2 = 8.35 um per m/s^2 no path has the tip on it.
TEST(Inertia, refuses_gains_beyond_full_participation) {
  const auto gain = [](double k) {
    return part_with({{"XX_um_per_m_s2", k * um}, {"X_frequency_Hz", 55.0}, {"X_damping", 0.05}});
  };
  EXPECT_NE(gain(7.9), nullptr);
  try {
    gain(8.4);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "<input>: error: XX_um_per_m_s2 is beyond what a mode of X_frequency_Hz can have, (1 - "
        "damping^2) / w^2");
  }
}

std::string refusal_of(const std::vector<std::pair<const char*, double>>& keys) {
  try {
    part_with(keys);
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "none";
}

// k w_f^2 = 1 with the filter of 100 Hz; w / sqrt(1 - k w^2) = 250 Hz; XY and YX.
TEST(Inertia, refuses_offsets_that_move_the_tip_themselves) {
  EXPECT_EQ(refusal_of({{"XX_um_per_m_s2", 2.53 * um}}), "none");
  EXPECT_EQ(refusal_of({{"XX_um_per_m_s2", 2.54 * um}}),
            "XX_um_per_m_s2 must be within 2.53 um per m/s2 without X_frequency_Hz: larger "
            "static offsets move the tip by their own acceleration");
  EXPECT_EQ(refusal_of({{"XX_um_per_m_s2", 8.3 * um}, {"X_frequency_Hz", 55.0}}).substr(0, 61),
            "XX_um_per_m_s2 with X_frequency_Hz moves with its offset at 5");
  EXPECT_EQ(refusal_of({{"XY_um_per_m_s2", 0.1 * um}, {"YX_um_per_m_s2", 0.1 * um}}),
            "gains across axes lead back to the axis where they begin (XY and YX, for example); "
            "leave one of them out");
  EXPECT_EQ(refusal_of({{"XY_um_per_m_s2", 0.1 * um}, {"XZ_um_per_m_s2", 0.1 * um}}), "none");
}

TEST(Inertia, refuses_gains_and_modes_that_no_structure_has) {
  EXPECT_EQ(refusal("XX_um_per_m_s2 = 1001.0\n"),
            "case[0].strategy[0].XX_um_per_m_s2 = 1001.0; must be >= -1000 and <= 1000");
  EXPECT_EQ(refusal("X_frequency_Hz = -1.0\n"),
            "case[0].strategy[0].X_frequency_Hz = -1.0; must be >= 0 and <= 1000");
  EXPECT_EQ(refusal("X_damping = 1.0\n"),
            "case[0].strategy[0].X_damping = 1.0; must be >= 1e-06 and <= 0.99");
  EXPECT_EQ(refusal("model = \"one\"\n").substr(0, 44), "case[0].strategy[0].model is not known");
}

}  // namespace
}  // namespace servomill::strategies::inertia_test
