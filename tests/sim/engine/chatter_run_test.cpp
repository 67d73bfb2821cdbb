/// Chatter in a simulated machine: drives, structure and teeth together.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/cutting/stability_lobes.h"
#include "plant/vocabulary/units.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::chatter_run_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurns = 80.0;         // 4800 1/min; a tooth every 3.125 ms
constexpr double kFeed = 50 * um;       // per tooth
constexpr std::size_t kTwoTeeth = 125;  // rows

const std::string kStraightTool = kTool + "helix_deg = 0.0\n";
const std::string kTeeth = kSteel + "force = \"instantaneous\"\n";
const std::string kFine = "[record]\nperiod_ms = 0.05\n";
const std::string kMode =
    "[machine_override]\nstructural_mode = [{ direction = [0, 1, 0], stiffness = \"20 N/um\", "
    "frequency_Hz = 500.0, damping = 0.03 }]\n";

plant::StabilityLimit slot_limit() {
  const plant::ChatterMode mode{.stiffness = 20e6, .frequency = 2.0 * kPi * 500.0, .damping = 0.03};
  return plant::zeroth_order_limit({.coefficients = plant::find_material("42CrMo4")->typical,
                                    .teeth = 4,
                                    .from = 0.0,
                                    .to = kPi},
                                   {&mode, 1}, kTurns);
}

run::CaseOutput slot(double depth, const std::string& regeneration) {
  const std::string program = fmt::format(
      "G17 G90 T1 M6\nG43 H1\nS4800 M3\nG0 X-30 Y0\nZ{:.6f}\nG1 X30 F960\nM30\n", -depth / mm);
  return run_named_case(small_scenario(program, kStraightTool + kBlock + kTeeth + regeneration +
                                                    kFine + one_case("cut") + kMode),
                        "cut");
}

// Part of the deflection that is not periodic: change over two teeth, along Y (m), between two
// positions along X (mm).
std::vector<double> vibration(const run::CaseOutput& out, double from, double to) {
  const records::Series& servo = out.result.servo;
  const std::size_t column = *servo.column("structural_deflection", 'Y');
  std::vector<double> d;
  for (const std::size_t n : rows_within(servo, from, to)) {
    d.push_back((servo.at(n, column) - servo.at(n - kTwoTeeth, column)) * um);
  }
  return d;
}

double rms(const std::vector<double>& d) {
  double sum = 0.0;
  for (const double value : d) sum += value * value;
  return std::sqrt(sum / static_cast<double>(d.size()));
}

// Changes of sign, two a period.
double frequency(const std::vector<double>& d) {
  double changes = 0.0;
  for (std::size_t i = 1; i < d.size(); ++i) changes += d[i] * d[i - 1] < 0.0 ? 1.0 : 0.0;
  return changes / (2.0 * static_cast<double>(d.size()) * 0.05 * ms);
}

TEST(ChatterRun, below_the_limit_of_stability_is_quiet) {
  const auto out = slot(0.8 * slot_limit().depth, "regeneration = true\n");
  EXPECT_LT(rms(vibration(out, 0.0, 10.0)), 1e-2 * kFeed);
}

// Teeth that leave the cut bound the vibration at the order of the feed.
TEST(ChatterRun, beyond_the_limit_vibrates_at_the_frequency_of_the_lobe) {
  const plant::StabilityLimit limit = slot_limit();
  const auto d = vibration(slot(1.1 * limit.depth, "regeneration = true\n"), 0.0, 10.0);
  EXPECT_GT(rms(d), 0.2 * kFeed);
  EXPECT_LT(rms(d), 10.0 * kFeed);
  EXPECT_NEAR(frequency(d), limit.frequency, 0.03 * limit.frequency);
}

// Modes follow the force of the teeth, and chips do not follow the modes.
TEST(ChatterRun, without_regeneration_is_quiet_at_any_depth) {
  const auto out = slot(1.3 * slot_limit().depth, "");
  EXPECT_LT(rms(vibration(out, 0.0, 10.0)), 1e-2 * kFeed);
  EXPECT_GT(largest_of(out.result.servo, "structural_deflection", 'Y',
                       rows_within(out.result.servo, 0.0, 10.0)),
            1.0);
}

}  // namespace
}  // namespace servomill::sim::engine::chatter_run_test
