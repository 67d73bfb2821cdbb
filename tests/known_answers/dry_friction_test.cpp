/// Friction in closed servo loops: quadrant glitches, stick-slip, standing under load.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/axis_test_bench.h"
#include "sim/input/read_scenario.h"
#include "sim/metrology/circular_test.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::dry_friction_test {
namespace {

constexpr double kRadius = 50.0;  // mm

// One turn from diagonal to diagonal, counter-clockwise, with a run-in and a run-out of 30 deg.
model::Scenario circle(double feed, const std::string& axes) {
  const auto at = [](double degrees) {
    return fmt::format("X{:.9f} Y{:.9f}", kRadius * std::cos(degrees * deg),
                       kRadius * std::sin(degrees * deg));
  };
  const auto centre_from = [](double degrees) {
    return fmt::format("I{:.9f} J{:.9f}", -kRadius * std::cos(degrees * deg),
                       -kRadius * std::sin(degrees * deg));
  };
  return small_scenario(
      fmt::format("G17 G64 P0.001\nG0 {0}\nG3 {1} {2} F{6}\n(MSG, circle)\nG3 {1} {3}\n"
                  "(MSG, out)\nG3 {4} {5}\nM30\n",
                  at(15.0), at(45.0), centre_from(15.0), centre_from(45.0), at(75.0),
                  centre_from(45.0), feed),
      axes + "\n[[case]]\nname = \"alone\"\n");
}

metrology::CircularTurn turn_of(const model::Scenario& scenario) {
  const run::CaseOutput out = run_named_case(scenario, "alone");
  const records::Series& s = out.result.servo;
  const auto name = std::find(out.sections.begin(), out.sections.end(), "circle");
  const auto index = static_cast<double>(name - out.sections.begin());
  const std::size_t section = *s.column("section"), x = *s.column("true_linear", 'X'),
                    y = *s.column("true_linear", 'Y');
  std::vector<Eigen::Vector2d> points;
  for (std::size_t n = 0; n < s.rows(); ++n) {
    if (s.at(n, section) == index) points.emplace_back(s.at(n, x) * mm, s.at(n, y) * mm);
  }
  const metrology::Circle nominal = {{0.0, 0.0}, kRadius * mm};
  EXPECT_EQ(metrology::why_no_turn(points, nominal), std::nullopt);
  return metrology::evaluate_turn(points, nominal);
}

std::string friction(const std::string& model, const std::string& more = "") {
  std::string out = "[machine_override]\n" + more;
  for (const char* letter : {"X", "Y"}) {
    out += fmt::format("axis.{}.friction.model = \"{}\"\n", letter, model);
  }
  return out;
}

constexpr std::array kFeeds = {1000.0, 2000.0, 4000.0, 8000.0};  // mm/min
// um, of DOMAIN.md 4.2: range of the radial deviation about the least-squares centre
constexpr std::array kGlitch = {10.2, 15.5, 20.3, 21.8};
constexpr double kGlitchTol = 0.02;  // asked for 0.10; a model with steps of 20 us instead of exact

// 2 Fc r^2 / (Kp Kv): all of the reversal's torque made up by position error alone.
double upper_bound(int joint) {
  const model::MachineSettings machine =
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
  const auto& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  const auto& f = machine.drives[static_cast<std::size_t>(joint)].friction;
  return 2.0 * f.Fc_positive * c.r * c.r / (c.Kp * c.Kv);
}

TEST(QuadrantGlitch, OfLugreFrictionIsThatOfTheDomainTable) {
  EXPECT_NEAR(upper_bound(0), 31.8 * um, 0.05 * um);
  for (std::size_t n = 0; n < kFeeds.size(); ++n) {
    const metrology::CircularTurn turn = turn_of(circle(kFeeds[n], friction("lugre")));
    RecordProperty(fmt::format("glitch_um_F{:.0f}", kFeeds[n]),
                   fmt::format("{:.3f}", turn.G_least_squares / um));
    EXPECT_NEAR(turn.G_least_squares / um, kGlitch[n], kGlitchTol * kGlitch[n]) << kFeeds[n];
    for (const metrology::Reversal& reversal : turn.reversals) {
      EXPECT_GT(reversal.spike, 0.0) << "the axis stays behind: outward";
      EXPECT_LT(reversal.spike, upper_bound(reversal.axis)) << kFeeds[n];
    }
  }
}

// Without presliding the axis stands still until it breaks away: more than with bristles.
TEST(QuadrantGlitch, OfSetValuedFrictionIsLargerAndBelowTheBoundToo) {
  for (std::size_t n = 0; n < kFeeds.size(); ++n) {
    const metrology::CircularTurn turn = turn_of(circle(kFeeds[n], friction("set_valued")));
    RecordProperty(fmt::format("glitch_um_F{:.0f}", kFeeds[n]),
                   fmt::format("{:.3f}", turn.G_least_squares / um));
    EXPECT_GT(turn.G_least_squares / um, kGlitch[n]) << kFeeds[n];
    for (const metrology::Reversal& reversal : turn.reversals) {
      EXPECT_LT(reversal.spike, upper_bound(reversal.axis)) << kFeeds[n];
    }
  }
}

std::string compensation(const std::string& more) {
  std::string out;
  for (const char* letter : {"X", "Y"}) {
    out += fmt::format("[machine_override.axis.{}.friction_compensation]\ncoulomb = \"450 N\"\n{}",
                       letter, more);
  }
  return out;
}

double compensated(double feed, const std::string& more) {
  return turn_of(circle(feed, friction("lugre") + compensation(more))).G_least_squares / um;
}

// The torque turns over along the presliding curve: -2 Fc at first, which fades over Fc / sigma0.
TEST(FrictionCompensation, AlongThePreslidingCurveTakesMostOfTheGlitchAtEveryFeed) {
  constexpr double kMin = 3.5;  // factor; measured 3.9, 3.9, 5.0, 5.9
  for (std::size_t n = 0; n < kFeeds.size(); ++n) {
    const double left =
        compensated(kFeeds[n], "reversal_pulse = \"-900 N\"\nreversal_pulse_distance = \"9 um\"\n");
    RecordProperty(fmt::format("factor_F{:.0f}", kFeeds[n]),
                   fmt::format("{:.3f}", kGlitch[n] / left));
    EXPECT_LT(left, kGlitch[n] / kMin) << kFeeds[n];
  }
}

// Coulomb torque that turns over at once comes before the bristles have bent: it overshoots at low
// feed, where presliding takes long. A speed over which it turns over suits one feed only.
TEST(FrictionCompensation, ThatTurnsOverWithSpeedSuitsOneFeed) {
  EXPECT_GT(compensated(1000.0, ""), kGlitch[0]);
  EXPECT_LT(compensated(8000.0, ""), 0.5 * kGlitch[3]);
  EXPECT_LT(compensated(4000.0, "switch_velocity = \"2 mm/s\"\n"), kGlitch[2] / 5.0);
  EXPECT_GT(compensated(1000.0, "switch_velocity = \"2 mm/s\"\n"), 0.9 * kGlitch[0]);
}

// X alone, ideal encoders.
model::MachineSettings machine_with(plant::FrictionKind kind, double Fs, double vs) {
  model::MachineSettings machine =
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
  machine.scale.fill({});
  machine.motor.fill({});
  auto& friction = machine.drives[0].friction;
  friction.kind = kind;
  friction.Fs_positive = friction.Fs_negative = Fs;
  friction.vs = vs;
  return machine;
}

constexpr double kBase = 10e-6;  // s

// Motion of the slide after a move of 100 um at 1 mm/s, seen at its target.
class AfterMove {
 public:
  AfterMove(const model::MachineSettings& machine, double seconds) {
    frequency::AxisTestBench stand(machine, 0, 0, frequency::PositionLoop::closed);
    stand.settle(0.0);
    const auto end = static_cast<Tick>(std::lround(seconds / kBase));
    for (Tick n = 0; n < end; n += stand.hyperperiod()) {
      stand.run(n, move, [&](Tick, std::uint8_t, const frequency::AxisSignals& s) { look(s); });
    }
  }
  struct Span {
    double low = 1.0, high = -1.0;  // m
    double width() const { return high - low; }
  };
  /// Places (m, from the target) where the slide came to a stop, in order.
  std::vector<double> stops;
  /// Range of the slide's positions in each second.
  std::vector<Span> spans;

 private:
  static constexpr double kTravel = 100e-6, kSpeed = 1e-3;
  static frequency::StandInput move(Tick n) {
    const double t = static_cast<double>(n) * kBase;
    frequency::StandInput in;
    in.q = std::min(kSpeed * t, kTravel);
    in.dq = t < kTravel / kSpeed ? kSpeed : 0.0;
    return in;
  }
  void look(const frequency::AxisSignals& s) {
    const double x = s[frequency::index_of(frequency::AxisSignal::position)] - kTravel;
    const double v = s[frequency::index_of(frequency::AxisSignal::velocity)];
    if (v_ != 0.0 && v == 0.0) stops.push_back(x);
    v_ = v;
    const auto second = static_cast<std::size_t>(static_cast<double>(count_++) * kBase);
    if (second >= spans.size()) spans.push_back({});
    spans[second] = {std::min(spans[second].low, x), std::max(spans[second].high, x)};
  }
  double v_ = 0.0;
  std::size_t count_ = 0;
};

constexpr double kStill = 1e-9;  // m

using plant::FrictionKind;

// The integral part winds up until the slide breaks away; the friction that is then suddenly lower
// lets it jump to the other side of the target, and so on for ever. The drop has to come faster
// than the velocity loop damps: Fs = 2 Fc, lost within 0.1 mm/s.
TEST(Hunting, OfStictionUnderIntegralActionNeverEnds) {
  constexpr double kDecay = 1e-4;  // share by which the cycle may still change from stop to stop
  const AfterMove axis(machine_with(FrictionKind::set_valued, 900.0, 1e-4), 8.0);
  ASSERT_GT(axis.stops.size(), 30U);
  const double amplitude = std::abs(axis.stops.back());
  RecordProperty("amplitude_um", fmt::format("{:.4f}", amplitude / um));
  RecordProperty("stops", fmt::format("{}", axis.stops.size()));
  EXPECT_GT(amplitude, 5.0 * um);
  for (std::size_t n = axis.stops.size() - 20; n < axis.stops.size(); ++n) {
    EXPECT_NEAR(axis.stops[n], -axis.stops[n - 1], kDecay * amplitude) << "side to side";
  }
  EXPECT_NEAR(axis.spans[7].width(), axis.spans[4].width(), kDecay * amplitude);
}

// The breakaway force of the table (Fs = 1.24 Fc) is enough if it is lost within 0.03 mm/s.
TEST(Hunting, ShowsWithTheBreakawayForceOfTheTableToo) {
  constexpr double kDecay = 0.02;  // share; the cycle is reached slowly
  const AfterMove axis(machine_with(FrictionKind::set_valued, 560.0, 3e-5), 10.0);
  ASSERT_GT(axis.stops.size(), 10U);
  const double amplitude = std::abs(axis.stops.back());
  RecordProperty("amplitude_um", fmt::format("{:.4f}", amplitude / um));
  EXPECT_GT(amplitude, 1.0 * um);
  for (std::size_t n = axis.stops.size() - 4; n < axis.stops.size(); ++n) {
    EXPECT_NEAR(axis.stops[n], -axis.stops[n - 1], kDecay * amplitude);
  }
}

void expect_rest(const model::MachineSettings& machine) {
  const AfterMove axis(machine, 4.0);
  for (const std::size_t second : {2U, 3U}) {
    EXPECT_LT(axis.spans[second].width(), kStill) << second;
    EXPECT_NEAR(axis.spans[second].high, 0.0, kStill) << "at the target";
  }
}

// Nothing drops at breakaway: the slide leaves the stop and creeps to its target.
TEST(Hunting, IsNotThereWithCoulombFrictionAlone) {
  expect_rest(machine_with(FrictionKind::set_valued, 450.0, 1e-4));
}

// The table's Stribeck velocity of 2 mm/s: friction falls with at most 0.858 (Fs - Fc) / vs, which
// the velocity loop's Kp / r^2 outweighs, so that breaking away is no jump.
TEST(Hunting, IsNotThereWhereTheVelocityLoopDampsMoreThanTheStribeckCurveFalls) {
  const model::MachineSettings machine = machine_with(FrictionKind::set_valued, 560.0, 2e-3);
  const auto& c = machine.nc.cascade[0];
  const auto& f = machine.drives[0].friction;
  const double fall = std::sqrt(2.0 / std::numbers::e) * (f.Fs_positive - f.Fc_positive) / f.vs;
  EXPECT_LT(fall, c.Kp / (c.r * c.r));
  expect_rest(machine);
}

// Bristles give before they break: the loops reach the target within the presliding.
TEST(Hunting, IsNotThereWithPresliding) {
  expect_rest(machine_with(FrictionKind::lugre, 560.0, 2e-3));
  expect_rest(machine_with(FrictionKind::lugre, 900.0, 2e-3));
}

// Position of the slide after a long time under `input`.
template <class Input>
double rests_at(const model::MachineSettings& machine, double seconds, const Input& input) {
  frequency::AxisTestBench stand(machine, 0, 0, frequency::PositionLoop::closed);
  stand.settle(0.0);
  double x = 0.0;
  const auto end = static_cast<Tick>(std::lround(seconds / kBase));
  for (Tick n = 0; n < end; n += stand.hyperperiod()) {
    stand.run(n, input, [&](Tick, std::uint8_t, const frequency::AxisSignals& s) {
      x = s[frequency::index_of(frequency::AxisSignal::position)];
    });
  }
  return x;
}

double under_load(const model::MachineSettings& machine, double force) {
  return rests_at(machine, 2.0,
                  [&](Tick) { return frequency::StandInput{.added = {.force = force}}; });
}

// No error, hence no current: friction carries the load alone, and not a bit changes.
TEST(Standing, AnAxisInControlDoesNotMoveBelowBreakaway) {
  const model::MachineSettings machine = machine_with(FrictionKind::set_valued, 560.0, 2e-3);
  EXPECT_EQ(under_load(machine, 0.80 * 560.0), 0.0);
  EXPECT_EQ(under_load(machine, -0.999 * 560.0), 0.0);
  EXPECT_NE(under_load(machine, 1.001 * 560.0), 0.0);
}

// Without integral part the motor holds a position error with Kp Kv e / r^2.
TEST(Standing, TheDeadBandOfAProportionalLoopIsBreakawayOverItsStiffness) {
  model::MachineSettings machine = machine_with(FrictionKind::set_valued, 560.0, 2e-3);
  auto& c = machine.nc.cascade[0];
  c.Ki = 0.0;
  const double band = 560.0 * c.r * c.r / (c.Kp * c.Kv);
  EXPECT_NEAR(band, 19.8 * um, 0.05 * um);
  const auto moved = [&](double share) {
    return rests_at(machine, 1.0, [&](Tick n) {  // so slowly that nothing swings
      return frequency::StandInput{.q = share * band *
                                        std::min(1.0, static_cast<double>(n) * kBase / 0.5)};
    });
  };
  EXPECT_EQ(moved(0.99), 0.0);
  EXPECT_GT(moved(1.01), 0.0);
  EXPECT_EQ(moved(-0.99), 0.0);
  EXPECT_LT(moved(-1.01), 0.0);
}

}  // namespace
}  // namespace servomill::sim::dry_friction_test
