/// From the program of a circular test to the numbers that are printed.
#include "sim/preparation/circular_sections.h"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"
#include "tests/text.h"

namespace servomill::sim::preparation::circular_sections_test {
namespace {

// R = 28 mm; turns begin and end at speed, on a diagonal where no axis reverses.
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94 G64 P0.001\nF4000\n"
    "G0 X0 Y40\nG3 X40 Y0 I20 J-20\n"
    "(MSG, ccw)\nG3 X40 Y0 I-20 J20\n"
    "(MSG, approach)\nG3 X0 Y40 I-20 J20\nG2 X40 Y0 I20 J-20\n"
    "(MSG, cw)\nG2 X40 Y0 I-20 J20\n"
    "(MSG, approach)\nG2 X0 Y40 I-20 J20\n"
    "(MSG, half)\nG3 X40 Y0 I20 J-20\n"
    "(MSG, square)\nG1 X50\nG1 Y10\nG1 X40\nG1 Y0\n"
    "(MSG, line)\nG1 X30\n"
    "(MSG, skew)\nG1 X0 Y10 Z5\n"
    "(MSG, small)\nG3 X0 Y10 I-5 J0\n"
    "(MSG, zx)\nG18 G3 X0 Z5 I0 K-5\nM2\n";

std::string quantity(const std::string& name, const std::string& rest) {
  return "[[quantity]]\nname = \"" + name + "\"\n" + rest + "\n";
}

model::Scenario asking(const std::string& quantities,
                       const std::string& cases = "[[case]]\nname = \"one\"\n",
                       const std::string& root = "") {
  return small_scenario(kProgram, root + cases + quantities);
}

std::string faults_of(const std::string& quantities) {
  return fault_messages([&] { run::check_scenario(asking(quantities)); });
}

TEST(CircularSections, AreEvaluatedOneByOneOrInPairs) {
  const model::Scenario scenario =
      asking(quantity("circular_error", "sections = [\"ccw\", \"cw\", \"small\"]") +
             quantity("circle_squareness", "sections = [\"ccw\", \"cw\", \"cw\", \"ccw\"]"));
  ASSERT_EQ(scenario.quantities.size(), 5U);
  EXPECT_EQ(scenario.quantities[1].sections, (std::vector<std::string>{"cw"}));
  EXPECT_EQ(scenario.quantities[4].sections, (std::vector<std::string>{"cw", "ccw"}));
}

TEST(CircularSections, MustBeNamedAsMeant) {
  EXPECT_EQ(faults_of(quantity("circular_error", "sections = [\"ccw\", \"zx\"]")), "");
  EXPECT_EQ(faults_of(quantity("reversal_spike", "axis = \"Z\"\nsections = [\"zx\"]")), "");
  EXPECT_EQ(faults_of(quantity("circular_error", "")), "quantity[0].sections is missing\n");
  EXPECT_EQ(faults_of(quantity("circular_error", "sections = []")),
            "quantity[0].sections = []; must name at least one full circle\n");
  EXPECT_EQ(
      faults_of(quantity("bidirectional_circular_error", "sections = [\"ccw\", \"cw\", \"ccw\"]")),
      "quantity[0].sections = [\"ccw\", \"cw\", \"ccw\"]; must name pairs of full circles, one in "
      "each direction\n");
}

TEST(CircularSections, MustBeTurnsOfOneCircle) {
  const auto said = [](const std::string& name, const std::string& rest) {
    return faults_of(quantity(name, rest));
  };
  EXPECT_EQ(said("circular_error", "sections = [\"half\", \"ccw\", \"square\", \"line\"]"),
            "circular_error: small.ngc: section 'half' covers 180 deg of the circle; must be a "
            "full circle, 360 deg\ncircular_error: small.ngc: section 'square' is not a "
            "circle\ncircular_error: small.ngc: section 'line' is not a circle\n");
  EXPECT_EQ(said("radial_error_max", "sections = [\"skew\"]"),
            "radial_error_max: small.ngc: section 'skew' is in none of XY, YZ, ZX\n");
  EXPECT_EQ(said("reversal_spike", "axis = \"Z\"\nsections = [\"ccw\"]"),
            "reversal_spike: small.ngc: section 'ccw' is a circle in XY, where Z does not move\n");
  EXPECT_EQ(said("circle_squareness", "sections = [\"ccw\", \"ccw\"]"),
            "circle_squareness: small.ngc: sections 'ccw' and 'ccw' have the same direction; must "
            "be one clockwise and one counter-clockwise\n");
  EXPECT_EQ(said("mean_bidirectional_radial_error", "sections = [\"ccw\", \"small\"]"),
            "mean_bidirectional_radial_error: small.ngc: sections 'ccw' and 'small' are not the "
            "same circle\n");
}

// Without feed-forward the circle shrinks: DOMAIN.md section 9, R (1 - 1 / sqrt(1 + (w/Kv)^2)),
// within the 1 % that the velocity loop adds. A squareness error of the machine is found in both
// directions, whatever the lag.
TEST(CircularSections, GiveTheNumbersOfClosedForms) {
  const double R = std::sqrt(800.0) * mm, v = 4.0 / 60.0, Kv = 60.0;  // m, m/s, 1/s
  const double shrunk = R * (1.0 - 1.0 / std::hypot(1.0, v / R / Kv));
  const std::string both = "sections = [\"ccw\", \"cw\"]";
  const model::Scenario scenario = asking(
      quantity("mean_bidirectional_radial_error", both) + quantity("circle_squareness", both) +
          quantity("circular_error", "sections = [\"ccw\"]") +
          quantity("reversal_spike", "axis = \"X\"\nsections = [\"ccw\"]"),
      "[[case]]\nname = \"one\"\n[machine_override.nc]\nKv = 60.0\n"
      "velocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n"
      "[errors.square]\nEC0Y = { um_per_m = 50.0 }\n",
      "machine_errors = \"square\"\n");
  const run::CaseOutput output = run_named_case(scenario, "one");
  const auto rows =
      evaluation::compare(scenario.quantities, std::vector<evaluation::CaseData>{output.data()});
  EXPECT_NEAR(rows[0].value, shrunk / um, 0.01 * shrunk / um);
  constexpr double kAngleTol = 0.2;  // urad: 6 nm on the diameter, from joints of the path
  EXPECT_NEAR(rows[1].value, -50.0, kAngleTol) << "Y leans away from X: more than 90 deg";
  EXPECT_NEAR(rows[2].value, R * 50e-6 / um, 0.15) << "of an ellipse R gamma; joints of 0.1 um";
  EXPECT_LT(std::abs(rows[3].value), 0.1 * 0.5 * R * 50e-6 / um) << "no friction, no spikes";
}

TEST(CircularSections, HaveNoNumberWhereTheMachineDidNotFollow) {
  const model::Scenario scenario = asking(quantity("circular_error", "sections = [\"ccw\"]"));
  run::CaseOutput output = run_named_case(scenario, "one");
  const auto value = [&] {
    return evaluation::compare(scenario.quantities,
                               std::vector<evaluation::CaseData>{output.data()})[0]
        .value;
  };
  EXPECT_FALSE(std::isnan(value()));
  std::vector<double> data = output.result.servo.by_rows();
  const std::size_t x = output.result.servo.column("tool_position_true", 'X').value();
  for (std::size_t i = x; i < data.size(); i += output.result.servo.width()) data[i] += 10.0;
  records::Series moved(output.result.servo.signals());
  moved.append(data);
  output.result.servo = std::move(moved);
  EXPECT_TRUE(std::isnan(value())) << "10 mm beside the circle";
}

}  // namespace
}  // namespace servomill::sim::preparation::circular_sections_test
