// Cross-coupled control on simulated axes, against closed forms.
#include "strategies/cross_coupling.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/counting_new.h"
#include "tests/sim/small_scenario.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::cross_coupling_test {
namespace {

using sim::run::CaseOutput;

constexpr double kKv = 5.0 / 60.0 * 1000.0;  // 1/s, of the HSM 600U

const std::string kLag =
    "[machine_override.nc]\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n";

std::string contour(const std::string& keys) {
  return "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"contour\"\n" + keys;
}
const std::string kNone = "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"none\"\n";

CaseOutput run_of(const std::string& program, const std::string& one, const std::string& machine) {
  return sim::run_named_case(sim::small_scenario(program, one + machine), "one");
}

// Mean of radius less 50 mm (um) between two times.
double radial_error(const CaseOutput& out, double from, double to) {
  const sim::records::Series& servo = out.result.servo;
  const std::size_t x = servo.column("tool_position_true", 'X').value();
  const std::size_t y = servo.column("tool_position_true", 'Y').value();
  double sum = 0.0;
  int rows = 0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    if (servo.at(n, 0) < from || servo.at(n, 0) > to) continue;
    sum += std::hypot(servo.at(n, x), servo.at(n, y)) - 50.0;
    ++rows;
  }
  EXPECT_GT(rows, 100);
  return sum / rows * 1e3;
}

const char* const kCircle =
    "G17 G21 G90 G94 G64 P0.001\nG1 X50 F3000\nG3 I-50 F3000\nG3 I-50\nM2\n";

double circle(const std::string& one) {
  return radial_error(run_of(kCircle, one, kLag), 5.0, 12.0);
}

// --- circle: along the normal Kv becomes Kv + C -------------------------------------------------

TEST(Contour, DividesTheRadialErrorOfACircle) {
  const double plain = circle(kNone);
  EXPECT_LT(plain, -3.0);
  for (const double C : {20.0, 50.0, 100.0}) {
    const double ratio = circle(contour(fmt::format("gain_per_s = {}\n", C))) / plain;
    EXPECT_NEAR(ratio, kKv / (kKv + C), 0.02 * kKv / (kKv + C)) << C;
  }
}

TEST(Contour, LeavesNothingOfItWithAnIntegral) {
  const double plain = circle(kNone);
  const double left = circle(contour("reset_time_ms = \"auto\"\n")) / plain;
  EXPECT_LT(std::abs(left), 0.02);
}

TEST(Contour, WithoutGainIsNoStrategy) {
  const CaseOutput plain = run_of(kCircle, kNone, kLag);
  const CaseOutput zero = run_of(kCircle, contour("gain_per_s = 0.0\n"), kLag);
  ASSERT_EQ(plain.result.servo.rows(), zero.result.servo.rows());
  for (std::size_t n = 0; n < plain.result.servo.rows(); ++n) {
    for (std::size_t c = 0; c < plain.result.servo.width(); ++c) {
      ASSERT_EQ(plain.result.servo.at(n, c), zero.result.servo.at(n, c)) << n << " " << c;
    }
  }
}

// --- line: unequal gains ------------------------------------------------------------------------

// At 45 deg, e = v/2 (1/Kv2 - 1/Kv1) / (1 + C/2 (1/Kv1 + 1/Kv2)).
TEST(Contour, DividesTheErrorOfALineWithUnequalGains) {
  const double Kv1 = 60.0, Kv2 = 50.0, v = 0.04;
  const std::string unequal =
      kLag +
      "[machine_override.axis.X]\nKv = \"60 1/s\"\n[machine_override.axis.Y]\nKv = \"50 1/s\"\n";
  const char* const line = "G17 G21 G90 G94 G64 P0.001\nG1 X120 Y120 F2400\nM2\n";
  const auto error_of = [&](const std::string& one) {
    const sim::records::Series servo = run_of(line, one, unequal).result.servo;
    const std::size_t x = servo.column("tool_position_true", 'X').value();
    const std::size_t y = servo.column("tool_position_true", 'Y').value();
    const std::size_t n = servo.rows() / 2;
    return (servo.at(n, x) - servo.at(n, y)) / std::sqrt(2.0) * 1e-3;
  };
  for (const double C : {0.0, 40.0, 80.0}) {
    const double e = 0.5 * v * (1.0 / Kv2 - 1.0 / Kv1) / (1.0 + 0.5 * C * (1.0 / Kv1 + 1.0 / Kv2));
    EXPECT_NEAR(error_of(contour(fmt::format("gain_per_s = {}\n", C))), e, 0.01 * e) << C;
  }
  EXPECT_NEAR(error_of(contour("gain_per_s = 40\nreset_time_ms = 60\n")), 0.0, 0.5 * um);
}

// --- corners, rotary axes -----------------------------------------------------------------------

struct ContourErrors {
  double rms = 0.0, largest = 0.0;  // um
};

ContourErrors contour_errors(const CaseOutput& out) {
  const sim::records::Series& servo = out.result.servo;
  const std::size_t column = servo.column("contour_error").value();
  ContourErrors errors;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    const double e = servo.at(n, column);
    errors.rms += e * e / static_cast<double>(servo.rows());
    errors.largest = std::max(errors.largest, std::abs(e));
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

TEST(Contour, CutsACornerLess) {
  const char* const corner = "G17 G21 G90 G94 G64 P0.001\nG1 X20 F3000\nG1 Y20\nM2\n";
  const ContourErrors plain = contour_errors(run_of(corner, kNone, kLag));
  const ContourErrors with = contour_errors(run_of(corner, contour(""), kLag));
  EXPECT_GT(plain.largest, 10.0);
  EXPECT_LT(with.largest, plain.largest);
  EXPECT_LT(with.rms, 0.8 * plain.rms);
}

// A slow rotary axis under TCP control leaves the tip beside its line; X and Y bring it back.
TEST(Contour, CorrectsTheTipForTheLagOfARotaryAxis) {
  const std::string slow = kLag + "[machine_override.axis.C]\nKv = \"40 1/s\"\n";
  const char* const turning =
      "G17 G21 G90 G94 G64 P0.001\nT1 M6\nG43.4 H1\nG0 X40 Y0 C0\nG1 X80 C20 F1500\nM2\n";
  const std::string tool = "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\n";
  const ContourErrors plain = contour_errors(run_of(turning, tool + kNone, slow));
  const ContourErrors with =
      contour_errors(run_of(turning, tool + contour("reset_time_ms = \"auto\"\n"), slow));
  EXPECT_GT(plain.rms, 5.0);
  EXPECT_LT(with.rms, 0.5 * plain.rms);
}

// --- margins ------------------------------------------------------------------------------------

TEST(Contour, WarnsOfAGainThatLeavesLittleMargin) {
  const CaseOutput out = run_of(kCircle, contour("gain_per_s = 120.0\n"), kLag);
  ASSERT_EQ(out.notes.size(), 4U);  // of three axes, and of jerk
  EXPECT_NE(
      out.notes[0].find("warning: case one: strategy contour: with 120 1/s added to Kv = 83.33 "
                        "1/s the position loop of X has a phase margin of 33"),
      std::string::npos)
      << out.notes[0];
  for (const std::string& note : run_of(kCircle, contour(""), kLag).notes) {
    EXPECT_EQ(note.find("margin"), std::string::npos) << "auto keeps them: " << note;
  }
}

std::string refusal(const std::string& strategies, const std::string& program = kCircle,
                    const std::string& more = kLag) {
  const sim::model::Scenario scenario = sim::small_scenario(program, strategies + more);
  try {
    const sim::preparation::PreparedCase prepared(scenario, scenario.cases.front());
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "none";
}

TEST(Contour, RefusesAGainThatIsUnstable) {
  for (const char* gain : {"500", "2000", "20000", "1e5"}) {
    EXPECT_NE(refusal(contour(fmt::format("gain_per_s = {}\n", gain)))
                  .find("the position loop of X is unstable; lower the gain, or set "
                        "nc.check_stability = false to simulate it anyway"),
              std::string::npos)
        << gain;
  }
}

TEST(Contour, RefusesASecondOne) {
  EXPECT_EQ(refusal(contour("") + "[[case.strategy]]\ntype = \"contour\"\n"),
            "case one: strategy contour appears twice; each would correct the whole");
}

// Tips of two tools move alike as long as the rotary axes stand still.
TEST(Contour, RefusesToTurnWithAnotherTool) {
  const std::string tools =
      "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\n[[program.tool]]\nnumber = 2\nlength_mm = "
      "60.0\n";
  const std::string change = "T1 M6\nG43 H1\nG1 X10 F1000\nT2 M6\nG43 H2\nG1 X20\n";
  EXPECT_EQ(refusal(tools + contour(""), change + "M2\n"), "none");
  EXPECT_EQ(refusal(tools + contour(""), change + "G1 C10\nM2\n"),
            "case one: strategy contour: uses the TCP of the first tool of the program; rotary "
            "axes move with a different tool here (small.ngc:7)");
}

TEST(Contour, WarnsWithAnIdealServo) {
  const std::string ideal =
      "[[case]]\nname = \"one\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = \"contour\"\n";
  const CaseOutput out = run_of(kCircle, ideal, kLag);
  ASSERT_EQ(out.notes.size(), 1U);
  EXPECT_EQ(out.notes[0],
            "warning: case one: strategy contour acts in the position loops, which an ideal servo "
            "does not have");
}

Parameters of_fifty() {
  Parameters out;
  out.set("gain_per_s", 50.0);
  out.set("reset_time_ms", 0.0);
  out.set("max_mm_per_s", 20 * mm);
  return out;
}

TEST(Contour, AddsNoMoreThanItsLimit) {
  const IdentifiedMachine identified = identified_with({});
  const auto strategy = contour_entry().make(of_fifty(), Action::compensate, identified);
  const auto term = strategy->position_loop(0.2e-3);
  Reading now{.Q_fb = identified.reference, .Q_cmd = identified.reference};
  term->settle(now);
  now.Q_cmd[0] += 1 * mm;
  for (const double off : {0.1 * mm, 0.399 * mm}) {
    now.Q_fb[1] = identified.reference[1] + off;
    EXPECT_NEAR(term->velocity(now)[1], -50.0 * off, 1e-9);
  }
  now.Q_fb[1] = identified.reference[1] + 0.5 * mm;
  EXPECT_NEAR(term->velocity(now)[1], -20 * mm, 1e-12);
  EXPECT_NEAR(term->velocity(now)[0], 0.0, 1e-12) << "nothing along the path";
}

TEST(Contour, TakesNothingFromTheHeap) {
  const IdentifiedMachine identified = identified_with({});
  const auto strategy = contour_entry().make(of_fifty(), Action::compensate, identified);
  const auto term = strategy->position_loop(0.2e-3);
  Reading now{.Q_fb = identified.reference, .Q_cmd = identified.reference};
  const std::size_t before = allocations;
  term->settle(now);
  double sum = 0.0;
  for (int n = 0; n < 100; ++n) {
    now.Q_cmd[0] += 10 * um;
    now.Q_fb = now.Q_cmd;
    now.Q_fb[1] += 5 * um;
    sum += term->velocity(now).sum();
  }
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace servomill::strategies::cross_coupling_test
