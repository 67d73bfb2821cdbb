/// Whole cases, loops closed, moved by the exact propagator and by SUNDIALS: the same positions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::integrator_test {
namespace {

// nm; asked for is 1. A sub-step of the propagator may err by 2e-3; measured are 5e-5 in all.
constexpr double kAgreement = 1e-3;

// Reversals, a dwell in which the axes stick, a slow and a fast piece; about 1 s.
constexpr const char* kProgram =
    "G17 G64 P0.005\nG1 X3 Y-2 Z1 F3000\nX1 Y0.5\nG4 P0.15\nX1.4 Z0.6 F300\nG2 X1.4 Y0.5 I0.5 J0 "
    "F3000\nG1 X0 Y0 Z0\nM30\n";

// Largest difference (nm) of the true positions of X, Y, Z at any recorded time; each axis is what
// its text says.
void expect_agreement(const std::array<std::string, 3>& axes) {
  std::string toml;
  for (std::size_t j = 0; j < 3; ++j) {
    toml += fmt::format("[machine_override.axis.{}]\nscale_step = 0.0\nmotor_step = 0.0\n{}",
                        "XYZ"[j], axes[j]);
  }
  const model::Scenario scenario =
      small_scenario(kProgram, toml +
                                   "[[case]]\nname = \"exact\"\n[[case]]\nname = \"cvode\"\n"
                                   "machine_override.integrator = \"cvode\"\n");
  const records::Series one = run_named_case(scenario, "exact").result.servo;
  const records::Series other = run_named_case(scenario, "cvode").result.servo;
  ASSERT_EQ(one.rows(), other.rows());
  ASSERT_GT(one.rows(), 500U);
  for (const char letter : {'X', 'Y', 'Z'}) {
    const std::size_t column = one.column("true_linear", letter).value();
    double largest = 0.0;
    for (std::size_t n = 0; n < one.rows(); ++n) {
      largest = std::max(largest, std::abs(one.at(n, column) - other.at(n, column)));
    }
    largest *= mm / nm;
    testing::Test::RecordProperty(fmt::format("difference_{}_nm", letter),
                                  fmt::format("{:.3g}", largest));
    EXPECT_LE(largest, kAgreement) << letter;
  }
}

const std::string kSetValued = "friction.model = \"set_valued\"\n";

TEST(ExactAndCvode, AgreeWithNoneSetValuedAndLugreFriction) {
  expect_agreement({"", kSetValued, "friction.model = \"lugre\"\n"});
}

TEST(ExactAndCvode, AgreeWithRegularisedFrictionBacklashAndAWinding) {
  expect_agreement(
      {"friction.model = \"regularised\"\nfriction.regularisation_velocity = \"0.1 mm/s\"\n",
       kSetValued + "backlash = \"5 um\"\n",
       kSetValued +
           "current_loop = \"pi\"\nwinding = { inductance = \"8 mH\", resistance = \"0.6 ohm\", "
           "back_emf = \"0.9 V s/rad\", bandwidth = \"2500 rad/s\", reset_time_ms = 3.0, "
           "voltage_max = \"300 V\" }\n"});
}

// Both tell where the drives are at each evaluation of the error model.
TEST(ExactAndCvode, AgreeOnAVirtualEncoder) {
  const auto with = [](const std::string& integrator, const std::string& strategy) {
    const model::Scenario scenario = small_scenario(
        "G1 X1 F3000\nM30\n",
        "[errors.model]\nEYX = { harmonic = { amplitude_um = 50.0, period_mm = 2.0 } }\n"
        "[[case]]\nname = \"one\"\nmachine_override.integrator = \"" +
            integrator + "\"\n" + strategy);
    return run_named_case(scenario, "one").result.servo;
  };
  const std::string feedback = "[[case.strategy]]\ntype = \"feedback\"\nmodel = \"model\"\n";
  const records::Series exact = with("exact", feedback), cvode = with("cvode", feedback),
                        none = with("exact", "");
  ASSERT_EQ(exact.rows(), cvode.rows());
  ASSERT_EQ(exact.rows(), none.rows());
  const std::size_t y = exact.column("true_linear", 'Y').value();
  double largest = 0.0, way = 0.0;
  for (std::size_t n = 0; n < exact.rows(); ++n) {
    largest = std::max(largest, std::abs(exact.at(n, y) - cvode.at(n, y)) * mm / nm);
    way = std::max(way, std::abs(exact.at(n, y) - none.at(n, y)));
  }
  EXPECT_LE(largest, kAgreement);
  EXPECT_GT(way, 0.02);  // mm: the encoder moved it
}

}  // namespace
}  // namespace servomill::sim::integrator_test
