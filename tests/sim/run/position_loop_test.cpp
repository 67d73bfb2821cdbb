/// Strategies that act in the position loop. This file takes the place of strategies/registry.cpp
/// in its program.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "controllers/servo/cascade.h"
#include "sim/frequency/axis_signals.h"
#include "sim/model/scenario.h"
#include "sim/run/point_batch.h"
#include "sim/run/run_output.h"
#include "strategies/none.h"
#include "tests/counting_new.h"
#include "tests/sim/small_scenario.h"
#include "tests/strategies/identified_machines.h"
#include "tests/strategies/position_loop_example.h"

namespace servomill::strategies {
namespace {

constexpr std::array<ParameterSpec, 1> kGain = {
    {{.name = "gain", .help = "gain that is added", .unit = "1/s", .default_text = "32"}}};
constexpr std::array<ParameterSpec, 1> kVelocity = {
    {{.name = "velocity", .help = "that is added", .unit = "m/s", .default_text = "0"}}};

// v = gain (Q_cmd - Q_fb): the loop has the gain Kv + gain.
struct Proportional final : PositionLoopPart {
  explicit Proportional(double added) : gain(added) {}
  void settle(const Reading&) override {}
  Joints velocity(const Reading& now) override { return gain * (now.Q_cmd - now.Q_fb); }
  double gain;  // 1/s
};

// The same velocity of Y at all times.
struct Constant final : PositionLoopPart {
  explicit Constant(double added) : v(added) {}
  void settle(const Reading&) override {}
  Joints velocity(const Reading& now) override {
    return {0.0, now.t < 0.1001 ? 0.0 : v, 0.0, 0.0, 0.0};
  }
  double v;  // m/s
};

template <class Part>
struct WithPart final : Strategy {
  explicit WithPart(double number) : value(number) {}
  std::unique_ptr<PositionLoopPart> position_loop(double) const override {
    return std::make_unique<Part>(value);
  }
  double value;
};

template <class Part>
Entry entry_of(std::string_view name, std::span<const ParameterSpec> specs) {
  const auto make = [key = specs[0].name](const Parameters& p, Action, const IdentifiedMachine&) {
    return std::make_unique<WithPart<Part>>(p.number(key));
  };
  Entry entry{name, "acts in the position loop", specs, make};
  entry.reads_errors = false;
  return entry;
}

Entry nan_entry() {
  const auto make = [](const Parameters&, Action, const IdentifiedMachine&) {
    return std::make_unique<WithPart<Constant>>(std::numeric_limits<double>::quiet_NaN());
  };
  Entry entry{"not_finite", "adds what is not finite", {}, make};
  entry.reads_errors = false;
  return entry;
}

}  // namespace

std::span<const Entry> entries() {
  static const std::array kEntries = {entry_of<Constant>("constant", kVelocity), integral_entry(),
                                      none_entry(), nan_entry(),
                                      entry_of<Proportional>("proportional", kGain)};
  return kEntries;
}

const Entry* find(std::string_view name) {
  for (const Entry& entry : entries()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> out;
  for (const Entry& entry : entries()) out.push_back(entry.name);
  return out;
}

}  // namespace servomill::strategies

namespace servomill::sim::run {
namespace {

constexpr const char* kProgram = "G1 X60 Y20 F3000\nG4 P0.3\nG1 X0\nM2\n";
constexpr double kSpeed = 0.05;  // m/s

// Lag mode, so that the loop is Kv (Q_cmd - Q_fb) and nothing else.
std::string machine_with(const std::string& Kv, const std::string& more = "") {
  return "[machine_override.nc]\nKv = \"" + Kv +
         "\"\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n" + more;
}

std::string case_of(const std::string& name, const std::string& type,
                    const std::string& keys = "") {
  return "[[case]]\nname = \"" + name + "\"\n[[case.strategy]]\ntype = \"" + type + "\"\n" + keys +
         "\n";
}

void expect_same(const records::Series& one, const records::Series& other) {
  ASSERT_EQ(one.rows(), other.rows());
  ASSERT_EQ(one.width(), other.width());
  for (std::size_t row = 0; row < one.rows(); ++row) {
    for (std::size_t c = 0; c < one.width(); ++c) {
      ASSERT_EQ(one.at(row, c), other.at(row, c)) << row << " " << c;
    }
  }
}

// Gains that are powers of two, so that Kv e + Kv e = 2 Kv e without rounding: the same bits.
TEST(PositionLoop, AProportionalTermIsALargerGain) {
  for (const char* more : {"",
                           "[machine_override.axis.X.backlash_compensation]\nwidth = \"10 um\"\n"
                           "time_ms = 10.0\n"}) {
    SCOPED_TRACE(more);
    const CaseOutput with_term = run_named_case(
        small_scenario(kProgram, case_of("one", "proportional") + machine_with("32 1/s", more)),
        "one");
    const CaseOutput with_gain = run_named_case(
        small_scenario(kProgram, case_of("one", "none") + machine_with("64 1/s", more)), "one");
    expect_same(with_term.result.servo, with_gain.result.servo);
  }
}

// At rest Kv (Q_cmd - Q_fb) + v = 0: the axis stands off its setpoint by v / Kv.
TEST(PositionLoop, AConstantVelocityDisplacesAnAxisAtRest) {
  const double v = 1e-3, Kv = 40.0;
  const CaseOutput out =
      run_named_case(small_scenario(kProgram, case_of("one", "constant", "velocity = 1e-3") +
                                                  machine_with("40 1/s")),
                     "one");
  const records::Series& servo = out.result.servo;
  const std::size_t last = servo.rows() - 1;
  const double y = servo.at(last, *servo.column("true_linear", 'Y'));
  const double y_cmd = servo.at(last, *servo.column("cmd_linear", 'Y'));
  constexpr double kSettled = 2e-3;  // mm, of 25 um: exp(-Kv 0.1 s) and a step of the scale
  EXPECT_NEAR(y - y_cmd, v / Kv * 1e3, kSettled);
}

// Lag mode: an axis at constant speed is behind by v / Kv, with an integral term by nothing.
TEST(PositionLoop, AnIntegralTermFollowsARampWithoutError) {
  const model::Scenario scenario =
      small_scenario("G1 X60 Y20 F3000\nM2\n", case_of("lag", "none") +
                                                   case_of("integral", "integral", "gain = 400.0") +
                                                   machine_with("40 1/s"));
  const double feed_X = kSpeed * 60.0 / std::hypot(60.0, 20.0);
  for (const auto& [name, expected] : {std::pair{"lag", feed_X / 40.0}, {"integral", 0.0}}) {
    const records::Series servo = run_named_case(scenario, name).result.servo;
    const auto rows = rows_within(servo, 50.0, 55.0);
    const double behind =
        mean_of(servo, "cmd_linear", 'X', rows) - mean_of(servo, "fb_linear", 'X', rows);
    constexpr double kTransient = 2e-3;  // mm, of 1.2 mm: exp(-20 s^-1 1 s), steps of the scale
    EXPECT_NEAR(behind, expected * 1e3, kTransient) << name;
  }
}

TEST(PositionLoop, RunsInLockstepHaveTheBitsOfRunsAlone) {
  std::vector<model::Scenario> points;
  for (int n = 0; n < 11; ++n) {
    const std::string gain = "gain = " + std::to_string(10 * n);
    points.push_back(small_scenario(
        kProgram, case_of("one", n % 2 == 0 ? "integral" : "proportional", gain + ".0") +
                      machine_with("32 1/s")));
  }
  static const engine::StopFlag kNever = false;
  std::atomic<float> progress = 0.0F;
  std::size_t ended = 0;
  const auto compare_each = [&](std::vector<EndedPoint>&& some) {
    for (const EndedPoint& one : some) {
      ++ended;
      ASSERT_EQ(one.result.status, PointStatus::done) << one.result.reason;
      const CaseOutput alone = run_named_case(points[one.place], "one");
      expect_same(one.result.cases->front().result.servo, alone.result.servo);
    }
  };
  run_batch(points, kNever, progress, compare_each, {.keep = Keep::series});
  EXPECT_EQ(ended, points.size());
}

TEST(PositionLoop, AbsurdValuesEndTheCase) {
  const model::Scenario scenario = small_scenario(
      kProgram, case_of("nan", "not_finite") + case_of("fast", "constant", "velocity = 1e30") +
                    case_of("well", "constant", "velocity = 1e-3") + machine_with("40 1/s"));
  const RunOutput out = run_scenario(scenario, {});
  const auto reason = [&](std::size_t k) { return out.cases[k].result.outcome.reason; };
  EXPECT_EQ(reason(0),
            "strategy not_finite: position_loop returned a value that is not finite at 0.1002 s, "
            "line 1 of "
            "the program");
  EXPECT_EQ(
      reason(1),
      "strategy constant: position_loop adds 1e+30 m/s to axis Y, beyond 10 times its v_max at "
      "0.1002 s, line 1 of the program");
  EXPECT_TRUE(out.cases[2].result.outcome.finished);
}

// Ideal axes have no position loop.
TEST(PositionLoop, DoesNothingOnIdealAxes) {
  const auto ideal = [](const std::string& type, const std::string& keys) {
    return run_named_case(small_scenario(kProgram,
                                         "[[case]]\nname = \"one\"\nservo = \"ideal\"\n"
                                         "[[case.strategy]]\ntype = \"" +
                                             type + "\"\n" + keys),
                          "one");
  };
  expect_same(ideal("constant", "velocity = 1.0\n").result.servo, ideal("none", "").result.servo);
}

TEST(PositionLoop, DoesNotAllocateInARun) {
  const strategies::Entry entry = strategies::integral_entry();
  Parameters parameters;
  parameters.set("gain", 100.0);
  const auto strategy =
      entry.make(parameters, strategies::Action::compensate, strategies::identified_with({}));
  const auto part = strategy->position_loop(200e-6);
  part->settle({});
  const std::size_t before = allocations;
  Joints sum = Joints::Zero();
  for (int n = 0; n < 100; ++n) sum += part->velocity({.Q_cmd = Joints::Constant(1e-3 * n)});
  EXPECT_EQ(allocations, before);
  EXPECT_GT(sum[0], 0.0);
}

}  // namespace
}  // namespace servomill::sim::run
