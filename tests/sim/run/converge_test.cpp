#include "sim/run/converge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::run::converge_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ConvergedRow row(double value, std::array<double, kRefinements> change) {
  ConvergedRow out;
  out.row.value = value;
  out.change = change;
  return out;
}

TEST(StableDigits, AreThoseThatTwiceAllChangesLeaveAlone) {
  struct Example {
    double value, change;
    int digits;
    const char* stable;
  };
  for (const Example& e : {Example{0.0998, 0.002, 1, "0.10"},
                           {0.0998, -0.002, 1, "0.10"},
                           {95.794, 0.001, 4, "95.79"},
                           {19.88, 0.03, 2, "20"},
                           {19.88, 0.02, 3, "19.9"},
                           {123456.0, 60.0, 3, "123000"},
                           {65.0, 0.0, kAllDigits, "65"},
                           {0.0, 0.0, kAllDigits, "0"},
                           {0.1, 0.2, 0, "-"},
                           {0.0, 0.1, 0, "-"},
                           {kNaN, 0.0, 0, "-"},
                           {1.0, kNaN, 0, "-"}}) {
    const ConvergedRow one = row(e.value, {0.0, e.change, 0.0, 0.0});
    EXPECT_EQ(one.digits(), e.digits) << e.value << " " << e.change;
    EXPECT_EQ(one.stable(), e.stable) << e.value << " " << e.change;
  }
}

TEST(StableDigits, EndAtTheResolution) {
  ConvergedRow one = row(95.7941234, {0.0, 0.0, 0.0, 0.0});
  one.resolution = 0.0195;
  EXPECT_EQ(one.digits(), 3) << "half a step is 0.01";
  EXPECT_EQ(one.stable(), "95.8");
  EXPECT_TRUE(one.is_limited_by_resolution());
  one.change[0] = 0.001;
  EXPECT_EQ(one.digits(), 3) << "a change below the resolution";
  EXPECT_TRUE(one.is_limited_by_resolution());
  one.change[0] = 0.2;
  EXPECT_EQ(one.digits(), 2);
  EXPECT_FALSE(one.is_limited_by_resolution());
  one.change[0] = kNaN;
  EXPECT_EQ(one.digits(), 0);
}

TEST(StableDigits, AllStepsCount) {
  EXPECT_DOUBLE_EQ(row(1.0, {0.1, -0.2, 0.3, -0.4}).error(), 2.0);
}

class Converging : public testing::Test {
 protected:
  // @param more  after the keys of the root
  static std::string file(const std::string& more, const std::string& root = "") {
    const std::string path = testing::TempDir() + "converge_" +
                             testing::UnitTest::GetInstance()->current_test_info()->name() +
                             ".toml";
    std::ofstream(path) << "machine = \"" SERVOMILL_SOURCE_DIR
                           "/scenarios/machines/hsm600u.toml\"\n"
                           "imposed = \"imposed\"\n"
                        << root
                        << "[program]\nfile = \"small.ngc\"\n"
                           "text = \"G1 X40 F2400\\nG1 X0\\nM2\\n\"\n"
                           "[errors.imposed]\n"
                           "EYX = { harmonic = { amplitude_um = 100.0, period_mm = 20.0 } }\n"
                           "[[case]]\nname = \"nominal\"\n"
                        << more
                        << "[[quantity]]\nname = \"imposed_error_residual\"\naxis = \"Y\"\n"
                           "baseline = \"nominal\"\n";
    return path;
  }
  // The default length is 1 mm, the default tolerance 0.1 um.
  static std::string blocks(double max_block_mm, const std::string& servo = "ideal",
                            double tolerance_um = 10.0) {
    return "servo = \"" + servo + "\"\n[[case]]\nname = \"gcode\"\nservo = \"" + servo +
           "\"\n[[case.strategy]]\ntype = \"gcode\"\nmodel = \"imposed\"\naction = \"impose\"\n"
           "tolerance_um = " +
           std::to_string(tolerance_um) + "\nmax_block_mm = " + std::to_string(max_block_mm) + "\n";
  }
  static Convergence converge(const std::string& path, const std::set<Refinement>& which) {
    return find_convergence(input::ScenarioSource(path), which).value();
  }
  static double change(const Convergence& found, Refinement which) {
    return found.rows.at(0).change[static_cast<std::size_t>(which)];
  }
};

TEST_F(Converging, HalvesKeysOfTheScenario) {
  const model::Scenario one = input::ScenarioSource(file(blocks(1.0, "ideal", 0.1))).at();
  using Keys = std::vector<std::string>;
  EXPECT_EQ(halved(Refinement::recording, one), Keys{"record.period_ms=\"0.0005 s\""});
  EXPECT_EQ(halved(Refinement::block, one),
            (Keys{"case[1].strategy[0].tolerance_um=\"2.5e-08 m\"",
                  "case[1].strategy[0].max_block_mm=\"0.0005 m\"",
                  "case[1].strategy[0].tolerance_urad=\"1.25e-07 rad\"",
                  "case[1].strategy[0].max_block_deg=\"0.00872664625997165 rad\""}));
  EXPECT_EQ(halved(Refinement::solver, one), Keys{}) << "linear, and ideal";
  EXPECT_EQ(halved(Refinement::tick, one), Keys{"machine.nc.base_period_us=\"5e-06 s\""});
}

TEST_F(Converging, HalvesTheToleranceOfDrivesWithFriction) {
  const std::string friction = "[machine_override]\nfriction_model = \"lugre\"\n";
  const model::Scenario rubs = input::ScenarioSource(file(blocks(2.0, "cascade") + friction)).at();
  EXPECT_EQ(halved(Refinement::solver, rubs),
            std::vector<std::string>{"machine.solver_tolerance_nm=\"1e-12 m\""});
  EXPECT_EQ(rubs.machine.drives[0].solver_tolerance, 2e-12);
  const model::Scenario halved_once =
      input::ScenarioSource(file(blocks(2.0, "cascade") + friction),
                            {"machine.solver_tolerance_nm=\"1e-12 m\""})
          .at();
  EXPECT_EQ(halved_once.machine.drives[0].solver_tolerance, 1e-12);
}

TEST_F(Converging, LeavesBlocksThatAreAnInputAlone) {
  const input::ScenarioSource identified(file(blocks(3.2)));
  EXPECT_EQ(halved(Refinement::block, identified.at()), std::vector<std::string>{});
  const Convergence found = find_convergence(identified, {Refinement::block}).value();
  EXPECT_EQ(change(found, Refinement::block), 0.0);
  EXPECT_EQ(found.inputs,
            std::vector<std::string>{"case gcode: strategy gcode: tolerance_um, max_block_mm"});
  const std::string text = format_table(found);
  EXPECT_NE(text.find("not halved: case gcode: strategy gcode: tolerance_um, max_block_mm: not "
                      "the default, an input of the scenario\n"),
            std::string::npos)
      << text;
}

TEST_F(Converging, KnowsTheResolutionOfARow) {
  const model::Scenario servo = input::ScenarioSource(file(blocks(1.0, "cascade", 0.1))).at();
  evaluation::ComparisonRow of_y;
  of_y.case_name = "gcode";
  of_y.axis = "Y";
  of_y.unit = "um";
  EXPECT_NEAR(resolution_of(servo, of_y), servo.machine.scale[1].step() / 1e-6, 1e-12);
  EXPECT_GT(resolution_of(servo, of_y), 1e-3) << "um";
  const model::Scenario ideal = input::ScenarioSource(file(blocks(1.0, "ideal", 0.1))).at();
  EXPECT_NEAR(resolution_of(ideal, of_y), 1e-6, 1e-12) << "um: of the recording";
  of_y.unit = "1";
  EXPECT_EQ(resolution_of(servo, of_y), 0.0);
}

// The share of 100 um that a scale of step r can tell is r / 100 um.
TEST_F(Converging, SharesAreAsUncertainAsTheDisplacement) {
  const std::string share =
      "[[quantity]]\nname = \"realised_ratio\"\naxis = \"Y\"\nbaseline = \"nominal\"\n";
  const Convergence found = converge(file(blocks(1.0, "cascade", 0.1) + share), {});
  const ConvergedRow* brought = nullptr;
  for (const ConvergedRow& row : found.rows) {
    if (row.row.quantity == "realised_ratio" && row.row.case_name == "gcode") brought = &row;
  }
  ASSERT_NE(brought, nullptr);
  const model::Scenario scenario =
      input::ScenarioSource(file(blocks(1.0, "cascade", 0.1) + share)).at();
  const double step_um = scenario.machine.scale[1].step() / 1e-6;
  EXPECT_NEAR(brought->resolution, step_um, 0.02 * step_um) << "%, of 100 um";
  EXPECT_TRUE(brought->is_limited_by_resolution());
  EXPECT_EQ(brought->digits(), 3);
}

// A chord of length L across a sine of amplitude a misses it by a (2 pi / period)^2 L^2 / 8.
TEST_F(Converging, ChordsAreOfSecondOrderInTheLengthOfBlocks) {
  const std::string exact = "[machine_override.nc]\npath_tolerance_um = 0.001\n";
  const auto residual = [&](double length) {
    return converge(file(blocks(length) + exact), {}).rows.at(0).row.value;
  };
  const double coarse = residual(1.0) - residual(2.0), fine = residual(0.5) - residual(1.0);
  const double chord = 100.0 * std::pow(2.0 * M_PI / 20.0, 2) / 8.0;  // um, of 1 mm
  EXPECT_NEAR(coarse, -(4.0 - 1.0) * chord, 0.05 * 3.0 * chord);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

TEST_F(Converging, LinearDrivesAreExactAtAnyTick) {
  const Convergence found = converge(file(blocks(2.0, "cascade")),
                                     {Refinement::solver, Refinement::tick, Refinement::recording});
  EXPECT_EQ(change(found, Refinement::solver), 0.0);
  EXPECT_EQ(change(found, Refinement::block), 0.0) << "was not asked for";
  EXPECT_LT(std::abs(change(found, Refinement::tick)), 1e-6) << "um";
  EXPECT_LT(std::abs(change(found, Refinement::recording)), 0.1) << "um";
}

TEST_F(Converging, SaysWhatCannotBeHalved) {
  const Convergence found = converge(file(blocks(2.0, "cascade") + "[record]\nperiod_ms = 0.01\n"),
                                     {Refinement::recording});
  EXPECT_EQ(
      found.why_not[0],
      "record.period_ms = \"5e-06 s\"; must be an integer multiple of base_period_us = 10 of the "
      "machine");
  EXPECT_TRUE(std::isnan(change(found, Refinement::recording)));
  EXPECT_EQ(found.rows.at(0).digits(), 0);
  EXPECT_NE(to_json(found.rows[0])
                .find(R"("changes": {"recording": null, "block": 0, "solver": 0, )"
                      R"("tick": 0}, "resolution": )"),
            std::string::npos)
      << to_json(found.rows[0]);
  const std::string text = format_table(found);
  EXPECT_NE(text.find("not halved: recording period: record.period_ms"), std::string::npos) << text;
}

TEST_F(Converging, IsRefusedBeforeItRuns) {
  EXPECT_THROW(find_convergence(input::ScenarioSource(file("", "machine_errors = \"no\"\n")), {}),
               InputError);
}

}  // namespace
}  // namespace servomill::sim::run::converge_test
