/// The exact response of sampled loops against closed forms.
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/axis_dynamics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/bode.h"
#include "sim/frequency/margins.h"
#include "sim/frequency/stability.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency::frequency_response_test {
namespace {

constexpr int kY = 1;
constexpr Complex kJ{0.0, 1.0};

Complex s_of(double f) { return kJ * 2.0 * std::numbers::pi * f; }

model::MachineSettings hsm600u() {
  return input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
}
plant::FeedDriveParams& drive_of(model::MachineSettings& machine) { return machine.drives[kY]; }
controllers::CascadeParams& cascade_of(model::MachineSettings& machine) {
  return machine.nc.cascade[kY];
}

void set_periods(model::MachineSettings& machine, double base, Tick ticks) {
  machine.nc.periods = {base, ticks, ticks, ticks};
  for (auto& cascade : machine.nc.cascade) cascade.Tv = machine.nc.periods.seconds(ticks);
}

ResponseAt open_position_loop(FrequencyResponse& response) {
  return [&](double f) {
    return ratio(response.at(Entry::setpoint, f), AxisSignal::reading, AxisSignal::position_error);
  };
}
ResponseAt open_velocity_loop(FrequencyResponse& response) {
  return [&](double f) {
    return ratio(response.at(Entry::velocity_command, f), AxisSignal::measured_speed,
                 AxisSignal::speed_error);
  };
}

// Motor speed per current of two masses with spring and damper (SI).
Complex two_mass(const plant::FeedDriveParams& p, Complex s) {
  const Complex link = p.c + p.k / s, slide = p.M * s + p.b_load;
  return p.Kt / (p.J * s + p.b_motor + p.r * p.r * link * slide / (link + slide));
}

// The current has a kink at every new command; seen at ticks h apart, its harmonics near multiples
// of 1/h fold onto the fundamental: less than a tenth of f h.
constexpr double kFolding = 0.1;

TEST(FrequencyResponse, OfTheDriveIsThatOfTwoMasses) {
  model::MachineSettings machine = hsm600u();
  FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
  for (const double f : logarithmic(1.0, 2000.0, 60)) {
    const Complex exact =
        ratio(response.at(Entry::setpoint, f), AxisSignal::motor_speed, AxisSignal::current);
    EXPECT_LT(std::abs(exact / two_mass(drive_of(machine), s_of(f)) - 1.0),
              kFolding * f * machine.nc.periods.base)
        << f << " Hz";
  }
}

// DOMAIN.md section 9: f_a = sqrt(k/M) / 2 pi, f_r = sqrt(k (1/M + r^2/J)) / 2 pi.
TEST(FrequencyResponse, ShowsAntiresonanceAndResonance) {
  model::MachineSettings machine = hsm600u();
  plant::FeedDriveParams& p = drive_of(machine);
  p.c = 200.0;  // little, so that the extremes lie at the undamped frequencies
  p.b_load = p.b_motor = 0.0;
  FrequencyResponse response(machine, kY, 0, PositionLoop::open);
  double fa = 0.0, fr = 0.0, least = 1e300, most = 0.0;
  for (const double f : logarithmic(60.0, 200.0, 3000)) {
    const double size = std::abs(ratio(response.at(Entry::current_command, f),
                                       AxisSignal::motor_speed, AxisSignal::current));
    if (size < least) least = size, fa = f;
    if (size > most) most = size, fr = f;
  }
  const double wa = std::sqrt(p.k / p.M), wr = std::sqrt(p.k * (1.0 / p.M + p.r * p.r / p.J));
  RecordProperty("antiresonance", fmt::format("{:.3f} Hz", fa));
  RecordProperty("resonance", fmt::format("{:.3f} Hz", fr));
  constexpr double kGridTol = 5e-4;  // spacing of the frequencies
  EXPECT_NEAR(fa / (wa / (2.0 * std::numbers::pi)), 1.0, kGridTol);
  EXPECT_NEAR(fr / (wr / (2.0 * std::numbers::pi)), 1.0, kGridTol);
}

// A force F moves the slide until the velocity loop's proportional part holds it: x = F r^2 / (Kp
// Kv). With an integral part, x = s F r^2 / (Ki Kv) (1 + Ki / (k r^2)): the motor turns by F / k.
TEST(FrequencyResponse, OfAForceIsTheServoStiffnessAtLowFrequencies) {
  model::MachineSettings machine = hsm600u();
  controllers::CascadeParams& c = cascade_of(machine);
  const double compliance = c.r * c.r / (c.Kp * c.Kv);
  const auto x_per_F = [&](double f) {
    FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
    return response.at(Entry::force, f)[index_of(AxisSignal::position)];
  };
  constexpr double kLow = 1e-3;     // Hz; all lags are shorter than 0.1 s
  constexpr double kLowTol = 1e-3;  // 2 pi kLow 0.1 s
  const double wind_up = 1.0 + c.Ki / (drive_of(machine).k * c.r * c.r);
  const Complex with_integral = s_of(kLow) * c.r * c.r / (c.Ki * c.Kv) * wind_up;
  EXPECT_LT(std::abs(x_per_F(kLow) / with_integral - 1.0), kLowTol);
  c.Ki = 0.0;
  const Complex without = x_per_F(kLow);
  RecordProperty("um_per_kN", fmt::format("{:.4f}", without.real() * 1e9));
  EXPECT_LT(std::abs(without / compliance - 1.0), kLowTol);
}

TEST(FrequencyResponse, OfAnIdealRigidDriveIsFirstOrder) {
  model::MachineSettings machine = hsm600u();
  set_periods(machine, 1e-6, 10);
  drive_of(machine).kind = plant::DriveKind::rigid;
  drive_of(machine).T_i = 1e-5;
  controllers::CascadeParams& c = cascade_of(machine);
  c.Kv = 20.0;
  c.Kp = 8000.0 * c.J;  // rad/s
  c.Ki = 0.0;
  FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
  const auto T = [&](double f) {
    return response.at(Entry::setpoint, f)[index_of(AxisSignal::position)];
  };
  const ClosedLoop closed = closed_loop_of(curve_of(T, logarithmic(0.1, 100.0, 60)), T);
  const double expected = c.Kv / (2.0 * std::numbers::pi);
  RecordProperty("bandwidth", fmt::format("{:.5f} Hz of {:.5f} Hz", closed.bandwidth, expected));
  constexpr double kVelocityLoopShare = 0.01;  // Kv / velocity bandwidth, and friction
  EXPECT_NEAR(closed.bandwidth / expected, 1.0, kVelocityLoopShare);
  EXPECT_EQ(closed.peak, 1.0) << "no overshoot";
}

// The whole cascade without sampling: PI and P on a drive with a first-order current lag.
Complex continuous_open_loop(model::MachineSettings& machine, double f) {
  const plant::FeedDriveParams& p = drive_of(machine);
  const controllers::CascadeParams& c = cascade_of(machine);
  const Complex s = s_of(f), lag = 1.0 / (p.T_i * s + 1.0), G = two_mass(p, s);
  const Complex C = (c.Kp + c.Ki / s) / p.Kt * lag;
  const Complex velocity = C * G / (1.0 + C * G);
  const Complex link = p.c * s + p.k;  // x / (r phi)
  return c.Kv / s * velocity * link / (p.M * s * s + p.b_load * s + link);
}

TEST(FrequencyResponse, TendsToTheContinuousCascadeWithThePeriods) {
  model::MachineSettings machine = hsm600u();
  const auto deviation = [&](Tick ticks) {
    set_periods(machine, 1e-6, ticks);
    FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
    const ResponseAt L = open_position_loop(response);
    double worst = 0.0;
    for (const double f : {3.0, 13.0, 40.0, 96.0, 123.0, 200.0}) {
      worst = std::max(worst, std::abs(L(f) / continuous_open_loop(machine, f) - 1.0));
    }
    return worst;
  };
  const double coarse = deviation(40), fine = deviation(20);
  RecordProperty("deviation", fmt::format("{:.3e} {:.3e}", coarse, fine));
  // holds and the command's delay are of first order in the period
  constexpr double kOrderTol = 0.05;
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, kOrderTol);
  EXPECT_LT(fine, 2.0 * std::abs(s_of(200.0)) * 20e-6) << "two periods late";
}

TEST(FrequencyResponse, OfALateReadingIsLateByTheDelay) {
  const model::MachineSettings machine = hsm600u();
  FrequencyResponse fresh(machine, kY, 0, PositionLoop::closed);
  const ResponseAt L = open_position_loop(fresh);
  double worst = 0.0;
  for (const Tick delay : {1, 10, 19}) {
    FrequencyResponse late(machine, kY, delay, PositionLoop::closed);
    const ResponseAt L_late = open_position_loop(late);
    for (const double f : {1.0, 10.0, 100.0, 500.0}) {
      const Complex shift = std::exp(-s_of(f) * machine.nc.periods.seconds(delay));
      worst = std::max(worst, std::abs(L_late(f) / L(f) / shift - 1.0));
    }
  }
  RecordProperty("worst", fmt::format("{:.2e}", worst));
  // the slide moves smoothly between readings but for what the hold excites above 2.5 kHz
  constexpr double kHoldTol = 2e-3;
  EXPECT_LT(worst, kHoldTol);
}

// The same loop cut in another way: the velocity loop alone, driven at its command.
TEST(FrequencyResponse, OfTheOpenLoopIsKvTimesThatOfTheVelocityLoopIntegrated) {
  model::MachineSettings machine = hsm600u();
  FrequencyResponse closed(machine, kY, 0, PositionLoop::closed);
  FrequencyResponse alone(machine, kY, 0, PositionLoop::open);
  const ResponseAt L = open_position_loop(closed);
  double worst = 0.0;
  for (const double f : {1.0, 10.0, 60.0, 123.0, 300.0}) {
    const Complex x = alone.at(Entry::velocity_command, f)[index_of(AxisSignal::position)];
    worst = std::max(worst, std::abs(cascade_of(machine).Kv * x / L(f) - 1.0));
  }
  RecordProperty("worst", fmt::format("{:.2e}", worst));
  constexpr double kAliasTol = 1e-3;  // readings at 5 kHz fold what the slide does above
  EXPECT_LT(worst, kAliasTol);
}

TEST(FrequencyResponse, OfTheOpenLoopExistsForAnUnstableClosedOne) {
  model::MachineSettings machine = hsm600u();
  FrequencyResponse stable(machine, kY, 0, PositionLoop::closed);
  cascade_of(machine).Kv *= 20.0;
  ASSERT_GT(spectral_radius(machine, kY, 0), 1.0);
  FrequencyResponse unstable(machine, kY, 0, PositionLoop::closed);
  constexpr double kRounding = 1e-6;  // states from A to um in one matrix
  for (const double f : {1.0, 13.0, 123.0, 1000.0}) {
    const Complex gain = open_position_loop(unstable)(f) / open_position_loop(stable)(f);
    EXPECT_LT(std::abs(gain / 20.0 - 1.0), kRounding) << f;
  }
}

// Eigenvalues know nothing of frequency responses: at the gain margin they reach the unit circle.
TEST(Margins, OfGainIsWhereTheEigenvaluesReachTheUnitCircle) {
  constexpr double kRadiusTol = 1e-7;
  for (const bool slow : {false, true}) {
    model::MachineSettings machine = hsm600u();
    if (slow) {
      machine.nc.periods.position = 180;
      machine.nc.periods.velocity = 60;
      for (auto& cascade : machine.nc.cascade) cascade.Tv = 0.6e-3;
    }
    const double Tp = machine.nc.periods.seconds(machine.nc.periods.position);
    FrequencyResponse response(machine, kY, 0, PositionLoop::closed);
    const ResponseAt L = open_position_loop(response);
    const Margins m = margins_of(curve_of(L, logarithmic(1.0, 0.5 / Tp, 300)), L);
    ASSERT_LT(m.gain, 100.0);
    cascade_of(machine).Kv *= m.gain;
    RecordProperty(fmt::format("position_{}", slow),
                   fmt::format("{:.4f} at {:.3f} Hz", m.gain, m.gain_frequency));
    EXPECT_NEAR(spectral_radius(machine, kY, 0), 1.0, kRadiusTol);
  }
}

TEST(Margins, OfTheVelocityLoopAreWhereItBeginsToOscillate) {
  constexpr double kRadiusTol = 1e-7;
  model::MachineSettings machine = hsm600u();
  const double Tv = cascade_of(machine).Tv;
  FrequencyResponse response(machine, kY, 0, PositionLoop::open);
  const ResponseAt L = open_velocity_loop(response);
  const Margins m = margins_of(curve_of(L, logarithmic(1.0, 0.5 / Tv, 300)), L);
  RecordProperty("velocity", fmt::format("{:.4f} at {:.3f} Hz, {:.3f} deg at {:.3f} Hz", m.gain,
                                         m.gain_frequency, m.phase / deg, m.crossover));
  EXPECT_LT(velocity_spectral_radius(machine, kY), 1.0);
  cascade_of(machine).Kp *= m.gain;
  cascade_of(machine).Ki *= m.gain;
  EXPECT_NEAR(velocity_spectral_radius(machine, kY), 1.0, kRadiusTol);
}

// L = K / (s (s + 1)^2): phase crossing at 1 rad/s with |L| = K / 2.
TEST(Margins, OfAKnownLoop) {
  const double K = 0.5;
  const ResponseAt L = [&](double f) {
    const Complex s = s_of(f);
    return K / (s * (s + 1.0) * (s + 1.0));
  };
  for (const bool exact : {true, false}) {
    const Margins m =
        margins_of(curve_of(L, logarithmic(1e-3, 10.0, 400)), exact ? L : ResponseAt{});
    // |L| = 1 where w (w^2 + 1) = K: w = 0.4238538 for K = 0.5
    const double w = 0.4238537990680, tol = exact ? 1e-8 : 1e-4;
    EXPECT_NEAR(m.gain, 4.0, 4.0 * tol);
    EXPECT_NEAR(m.gain_frequency * 2.0 * std::numbers::pi, 1.0, tol);
    EXPECT_NEAR(m.crossover * 2.0 * std::numbers::pi, w, tol);
    EXPECT_NEAR(m.phase, std::numbers::pi / 2.0 - 2.0 * std::atan(w), tol);
    EXPECT_EQ(m.reduction, Margins::kNone);
  }
}

// The resonance of C, hardly damped, is narrower than the distance of the points for drawing; the
// largest values are against a search that is fine enough to see it at every tenth of its width.
TEST(Margins, SeeANarrowResonance) {
  constexpr int kC = 4;
  constexpr double kPeakTol = 2e-4;        // of a peak between two points of the search
  constexpr double kPhaseTol = 0.2 * deg;  // over one step of the search
  constexpr double kRingTol = 1e-3;        // of a frequency: much less than the width
  constexpr double kSearchFrom = 331.8, kSearchTo = 333.2;  // Hz, with the peak within
  struct Loop {
    double damping, wv;  // N m s/rad, rad/s
  };
  for (const Loop& loop : {Loop{1.0, 40.0}, {0.3, 20.0}, {0.03, 20.0}}) {
    model::MachineSettings machine = hsm600u();
    machine.drives[kC].c = loop.damping;
    controllers::CascadeParams& cascade = machine.nc.cascade[kC];
    cascade.Ki *= loop.wv * cascade.J / cascade.Kp;
    cascade.Kp = loop.wv * cascade.J;
    BodeSettings settings;
    settings.loop = BodeLoop::velocity;
    settings.measure = false;
    const BodeResult result = bode(machine, kC, 0, settings);
    ASSERT_TRUE(result.stable);

    FrequencyResponse response(machine, kC, 0, PositionLoop::open);
    const ResponseAt L = open_velocity_loop(response);
    double sensitivity = 0.0, peak = 0.0, margin = Margins::kNone;
    Complex last = 0.0;
    for (const double f : logarithmic(kSearchFrom, kSearchTo, 3000)) {
      const Complex here = L(f);
      sensitivity = std::max(sensitivity, 1.0 / std::abs(1.0 + here));
      if (last != 0.0 && (std::abs(last) > 1.0) != (std::abs(here) > 1.0)) {
        margin = std::min(margin, std::abs(std::arg(-here)));
      }
      peak = std::max(peak, std::abs(response.at(Entry::velocity_command,
                                                 f)[index_of(AxisSignal::motor_speed)]) *
                                machine.drives[kC].r);
      last = here;
    }
    EXPECT_NEAR(result.margins.sensitivity / sensitivity, 1.0, kPeakTol) << loop.damping;
    EXPECT_NEAR(std::abs(result.margins.phase), margin, kPhaseTol) << loop.damping;
    EXPECT_NEAR(result.closed.peak / peak, 1.0, kPeakTol) << loop.damping;

    const auto rings = ringing_frequencies(machine, kC, 0, PositionLoop::open, result.nyquist);
    const auto rings_there = [&](double f) {
      return std::abs(f / result.closed.peak_frequency - 1.0) < kRingTol;
    };
    EXPECT_TRUE(std::any_of(rings.begin(), rings.end(), rings_there)) << loop.damping;
  }
}

}  // namespace
}  // namespace servomill::sim::frequency::frequency_response_test
