/// The virtual encoder by itself: both sides of its limits, lead and noise.
#include "strategies/feedback.h"

#include <gtest/gtest.h>

#include <limits>

#include "plant/sensing/encoder.h"
#include "strategies/approach_kernel.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::feedback_test {
namespace {

constexpr double kSlope = 0.01;  // m/m: EYX = kSlope x

IdentifiedMachine ramp_of_y_over_x() {
  plant::ErrorModel errors;
  errors.component({Axis::Y, Axis::X}) = plant::polynomial({0.0, kSlope});
  IdentifiedMachine identified = identified_with(errors);
  identified.reference.setZero();  // rotary axes, too: d is then along Y alone
  return identified;
}

struct Limits {
  double max_um = 1e9, max_rate_mm_per_s = 1e9, extrapolation_time_ms = 0.0, window_ms = 3.0;
};

Acting virtual_encoder(const IdentifiedMachine& identified, const Limits& limits) {
  const Entry entry = feedback_entry();
  Parameters parameters = default_parameters(entry);
  parameters.set("max_um", limits.max_um * um);
  parameters.set("max_rate_mm_per_s", limits.max_rate_mm_per_s * mm);
  parameters.set("extrapolation_time_ms", limits.extrapolation_time_ms * ms);
  parameters.set("velocity_window_ms", limits.window_ms * ms);
  return make_acting(entry, parameters, Action::compensate, identified);
}

Joints at_x(double x) {
  Joints Q = Joints::Zero();
  Q[0] = x;
  return Q;
}

// d = 10 um at x = 1 mm: inside +-10.1 um it passes bit for bit, outside it is cut exactly.
TEST(VirtualEncoder, LimitsTheDisplacement) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const Acting free = virtual_encoder(identified, {});
  const Acting limited = virtual_encoder(identified, {.max_um = 10.1});
  for (const double x : {0.2 * mm, 1.0 * mm, 1.0099 * mm, -1.0099 * mm}) {
    const Joints d = free.feedback->settle(at_x(x));
    EXPECT_NE(d[1], 0.0);
    EXPECT_EQ(limited.feedback->settle(at_x(x)), d) << x;
    EXPECT_EQ(limited.feedback->advance(at_x(x)), d) << x;
  }
  for (const double x : {1.0101 * mm, 50.0 * mm}) {
    for (const double sign : {1.0, -1.0}) {
      const Joints limit{0.0, sign * (10.1 * um), 0.0, 0.0, 0.0};
      EXPECT_EQ(limited.feedback->settle(at_x(sign * x)), limit) << x;
      EXPECT_EQ(limited.feedback->advance(at_x(sign * x)), limit) << x;
    }
  }
}

// 10 mm/s over a model period of 60 us is 0.6 um.
TEST(VirtualEncoder, LimitsTheRate) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const double most = 0.6 * um;
  for (const double sign : {1.0, -1.0}) {
    const Acting free = virtual_encoder(identified, {});
    const Acting limited = virtual_encoder(identified, {.max_rate_mm_per_s = 10.0});
    for (const auto* acting : {&free, &limited}) acting->feedback->settle(at_x(0.0));
    // inside: 0.599 um a period
    for (int n = 1; n <= 20; ++n) {
      const Joints Q = at_x(sign * n * 59.9 * um);
      EXPECT_EQ(limited.feedback->advance(Q), free.feedback->advance(Q)) << n;
    }
    // outside: a jump of 10 um is walked in steps of the limit, and then reached
    const double from = sign * 20 * 0.599 * um;
    const Joints Q = at_x(sign * (20 * 59.9 * um + 1.0 * mm));
    constexpr double kRounding = 1e-19;  // m, of the sum of some steps
    limited.feedback->advance(Q);        // the last of those inside acts
    for (int n = 1; n <= 16; ++n) {
      EXPECT_NEAR(limited.feedback->advance(Q)[1], from + sign * n * most, kRounding) << n;
    }
    free.feedback->advance(Q);
    const Joints wanted = free.feedback->advance(Q);
    EXPECT_NEAR(limited.feedback->advance(Q)[1], wanted[1], kRounding);
  }
}

// d = 10 um at x = 1 mm, limit 10.1 um: x runs at 1 mm a period from 0 to 20 mm and back. What is
// found at x >= 2 mm is limited, in the period after: 37 of them.
TEST(VirtualEncoder, TellsWhereItsSizeIsSaturated) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const Acting limited = virtual_encoder(identified, {.max_um = 10.1});
  const auto at = [](int n) { return at_x((n <= 20 ? n : 40 - n) * mm); };
  constexpr double kRounding = 1e-15;  // s
  const auto expect_found = [&](std::size_t lane) {
    const auto found = limited.feedback->saturations(lane);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].joint, 1);
    EXPECT_FALSE(found[0].of_rate);
    EXPECT_EQ(found[0].limit, 10.1 * um);
    EXPECT_NEAR(found[0].first, 3 * kModelPeriod, kRounding);  // found at n = 2, acts at n = 3
    EXPECT_NEAR(found[0].time, 37 * kModelPeriod, kRounding);
  };
  // one period after the other, eight at once, and among other runs
  limited.feedback->settle(at_x(0.0));
  EXPECT_TRUE(limited.feedback->saturations(0).empty());
  for (int n = 0; n <= 40; ++n) limited.feedback->advance(at(n));
  expect_found(0);
  limited.feedback->settle(at_x(0.0), 1);
  for (int n = 0; n <= 40;) {
    JointLanes Q{};
    std::size_t count = 0;
    for (; count < kLaneWidth && n <= 40; ++count, ++n) Q[0][count] = at(n)[0];
    limited.feedback->advance(Q, count, 1);
  }
  expect_found(1);
  limited.feedback->settle(at_x(0.0), 5);
  LaneFlags lanes{};
  lanes[5] = lanes[6] = true;  // run 6 stands still
  limited.feedback->settle(at_x(0.0), 6);
  for (int n = 0; n <= 40; ++n) {
    JointLanes Q{};
    Q[0].fill(90 * mm);  // of lanes without a run
    Q[0][5] = at(n)[0];
    Q[0][6] = 0.0;
    limited.feedback->advance(Q, lanes);
  }
  expect_found(5);
  EXPECT_TRUE(limited.feedback->saturations(6).empty());
}

// 0.6 um a period: 0.5 um pass, of 0.7 um 0.1 um are left each period.
TEST(VirtualEncoder, TellsWhereItsRateIsSaturated) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const Acting limited = virtual_encoder(identified, {.max_rate_mm_per_s = 10.0});
  limited.feedback->settle(at_x(0.0));
  for (int n = 1; n <= 100; ++n) limited.feedback->advance(at_x(-n * 50.0 * um));
  EXPECT_TRUE(limited.feedback->saturations(0).empty());
  for (int n = 1; n <= 12; ++n) limited.feedback->advance(at_x(-(5.0 * mm + n * 70.0 * um)));
  // the first of these is found in the period before: 11 have acted, and 1.1 um take two more
  for (int n = 0; n < 5; ++n) limited.feedback->advance(at_x(-(5.0 * mm + 12 * 70.0 * um)));
  const auto found = limited.feedback->saturations(0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].of_rate);
  EXPECT_EQ(found[0].limit, 10.0 * mm);
  constexpr double kRounding = 1e-15;  // s
  EXPECT_NEAR(found[0].first, 101 * kModelPeriod, kRounding);
  EXPECT_NEAR(found[0].time, 13 * kModelPeriod, kRounding);
}

TEST(VirtualEncoder, CountsASaturatedStandstillAsOnePeriod) {
  const Acting limited = virtual_encoder(ramp_of_y_over_x(), {.max_um = 10.1});
  limited.feedback->settle(at_x(-2 * mm));
  const auto found = limited.feedback->saturations(0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 0.0);
  EXPECT_EQ(found[0].time, kModelPeriod);
  limited.feedback->settle(at_x(0.5 * mm));  // another run
  EXPECT_TRUE(limited.feedback->saturations(0).empty());
}

// The model is looked up where the axis will be: with a steady velocity, exactly.
TEST(VirtualEncoder, LeadsByItsTime) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const Acting led = virtual_encoder(identified, {.extrapolation_time_ms = 12.0, .window_ms = 3.0});
  const double v = 20.0 * mm;  // m/s
  led.feedback->settle(at_x(0.0));
  double x = 0.0;
  for (int n = 1; n <= 51; ++n) {  // 50 periods of 60 us are the window
    x = n * v * kModelPeriod;
    led.feedback->advance(at_x(x));
  }
  double d = led.feedback->advance(at_x(x))[1];
  constexpr double kRounding = 1e-15;  // m
  EXPECT_NEAR(d, kSlope * (x + v * 12.0 * ms), kRounding);
  // standing still for a window, it leads nothing
  for (int n = 0; n < 51; ++n) d = led.feedback->advance(at_x(x))[1];
  EXPECT_NEAR(d, kSlope * x, kRounding);
}

// A reading with steps q gives a velocity with an error of up to q / window, hence a displacement
// with up to E' (q/2 + lead q / window): a longer window, less noise.
TEST(VirtualEncoder, KeepsTheStepsOfTheEncoderOutOfItsLead) {
  const IdentifiedMachine identified = ramp_of_y_over_x();
  const double lead = 12.0 * ms, q = 19.53125 * nm;
  const double v = 20.0137 * mm;  // no whole number of steps in any window
  const plant::Encoder encoder = plant::Encoder::with_step(q);
  const auto noise = [&](double window_ms) {
    const Acting led =
        virtual_encoder(identified, {.extrapolation_time_ms = lead / ms, .window_ms = window_ms});
    led.feedback->settle(at_x(0.0));
    double largest = 0.0;
    for (int n = 1; n < 2000; ++n) {
      const double d = led.feedback->advance(at_x(encoder.read(n * v * kModelPeriod)))[1];
      const double x = (n - 1) * v * kModelPeriod;  // d acts a period after its reading
      if (n > 500) largest = std::max(largest, std::abs(d - kSlope * (x + v * lead)));
    }
    RecordProperty("noise_nm_window_" + std::to_string(window_ms), std::to_string(largest / nm));
    return largest;
  };
  const auto bound = [&](double window) { return kSlope * (0.5 * q + lead * q / window); };
  for (const double window_ms : {0.3, 3.0, 15.0}) {
    EXPECT_LE(noise(window_ms), bound(window_ms * ms)) << window_ms;
    EXPECT_GE(noise(window_ms), 0.3 * bound(window_ms * ms)) << window_ms;
  }
  EXPECT_LT(noise(3.0), 0.2 * noise(0.3));
}

// Runs side by side, each with readings of its own, give the same bits together and alone: whatever
// the sign and the lead, one step or many, and whatever lanes of no concern hold.
TEST(VirtualEncoder, GivesTheSameBitsTogetherAndAlone) {
  plant::Uniform random(23);
  IdentifiedMachine identified = identified_with(plant::random_errors(random, 50e-6));
  identified.Kv << 60.0, 40.0, 40.0, 50.0, 50.0;  // leads that differ
  const Entry entry = feedback_entry();
  constexpr LaneFlags kRuns = {true, true, false, true, true, true, false, true};
  for (const Action action : kBothActions) {
    for (const bool lead : {false, true}) {
      for (const int way : {0, 1, 2, 3}) {
        Parameters parameters = default_parameters(entry);
        parameters.set("iterations", way % 2 == 0 ? std::string_view("1") : "converged");
        parameters.set("axes", way < 2 ? std::string_view("linear") : "all");
        if (lead) parameters.set("extrapolation_time_ms", std::string_view("auto"));
        const auto strategy = entry.make(parameters, action, identified);
        const auto together = strategy->feedback(kModelPeriod);
        std::vector<std::unique_ptr<FeedbackPart>> alone;
        std::vector<Joints> Q(kLaneWidth, identified.reference);
        JointLanes Q_lanes;
        for (LaneArray& of_joint : Q_lanes) of_joint.fill(std::numeric_limits<double>::quiet_NaN());
        for (std::size_t run = 0; run < kLaneWidth; ++run) {
          alone.push_back(strategy->feedback(kModelPeriod));
          if (!kRuns[run]) continue;
          for (int j = 0; j < kLinearJoints; ++j) Q[run][j] = 0.15 * random();
          EXPECT_EQ(alone[run]->settle(Q[run]), together->settle(Q[run], run));
        }
        for (int n = 0; n < 100; ++n) {
          for (std::size_t run = 0; run < kLaneWidth; ++run) {
            if (!kRuns[run]) continue;
            Q[run].head<3>() += 1e-6 * Eigen::Vector3d(random(), random(), 1.0);
            Q[run].tail<2>() += 1e-6 * Eigen::Vector2d(random(), -1.0);
            for (int j = 0; j < kJoints; ++j) Q_lanes[j][run] = Q[run][j];
          }
          const JointLanes& d = together->advance(Q_lanes, kRuns);
          for (std::size_t run = 0; run < kLaneWidth; ++run) {
            if (!kRuns[run]) continue;
            const Joints one = alone[run]->advance(Q[run]);
            for (int j = 0; j < kJoints; ++j) {
              ASSERT_EQ(d[j][run], one[j]) << "run " << run << ", period " << n;
            }
          }
        }
        // one that is left goes on by itself
        const Joints further = Q[4] + Joints::Constant(1e-6);
        EXPECT_EQ(together->advance(further, 4), alone[4]->advance(further));
      }
    }
  }
}

// Limits of eight runs at once: the bits of each, on every instruction set of this machine.
TEST(Approach, GivesInLanesTheBitsOfEachRun) {
  plant::Uniform random(31);
  constexpr double kMax[] = {2.0, 0.5, 1e-9}, kChange[] = {0.3, 10.0, 0.1};
  for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
    if (level > simd_level()) continue;
    const Approach approach =
        at_simd_level(level, []<SimdLevel l>() { return make_approach<l>(); });
    LaneArray wanted[3], values[3] = {};
    for (int n = 0; n < 200; ++n) {
      LaneArray before[3];
      for (int j = 0; j < 3; ++j) {
        before[j] = values[j];
        for (double& w : wanted[j]) w = 3.0 * random();
      }
      approach(kMax, kChange, 3, wanted, values);
      for (int j = 0; j < 3; ++j) {
        for (std::size_t k = 0; k < kLaneWidth; ++k) {
          ASSERT_EQ(values[j][k], approached(wanted[j][k], kMax[j], kChange[j], before[j][k]));
        }
      }
    }
  }
}

// Periods that wait and then advance together give the bits of one after the other, limits reached
// or not, however many they are.
TEST(VirtualEncoder, GivesTheSameBitsForPeriodsTogether) {
  plant::Uniform random(29);
  IdentifiedMachine identified = identified_with(plant::random_errors(random, 50e-6));
  identified.Kv << 60.0, 40.0, 40.0, 50.0, 50.0;
  const Entry entry = feedback_entry();
  for (const std::string_view axes : {"linear", "all"}) {
    for (const double max_rate : {1.0, 1e-5}) {  // m/s, rad/s: never reached, often reached
      for (const bool lead : {false, true}) {
        Parameters parameters = default_parameters(entry);
        parameters.set("axes", axes);
        parameters.set("max_rate_mm_per_s", max_rate);
        parameters.set("max_rate_mrad_per_s", max_rate);
        if (lead) parameters.set("extrapolation_time_ms", std::string_view("auto"));
        const auto strategy = entry.make(parameters, Action::compensate, identified);
        const auto each = strategy->feedback(kModelPeriod);
        const auto all = strategy->feedback(kModelPeriod);
        constexpr std::size_t kLane = 3;
        Joints Q = identified.reference;
        EXPECT_EQ(each->settle(Q, kLane), all->settle(Q, kLane));
        std::size_t limited = 0;
        for (int round = 0; round < 40; ++round) {
          const std::size_t periods = 1 + static_cast<std::size_t>(round) % kLaneWidth;
          JointLanes Q_meas{};
          Joints before = Joints::Zero(), d = before;
          for (std::size_t n = 0; n < periods; ++n) {
            Q += 1e-5 * Joints(random(), random(), 1.0, random(), -1.0);
            for (int j = 0; j < kJoints; ++j) Q_meas[j][n] = Q[j];
            before = d;
            d = each->advance(Q, kLane);
            const double most = max_rate * kModelPeriod * (1.0 - 1e-9);
            if (n > 0 && (d - before).cwiseAbs().maxCoeff() >= most) ++limited;
          }
          ASSERT_EQ(all->advance(Q_meas, periods, kLane), d) << axes << ", round " << round;
        }
        EXPECT_EQ(limited > 0, max_rate < 1.0);
      }
    }
  }
}

// Each kind of axis has its own limits, and those that are not displaced stay where they are.
TEST(VirtualEncoder, LimitsRotaryAxesOnTheirOwn) {
  plant::ErrorModel errors;
  errors.component({Axis::B, Axis::X}) = plant::polynomial({0.0, kSlope});  // rad/m
  IdentifiedMachine identified = identified_with(errors);
  identified.reference << 0.0, 0.0, 0.0, 30.0 * deg, 0.0;
  const Entry entry = feedback_entry();
  Parameters parameters = default_parameters(entry);
  parameters.set("max_mrad", 0.1e-3);
  parameters.set("max_rate_mrad_per_s", 1e9);
  parameters.set("max_um", 1.0);
  parameters.set("max_rate_mm_per_s", 1e9);
  const auto at = [&](double x) {
    Joints Q = identified.reference;
    Q[0] = x;
    return Q;
  };
  EXPECT_EQ(
      make_acting(entry, parameters, Action::compensate, identified).feedback->settle(at(0.1))[3],
      0.0);
  parameters.set("axes", "all");
  const Acting all = make_acting(entry, parameters, Action::compensate, identified);
  constexpr double kThirdOrder = 2.1e-14;  // rad: one step leaves e^3 / 6 of e = 50 urad
  EXPECT_NEAR(all.feedback->settle(at(0.005))[3], 0.05e-3, kThirdOrder);
  EXPECT_EQ(all.feedback->settle(at(0.02))[3], 0.1e-3);
  EXPECT_EQ(all.feedback->settle(at(-0.02))[3], -0.1e-3);
  parameters.set("max_mrad", 10e-3);
  parameters.set("max_rate_mrad_per_s", 100e-3);
  const Acting slow = make_acting(entry, parameters, Action::compensate, identified);
  slow.feedback->settle(at(0.0));
  constexpr double kRounding = 1e-18;  // rad
  slow.feedback->advance(at(0.1));
  for (int n = 1; n <= 10; ++n) {
    EXPECT_NEAR(slow.feedback->advance(at(0.1))[3], n * 100e-3 * kModelPeriod, kRounding);
  }
}

}  // namespace
}  // namespace servomill::strategies::feedback_test
