// Probing moves of a scenario: the stylus of a machine with errors meets spheres, planes, bores and
// workpieces. Closed forms for the ideal machine; on a machine with errors the true ball touches.
#include "sim/preparation/touch_probe.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/run.h"
#include "tests/sim/five_axis_program.h"

namespace servomill::sim::preparation::touch_probe_test {
namespace {

constexpr double kSum = 15.5 * mm;  // radii of sphere and stylus
constexpr double kFound = 1e-9;     // m: the search ends at 0.1 nm

const std::string kSphere = "[[touch_probe.sphere]]\ncentre_mm = [0, 0, 0]\ndiameter_mm = 25\n";
const std::string kCase = "[[case]]\nname = \"none\"\n";

model::Scenario scenario_of(const std::string& program, const std::string& probe,
                            const std::string& more = kCase) {
  return input::read_resolved_scenario(
      "machine = \"machines/generic_trunnion_ac.toml\"\n" + more +
          "\n[touch_probe]\nstylus_diameter_mm = 6\n" + probe +
          "\n[program]\nfile = \"touch.ngc\"\nstart = { Z_mm = 200.0 }\ntext = '''\nG21 G90 F60\n"
          "G43 H1\nG0 X-40 Z60\n" +
          program + "M2\n'''\n[[program.tool]]\nnumber = 1\nlength_mm = 120.0\n",
      SERVOMILL_SOURCE_DIR "/scenarios/touch.toml");
}

std::vector<Touch> touches_of(const model::Scenario& scenario, std::size_t n = 0) {
  return PreparedCase(scenario, scenario.cases.at(n)).parts().program.touches;
}

std::vector<Touch> touches_of(const std::string& program, const std::string& probe,
                              const std::string& more = kCase) {
  return touches_of(scenario_of(program, probe, more));
}

std::string fault_of(const std::string& program, const std::string& probe,
                     const std::string& more = kCase) {
  try {
    run::check_scenario(scenario_of(program, probe, more));
    return "";
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.rfind('/') + 1);
  }
}

TEST(TouchProbe, MeetsASphereWhereTheDistanceIsTheSumOfTheRadii) {
  const auto touches = touches_of(
      "(MSG, ball)\nG0 Z0\nG38.2 X0\nG0 X-40\nG0 Y4\nG38.2 X0\nG0 X-40 Y0 Z60\nG0 X0\nG38.2 Z0\n",
      kSphere);
  ASSERT_EQ(touches.size(), 3U);
  EXPECT_NEAR(touches[0].latched[0], -kSum, kFound);
  EXPECT_NEAR(touches[1].latched[0], -std::sqrt(kSum * kSum - 16e-6), kFound);
  EXPECT_NEAR(touches[2].latched[2], kSum + 120.0 * mm, kFound);  // the tool is 120 mm long
  EXPECT_EQ(touches[0].line, 6);
  EXPECT_EQ(touches[0].section, "ball");
  EXPECT_TRUE(touches[0].has_switched);
}

TEST(TouchProbe, OfAMachineWithErrorsTouchesWithItsTrueBall) {
  const plant::MachineChain chain = scenario_of("", kSphere).machine.chain;
  Joints Q = Joints::Zero();
  Q[3] = -30.0 * deg;
  Q[4] = 70.0 * deg;
  const Eigen::Vector3d above =  // the centre of the sphere in machine coordinates
      -plant::R_WM(chain, Q).transpose() * plant::forward(chain, Q, Eigen::Vector3d::Zero()).p_WT;
  const model::Scenario scenario =
      scenario_of("G0 Y2 Z0\nG38.2 X0\nG0 X-40\nG0 Z150\nG0 A-30 C70\n" +
                      fmt::format("G0 X{:.6f} Y{:.6f}\nG38.2 Z{:.6f}\n", above.x() / mm + 5.0,
                                  above.y() / mm + 3.0, above.z() / mm),
                  kSphere, "machine_errors = \"machine\"\n" + errors_of_all_axes() + kCase);
  const plant::VolumetricModel machine(scenario.machine.chain, scenario.errors.at("machine"));
  const auto touches = touches_of(scenario);
  ASSERT_EQ(touches.size(), 2U);
  for (const Touch& touch : touches) {
    const Eigen::Vector3d ball = machine.forward(touch.latched, {0.0, 0.0, -0.12}).p_WT;
    EXPECT_NEAR(ball.norm(), kSum, kFound);
    EXPECT_GT(
        std::abs(plant::forward(machine.chain(), touch.latched, {0.0, 0.0, -0.12}).p_WT.norm() -
                 kSum),
        1e-6);
  }
}

TEST(TouchProbe, FindsThePlaceThatAScaleErrorGives) {
  // x + 10 um + 20 um/m x = -15.5 mm
  const auto touches = touches_of("G0 Z0\nG38.2 X0\n", kSphere,
                                  "machine_errors = \"e\"\n[errors.e]\n"
                                  "EXX = { polynomial_um = [10.0, 0.02] }\n" +
                                      kCase);
  EXPECT_NEAR(touches.at(0).latched[0], (-kSum - 10.0 * um) / (1.0 + 20e-6), kFound);
}

TEST(TouchProbe, ShowsTheIdealPlaceWhereAStrategyCorrects) {
  const std::string cases =
      "machine_errors = \"e\"\n[errors.e]\nEXX = { polynomial_um = [10.0, 0.02] }\n"
      "EYX = { polynomial_um = [0.0, 0.05] }\n" +
      kCase +
      "[[case]]\nname = \"table\"\n[[case.strategy]]\ntype = \"table\"\nmodel = \"e\"\n"
      "spacing_mm = 3.2768\n"
      "[[case]]\nname = \"feedback\"\nfeedback_hardware = true\n[[case.strategy]]\n"
      "type = \"feedback\"\nmodel = \"e\"\n";
  const model::Scenario scenario = scenario_of("G0 Z0\nG38.2 X0\n", kSphere, cases);
  EXPECT_GT(std::abs(touches_of(scenario, 0).at(0).latched[0] + kSum), 9.0 * um);
  EXPECT_NEAR(touches_of(scenario, 1).at(0).latched[0], -kSum, 0.01 * um);
  EXPECT_NEAR(touches_of(scenario, 2).at(0).latched[0], -kSum, 0.01 * um);
}

TEST(TouchProbe, OfAStrategyThatRewritesIsRefused) {
  EXPECT_EQ(fault_of("G0 Z0\nG38.2 X0\n", kSphere,
                     "[errors.e]\nEC0Y = \"10 urad\"\n[[case]]\nname = \"g\"\n[[case.strategy]]\n"
                     "type = \"gcode\"\nmodel = \"e\"\n"),
            "touch.toml:7:8: error: case g: strategy gcode rewrites the program, which has probing "
            "moves (line 5); use another strategy for measuring");
}

TEST(TouchProbe, SwitchesBehindTheContactByPreTravelAndLobes) {
  std::string program = "G0 Z0\n";
  for (int k = 0; k < 12; ++k) {  // to the sphere along twelve directions, and back over it
    const double a = k * std::numbers::pi / 6.0;
    program +=
        fmt::format("G0 X{0:.9f} Y{1:.9f}\nG0 Z0\nG38.2 X0 Y0\nG0 X{0:.9f} Y{1:.9f}\nG0 Z60\n",
                    30.0 * std::cos(a), 30.0 * std::sin(a));
  }
  const auto touches =
      touches_of("G0 Z60\nG0 X30 Y0\n" + program,
                 "pretravel_um = 7\nlobing_um = 2\nlobing_phase_deg = 20\n" + kSphere);
  ASSERT_EQ(touches.size(), 12U);
  for (int k = 0; k < 12; ++k) {
    const double a = k * std::numbers::pi / 6.0;
    const double deflection = 7.0 * um + 2.0 * um * std::cos(3.0 * a - 20.0 * deg);
    EXPECT_NEAR(touches[std::size_t(k)].latched.head<2>().norm(), kSum - deflection, kFound) << k;
  }
  // along the axis there are no lobes
  EXPECT_NEAR(touches_of("G0 X0\nG38.2 Z0\n", "pretravel_um = 7\nlobing_um = 2\n" + kSphere)
                  .at(0)
                  .latched[2],
              kSum - 7.0 * um + 120.0 * mm, kFound);
}

TEST(TouchProbe, RepeatsItselfAsItsSeedAndDeviationSay) {
  std::string program = "G0 Z0\n";
  constexpr int kTouches = 400;
  for (int k = 0; k < kTouches; ++k) program += "G38.2 X0\nG0 X-20\n";
  const std::string probe = "repeatability_um = 0.5\n" + kSphere;
  const auto touches = touches_of(program, probe);
  double sum = 0.0, squares = 0.0;
  for (const Touch& touch : touches) {
    const double off = touch.latched[0] + kSum;
    sum += off;
    squares += off * off;
  }
  const double mean = sum / kTouches;
  EXPECT_NEAR(mean, 0.0, 3.0 * 0.5 * um / std::sqrt(kTouches));
  EXPECT_NEAR(std::sqrt(squares / kTouches - mean * mean), 0.5 * um, 0.06 * um);  // 3 sigma
  EXPECT_EQ(touches_of(program, probe).back().latched, touches.back().latched);
  EXPECT_NE(touches_of(program, "seed = 2\n" + probe).back().latched, touches.back().latched);
}

TEST(TouchProbe, LatchesLateAndStopsBehindTheContact) {
  const std::string program = "G0 Z0\nF600\nG38.2 X0\n#1 = #5420\nF60\nG91 G1 Y1\n";
  const model::Scenario scenario = scenario_of(program, "delay_us = 100\n" + kSphere);
  const PreparedCase prepared(scenario, scenario.cases[0]);
  const InterpretedProgram& read = prepared.parts().program;
  EXPECT_NEAR(read.touches.at(0).latched[0], -kSum + 1.0 * um, kFound);  // 10 mm/s x 100 us
  const double braking = 1e-4 / (2.0 * scenario.machine.nc.a_max[0]);    // v^2 / 2a
  double x = 0.0;
  for (const Move& move : read.moves) {
    if (is_motion(move.kind)) x = move.end_machine[0];
  }
  EXPECT_NEAR(x, -kSum + braking, kFound);
}

TEST(TouchProbe, LeavesWhereItTouched) {
  const auto touches =
      touches_of("G0 Z0\nG38.2 X0\nG38.4 X-40\nG38.3 X-30\n", "pretravel_um = 4\n" + kSphere);
  ASSERT_EQ(touches.size(), 3U);
  EXPECT_NEAR(touches[1].latched[0], touches[0].latched[0], 2.0 * kFound);
  EXPECT_FALSE(touches[2].has_switched);
  EXPECT_NEAR(touches[2].latched[0], -30.0 * mm, kFound);
}

TEST(TouchProbe, ShowsLostMotionBetweenBothSides) {
  const auto touches =
      touches_of("G0 Z0\nG38.2 X0\nG0 X-40\nG0 Z60\nG0 X40\nG0 Z0\nG38.2 X0\n", kSphere,
                 "machine_errors = \"e\"\n[errors.e]\nEXX = { reversal = { width_um = 4.0, "
                 "distance_mm = 0.05 } }\n" +
                     kCase);
  const double across = touches.at(1).latched[0] - touches.at(0).latched[0];
  EXPECT_NEAR(std::abs(across - 2.0 * kSum), 4.0 * um, kFound);
}

TEST(TouchProbe, MeetsTheWorkpieceWhereItLies) {
  const std::string stock =
      "[[part.stock]]\nbox = { from_mm = [-20, -10, -30], to_mm = [20, 10, 0] }\n" + kCase;
  const std::string program = "G0 X-40 Y5 Z-10\nG38.2 X20\nG0 X-40\nG0 Z60\nG0 X0\nG38.2 Z-20\n";
  auto touches = touches_of(program, "", stock);
  EXPECT_NEAR(touches.at(0).latched[0], -23.0 * mm, kFound);
  EXPECT_NEAR(touches.at(1).latched[2], 123.0 * mm, kFound);
  touches = touches_of(program, "workpiece_shift_mm = [0.3, 0, -0.2]\n", stock);
  EXPECT_NEAR(touches.at(0).latched[0], -22.7 * mm, kFound);
  EXPECT_NEAR(touches.at(1).latched[2], 122.8 * mm, kFound);
  // turned by 90 degrees about Z the short side stands across
  touches = touches_of(program, "workpiece_rotation_deg = [0, 0, 90]\n", stock);
  EXPECT_NEAR(touches.at(0).latched[0], -13.0 * mm, kFound);
}

TEST(TouchProbe, KnowsALengthToTheEndOfTheBallAndAStylusThatLeans) {
  const std::string plane = "[[touch_probe.plane]]\npoint_mm = [0, 0, 0]\nnormal = [0, 0, 2]\n";
  EXPECT_NEAR(touches_of("G38.2 Z-10\n", plane).at(0).latched[2], 123.0 * mm, kFound);
  EXPECT_NEAR(touches_of("G38.2 Z-10\n", "tool_length_to = \"end\"\n" + plane).at(0).latched[2],
              120.0 * mm, kFound);
  const std::string bore =
      "[[touch_probe.bore]]\ncentre_mm = [-40, 0]\ndiameter_mm = 50\nfrom_mm = -20\nto_mm = 0\n";
  const auto touches = touches_of("G0 Z-5\nG38.2 X0\nG0 X-40\nG38.2 X-80\n",
                                  "stylus_offset_um = [5, 0, 0]\n" + bore);
  EXPECT_NEAR(touches.at(0).latched[0], (-40.0 + 22.0) * mm - 5.0 * um, kFound);
  EXPECT_NEAR(touches.at(1).latched[0], (-40.0 - 22.0) * mm - 5.0 * um, kFound);
}

TEST(TouchProbe, ThatCannotBeginIsRefusedWhereItStands) {
  EXPECT_EQ(fault_of("G0 Z0\nG0 X-15\nG38.2 X0\n", kSphere),
            "touch.ngc:6:1: error: G38.2: the probe is in contact before the move starts");
  EXPECT_EQ(fault_of("G0 Z0\nG38.4 X0\n", kSphere),
            "touch.ngc:5:1: error: G38.4: the probe is not in contact where the move starts");
  EXPECT_EQ(fault_of("G0 Z30\nG38.2 X40\n", kSphere),
            "touch.ngc:5:1: error: G38.2: the probe makes no contact before the end of the move");
}

TEST(TouchProbe, ThatIsDescribedWronglyIsRefused) {
  const std::string program = "G0 Z0\nG38.2 X0\n";
  const auto message = [&](const std::string& probe) {
    const std::string text = fault_of(program, probe);
    return text.substr(text.find(": error: ") + 9);
  };
  EXPECT_EQ(message(""),
            "touch_probe: has no object to probe: add a [[touch_probe.sphere]], plane or bore, a "
            "[[part.stock]] or part.stl");
  EXPECT_EQ(message("workpiece = \"stock\"\n" + kSphere),
            "touch_probe.workpiece = \"stock\"; needs a [[part.stock]]");
  EXPECT_EQ(
      message("workpiece_shift_mm = [0, 0, 1]\n" + kSphere),
      "touch_probe.workpiece_shift_mm = [0, 0, 1]; has no effect: the probe meets no workpiece");
  EXPECT_EQ(message("[[touch_probe.plane]]\npoint_mm = [0, 0, 0]\nnormal = [0, 0, 0]\n"),
            "touch_probe.plane[0].normal = [0, 0, 0]; must not be zero");
  EXPECT_EQ(message("[[touch_probe.bore]]\ncentre_mm = [0, 0]\ndiameter_mm = 5\nfrom_mm = 0\n"
                    "to_mm = 0\n"),
            "touch_probe.bore[0].to_mm = 0; must be above from_mm");
}

}  // namespace
}  // namespace servomill::sim::preparation::touch_probe_test
