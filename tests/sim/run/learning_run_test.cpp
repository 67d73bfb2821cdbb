/// Iterative learning control: where repeated runs lead, by the response of the loops, and what
/// noise makes of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/offset_response.h"
#include "sim/run/run_output.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::learning_run_test {
namespace {

using Complex = std::complex<double>;

// X at 50 mm/s. Errors of Y over X that repeat every 2.5 mm swing at 20 Hz.
const std::string kLine = "G17 G21 G90 G94 G64 P0.01\nG1 X90 F3000\nM30\n";
constexpr double kFrequency = 20.0;  // Hz
const std::string kWave =
    "[errors.machine]\nEYX = { harmonic = { amplitude_um = 5.0, period_mm = 2.5 } }\n";
const std::string kEveryPeriod = "[record]\nperiod_ms = 0.2\nresolution_nm = 0.0\n";
// Y lags, so that its response falls with the frequency; X passes the errors on time.
const std::string kLagging =
    "[machine_override]\naxis.Y.velocity_feed_forward = 0.0\n"
    "axis.Y.acceleration_feed_forward = 0.0\n";
const std::string kSlowerKnown = "[case.strategy.machine]\naxis.Y.Kv = 60.0\n";
const std::string kIgnore = "limits = \"ignore\"\n";

std::string one_case(const std::string& name, const std::string& more = "") {
  return fmt::format("[[case]]\nname = \"{}\"\nmachine_errors = \"machine\"\n{}", name, more);
}

std::string learning(const std::string& more = "") {
  return "[[case.strategy]]\ntype = \"learning\"\n" + more;
}

// The filters as strategies/README.md has them, in this file's own words.
struct Filter {
  double cutoff, gain = 1.0, forgetting = 0.0;
  double Q(double f) const { return (1.0 - forgetting) / (1.0 + std::pow(f / cutoff, 4)); }
  Complex L(Complex P) const { return gain * std::conj(P) / (std::norm(P) + 0.05 * 0.05); }
  Complex step(double f, Complex P, Complex P_a) const { return Q(f) * (1.0 - L(P) * P_a); }
};

// Response of a joint to its offset.
Complex response_of(const model::MachineSettings& machine, Tick delay, int joint, double f) {
  return preparation::OffsetResponses(machine, {joint}, delay, std::nullopt).at(joint, f);
}

// Complex amplitude (um) of the tip along Y in the middle of the line, over whole swings.
Complex amplitude_of(const CaseOutput& one, double f) {
  const records::Series& servo = one.result.servo;
  const std::size_t y = *servo.column("tool_position_true", 'Y'), time = *servo.column("time");
  constexpr double kFrom = 0.6, kTo = 1.4, kSame = 1e-9;  // s
  Complex sum = 0.0;
  double rows = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    const double t = servo.at(n, time);
    if (t < kFrom - kSame || t > kTo - kSame) continue;
    sum += servo.at(n, y) * mm / um * std::polar(1.0, -2.0 * std::numbers::pi * f * t);
    rows += 1.0;
  }
  EXPECT_EQ(rows, 4000.0);
  return 2.0 * sum / rows;
}

// The error of Y that is left after some numbers of updates, of a machine whose response is not
// quite known.
struct Learnt {
  Complex e_0;             // um, without learning
  std::vector<Complex> e;  // um, after each of the numbers of updates
  Complex P, P_a;          // as it is known, actual
};

Learnt learnt(const Filter& filter, const std::vector<int>& updates) {
  std::string cases = one_case("plain");
  for (const int k : updates) {
    cases += one_case(fmt::format("{}", k),
                      learning(fmt::format("updates = {}\ncutoff_Hz = {}\ngain = {}\n"
                                           "forgetting = {}\n",
                                           k, filter.cutoff, filter.gain, filter.forgetting)) +
                          kIgnore + kSlowerKnown);
  }
  const model::Scenario scenario = small_scenario(kLine, kLagging + kEveryPeriod + kWave + cases);
  const auto run = [&](const std::string& name) {
    return amplitude_of(run_named_case(scenario, name), kFrequency);
  };
  const model::CaseSpec& spec = scenario.cases.back();
  const Tick delay = scenario.reading_delay_of(spec);
  Learnt out{run("plain"),
             {},
             response_of(*spec.strategies[0].machine, delay, 1, kFrequency),
             response_of(scenario.machine_of(spec), delay, 1, kFrequency)};
  for (const int k : updates) out.e.push_back(run(fmt::format("{}", k)));
  return out;
}

TEST(Learning, ChangesARepeatedErrorFromRunToRunAsItsFiltersDo) {
  const Filter filter{.cutoff = 25.0, .gain = 0.6};
  const Learnt one = learnt(filter, {1, 2, 3, 4});
  EXPECT_NEAR(std::abs(one.e_0), 5.0, 0.01);
  const double Q = filter.Q(kFrequency);
  const Complex step = filter.step(kFrequency, one.P, one.P_a);
  EXPECT_NEAR(Q, 0.709, 0.001);
  EXPECT_NEAR(std::abs(step), 0.21, 0.01);
  Complex e = one.e_0;
  const Complex limit = (1.0 - Q) / (1.0 - step) * one.e_0;
  for (std::size_t k = 0; k < one.e.size(); ++k) {
    e = step * e + (1.0 - Q) * one.e_0;
    EXPECT_LT(std::abs(one.e[k] - e), 0.005 * std::abs(one.e_0)) << k;
  }
  // monotonically, by that share in each run; later runs are as near as they come
  double before = std::abs(one.e_0 - limit);
  for (std::size_t k = 0; k < 2; ++k) {
    const double now = std::abs(one.e[k] - limit);
    EXPECT_NEAR(now / before, std::abs(step), 0.05 * std::abs(step)) << k;
    before = now;
  }
}

TEST(Learning, EndsAtTheLimitOfItsFilters) {
  for (const Filter& filter :
       {Filter{.cutoff = 25.0, .gain = 0.6}, Filter{.cutoff = 60.0, .gain = 1.0, .forgetting = 0.3},
        Filter{.cutoff = 18.0, .gain = 1.0, .forgetting = 0.1}}) {
    const Learnt one = learnt(filter, {10});
    const Complex limit =
        (1.0 - filter.Q(kFrequency)) / (1.0 - filter.step(kFrequency, one.P, one.P_a)) * one.e_0;
    RecordProperty(fmt::format("cutoff {}", filter.cutoff),
                   fmt::format("{:.4f} um, limit {:.4f} um", std::abs(one.e[0]), std::abs(limit)));
    EXPECT_LT(std::abs(limit), 0.7 * std::abs(one.e_0));
    EXPECT_LT(std::abs(one.e[0] - limit), 0.02 * std::abs(limit)) << filter.cutoff;
  }
}

// Noise of what is seen, white from row to row of the offset, on a machine without errors.
struct Noise {
  double moves = 0.0;      // um, rms of the tip along an axis by its offset
  double predicted = 0.0;  // um
  double seen = 0.0;       // um, rms of all linear axes in the last run that was learnt from
};

Noise noise_of(const Filter& filter) {
  constexpr double kNoise = 0.3, kRowPeriod = 0.6 * ms;  // um; 16 rows in a swing of the cutoff
  const std::string strategy =
      fmt::format("updates = 25\ncutoff_Hz = {}\ngain = {}\n", filter.cutoff, filter.gain) +
      kIgnore;
  const model::Scenario scenario = small_scenario(
      "G17 G21 G90 G94 G64 P0.01\nG4 P0.2\nG1 X90 F1500\nG4 P0.2\nM30\n",
      kEveryPeriod + "[errors.machine]\n" + one_case("silent", learning(strategy)) +
          one_case("noisy", learning(strategy + fmt::format("noise_um = {}\n", kNoise))));
  const CaseOutput silent = run_named_case(scenario, "silent"),
                   noisy = run_named_case(scenario, "noisy");
  const records::Series &a = silent.result.servo, &b = noisy.result.servo;
  const std::size_t tip = *a.column("tool_position_true", 'X'), time = *a.column("time");
  Noise out;
  double rows = 0.0, of_silent = 0.0;
  for (std::size_t n = 0; n < a.rows(); ++n) {
    if (a.at(n, time) < 0.3 || a.at(n, time) > silent.duration - 0.3) continue;
    for (std::size_t k = tip; k < tip + 3; ++k) {
      const double moves = (b.at(n, k) - a.at(n, k)) * mm / um;
      out.moves += moves * moves;
    }
    rows += 3.0;
  }
  out.moves = std::sqrt(out.moves / rows);
  out.seen = noisy.learnt[0].lesson.trials.back().rms / um;
  of_silent = silent.learnt[0].lesson.trials.back().rms / um;
  EXPECT_LT(of_silent, 0.1 * kNoise);
  const model::CaseSpec& spec = *scenario.find_case("noisy");
  const preparation::OffsetResponses P(scenario.machine_of(spec), {0, 1, 2},
                                       scenario.reading_delay_of(spec), std::nullopt);
  constexpr double kStep = 0.5;  // Hz
  double variance = 0.0;
  for (int joint = 0; joint < 3; ++joint) {
    for (double f = 0.5 * kStep; f < 0.5 / kRowPeriod; f += kStep) {
      const Complex PLQ = P.at(joint, f) * filter.L(P.at(joint, f)) * filter.Q(f);
      const double left = std::norm(filter.step(f, P.at(joint, f), P.at(joint, f)));
      variance += 2.0 * kStep * kNoise * kNoise * kRowPeriod * std::norm(PLQ) / (1.0 - left) / 3.0;
    }
  }
  out.predicted = std::sqrt(variance);
  // what is seen is noise beside the motion, along three axes
  EXPECT_NEAR(out.seen, std::sqrt(3.0 * (kNoise * kNoise + variance)), 0.05 * out.seen);
  return out;
}

// Noise x |P L Q|^2 / (1 - |Q (1 - L P)|^2) over all frequencies: a smaller gain averages runs.
TEST(Learning, MovesTheTipByTheNoiseOfAllItsRuns) {
  double before = 1.0;
  for (const double gain : {1.0, 0.4}) {
    const Noise one = noise_of({.cutoff = 100.0, .gain = gain});
    RecordProperty(fmt::format("gain {}", gain),
                   fmt::format("{:.4f} um, predicted {:.4f} um, seen {:.4f} um", one.moves,
                               one.predicted, one.seen));
    EXPECT_NEAR(one.moves, one.predicted, 0.1 * one.predicted) << gain;
    EXPECT_LT(one.moves, 0.7 * before);
    before = one.moves;
  }
}

// X lags by v/Kv, and Y errs over X: scales read the first alone.
TEST(Learning, CorrectsWhatIsSeen) {
  constexpr double kSlow = 2.5;  // Hz, 20 mm at 50 mm/s
  const model::Scenario scenario = small_scenario(
      "G17 G21 G90 G94 G64 P0.01\nG4 P0.2\nG1 X90 F3000\nG4 P0.2\nM30\n",
      "[machine_override]\naxis.X.velocity_feed_forward = 0.0\n" + kEveryPeriod +
          "[errors.machine]\nEYX = { harmonic = { amplitude_um = 5.0, period_mm = 20.0 } }\n" +
          one_case("plain") + one_case("scales", learning("sees = \"scales\"\n")) +
          one_case("tip", learning("sees = \"tip\"\n")));
  const auto lag_of = [](const CaseOutput& one) {
    const records::Series& servo = one.result.servo;
    const std::size_t x = *servo.column("tool_position_true", 'X');
    const std::size_t wanted = *servo.column("ref_linear", 'X');
    double most = 0.0;
    for (const std::size_t n : rows_within(servo, 30.0, 60.0)) {
      most = std::max(most, std::abs(servo.at(n, x) - servo.at(n, wanted)) * mm / um);
    }
    return most;
  };
  const CaseOutput plain = run_named_case(scenario, "plain"),
                   scales = run_named_case(scenario, "scales"),
                   tip = run_named_case(scenario, "tip");
  EXPECT_NEAR(lag_of(plain), 50e3 / (5e3 / 60.0), 1.0);
  EXPECT_LT(lag_of(scales), 0.05);
  EXPECT_LT(lag_of(tip), 0.05);
  EXPECT_NEAR(std::abs(amplitude_of(plain, kSlow)), 5.0, 0.01);
  EXPECT_NEAR(std::abs(amplitude_of(scales, kSlow)), 5.0, 0.01);
  EXPECT_LT(std::abs(amplitude_of(tip, kSlow)), 0.01);
}

// Every fault of a scenario, without the folder of its file.
std::string refusal(const std::string& toml) { return refusal_of("[errors.machine]\n" + toml); }

TEST(Learning, RefusesToKnowAnotherMachine) {
  const std::string another =
      "case one: strategy learning: machine is another one: its structure, the periods of its "
      "loops and nc.scale_delay_us must be those of the scenario's machine";
  for (const char* machine :
       {"\"machines/router_3axis.toml\"", "\"machines/generic_trunnion_ac.toml\"",
        "{ nc = { position_period_us = 400 } }", "{ nc = { scale_delay_us = 100 } }"}) {
    EXPECT_EQ(refusal(one_case("one", learning(fmt::format("machine = {}\n", machine)))),
              "small.toml:8:11: error: " + another);
  }
  EXPECT_EQ(refusal(one_case("one", learning("machine = { nc = { Kv = 60.0 } }\n"))), "accepted");
  EXPECT_EQ(
      refusal(one_case("one", learning("machine = 7\n"))),
      "small.toml:8:11: error: case[0].strategy[0].machine = 7; must be the name of a machine "
      "file, or a table of keys of the machine");
}

// The machine answers four times as much as it is known to.
TEST(Learning, RefusesAFilterThatDoesNotContract) {
  const std::string lagging =
      "[machine_override.nc]\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n";
  const auto with = [&](const std::string& more) {
    return lagging + one_case("one", learning(more + "machine = { nc = { Kv = 20.0 } }\n"));
  };
  EXPECT_EQ(refusal(with("")),
            "small.toml:10:8: error: case one: strategy learning: cutoff_Hz: the filter does not "
            "contract: at 25.6 Hz the next run would have 3.91 times the error of axis X; lower "
            "cutoff_Hz or the gain");
  EXPECT_EQ(refusal(with("gain = 0.3\n")), "accepted");
  EXPECT_EQ(refusal(with("cutoff_Hz = 5.0\n")), "accepted");
  // the same share by the filters
  const model::Scenario scenario = small_scenario(
      "G1 X10 F3000\nM30\n", lagging + "[errors.machine]\n" +
                                 one_case("one", learning("machine = { nc = { Kv = 20.0 } }\n")));
  const model::CaseSpec& spec = scenario.cases.front();
  const Tick delay = scenario.reading_delay_of(spec);
  const Filter filter{.cutoff = 100.0};
  EXPECT_NEAR(std::abs(filter.step(25.5, response_of(*spec.strategies[0].machine, delay, 0, 25.5),
                                   response_of(scenario.machine_of(spec), delay, 0, 25.5))),
              3.91, 0.02);
}

TEST(Learning, EndsTheCaseWithARunThatStops) {
  EXPECT_EQ(refusal("[machine_override.nc]\nfollowing_error_limit_mm = 0.001\n" +
                    one_case("one", learning())),
            "small.toml:9:8: error: case one: strategy learning: run 1 of the program stops: axis "
            "X: following error beyond 0.001 mm at 0.0044 s");
}

TEST(Learning, OccursOnceInACaseAndImposesNothing) {
  EXPECT_EQ(refusal(one_case("one", learning() + learning())),
            "small.toml:7:8: error: case one: strategy learning appears twice; each would correct "
            "the whole");
  EXPECT_EQ(refusal(one_case("one", learning("action = \"impose\"\n"))),
            "small.toml:8:1: error: case[0].strategy[0].action is not known");
}

// Encoders with noise, noise of what is seen, friction.
TEST(Learning, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto run = [](unsigned threads) {
    RunControl control;
    control.threads = threads;
    return run_scenario(
        small_scenario("G17 G64 P0.01\nG1 X5 F2000\nG3 X5 Y10 J5\nG1 X0\nM30\n",
                       "[machine_override]\nfriction_model = \"lugre\"\n"
                       "axis.X.scale = { period = \"20 um\", subdivision = 1024, position_noise = "
                       "\"20 nm\" }\n" +
                           kWave + one_case("plain") +
                           one_case("tip", learning("updates = 2\nnoise_um = 0.1\n")) +
                           one_case("scales", learning("updates = 2\nsees = \"scales\"\n"))),
        control);
  };
  const RunOutput reference = run(1);
  ASSERT_EQ(reference.cases.size(), 3U);
  EXPECT_NE(reference.cases[0].result.servo.by_rows(), reference.cases[1].result.servo.by_rows());
  for (const unsigned threads : {1U, 2U}) {
    const RunOutput again = run(threads);
    for (std::size_t k = 0; k < again.cases.size(); ++k) {
      EXPECT_GT(again.cases[k].result.servo.rows(), 500U);
      EXPECT_EQ(again.cases[k].result.servo.by_rows(), reference.cases[k].result.servo.by_rows())
          << again.cases[k].name << ", threads " << threads;
    }
  }
}

// Few rows make no offset: there are at least a hundred, whatever the cutoff.
TEST(Learning, RunsWithTheLowestCutoff) {
  const model::Scenario scenario =
      small_scenario("G17 G21 G90 G94\nG1 X2 F3000\nM30\n",
                     "[errors.machine]\nEXX = { um_per_m = 100.0 }\n" +
                         one_case("one", learning("cutoff_Hz = 0.1\nupdates = 2\n")));
  EXPECT_TRUE(run_named_case(scenario, "one").result.outcome.finished);
}

// The lag v/Kv of half the feed is half of it; geometric errors are those of any feed.
TEST(Learning, AtAnotherFeedKeepsWhatBelongsToThePlace) {
  const auto scenario = [](double share) {
    return small_scenario(
        "G17 G21 G90 G94 G64 P0.01\nG4 P0.2\nG1 X90 F3000\nG4 P0.2\nM30\n",
        "[machine_override]\naxis.X.velocity_feed_forward = 0.0\n"
        "[errors.machine]\nEYX = { harmonic = { amplitude_um = 5.0, period_mm = 20.0 } }\n" +
            one_case("one", learning(fmt::format("feed_share = {}\n", share))));
  };
  const double lag = 50e3 / (5e3 / 60.0);  // um
  for (const double share : {0.5, 1.0}) {
    const CaseOutput one = run_named_case(scenario(share), "one");
    const auto rows = rows_within(one.result.servo, 30.0, 60.0);
    EXPECT_NEAR(mean_of(one.result.servo, "tool_deviation", 'X', rows), -(1.0 - share) * lag,
                0.002 * lag)
        << share;
    // Y is corrected where the setpoint of X is, which X has not reached by so much more
    const double slope = 5.0 * 2.0 * std::numbers::pi / 20e3;  // um per um
    EXPECT_NEAR(largest_of(one.result.servo, "tool_deviation", 'Y', rows),
                slope * (1.0 - share) * lag, 0.05)
        << share;
  }
}

}  // namespace
}  // namespace servomill::sim::run::learning_run_test
