// Errors over several axes as a file has them.
#include "sim/input/read_grid.h"

#include <gtest/gtest.h>

#include "plant/kinematics/chain.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/config/document.h"
#include "sim/input/read_errors.h"
#include "sim/model/machine.h"

namespace servomill::sim::input::read_grid_test {
namespace {

// X -100..100 mm, Y unknown, Z 0..200 mm, C endless.
MachineAxes machine() {
  MachineAxes out(plant::make_chain(plant::parse_structure("[w C' b X Y Z t]")).layout);
  out.is_travel_known = true;
  out.lower[0] = -100 * mm;
  out.upper[0] = 100 * mm;
  out.lower[2] = 0.0;
  out.upper[2] = 200 * mm;
  return out;
}

plant::ErrorModel read(const std::string& text) {
  const config::Document document = config::Document::from_text(text, "m.toml");
  config::Reader root(document);
  plant::ErrorModel errors = read_errors(root, machine());
  root.finish();
  return errors;
}

std::string fault_of(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

AxisWords at(double x, double z, double c = 0.0) {
  AxisWords q = AxisWords::Zero();
  q[0] = x;
  q[2] = z;
  q[5] = c;
  return q;
}

TEST(ReadGrid, HasTheLastAxisInTheInnermostLists) {
  const plant::ErrorModel errors = read(
      "EZX = { grid = { axes = \"XZ\", at_mm = [[-100, 100], [0, 50, 200]], "
      "value_um = [[0, 1, 2], [3, 4, 5]] } }");
  const plant::ErrorFunction& f = errors.component(*plant::error_name_of("EZX"));
  EXPECT_NEAR(f.value(0.1, at(0.1, 0.05)), 4 * um, 1e-18);
  EXPECT_NEAR(f.value(0.0, at(0.0, 0.2)), 3.5 * um, 1e-18);
}

TEST(ReadGrid, HasAUnitForEachAxis) {
  const plant::ErrorModel errors = read(
      "EBX = { grid = { axes = \"CX\", at_mm_deg = [[0, 180, 360], [-100, 100]], "
      "value_urad = [[0, 0], [10, 30], [0, 0]] } }\n"
      "EXC = { grid = { axes = \"C\", at_deg = [[-180, 0, 180]], value_um = [8, 0, 8] } }");
  EXPECT_NEAR(errors.component(*plant::error_name_of("EBX")).value(0, at(0, 0, 90 * deg)),
              10 * urad, 1e-18);
  EXPECT_NEAR(errors.component(*plant::error_name_of("EXC")).value(0, at(0, 0, 45 * deg)), 2 * um,
              1e-18);
}

// Two turns on and one back, C is at the same place.
TEST(ReadGrid, RepeatsOverAnEndlessAxis) {
  const plant::ErrorModel errors =
      read("EXC = { grid = { axes = \"C\", at_deg = [[-180, 0, 180]], value_um = [8, 0, 8] } }");
  const plant::ErrorFunction& f = errors.component(*plant::error_name_of("EXC"));
  for (const double turns : {-1.0, 0.0, 2.0}) {
    EXPECT_NEAR(f.value(0, at(0, 0, (45 + 360 * turns) * deg)), 2 * um, 1e-17) << turns;
    EXPECT_NEAR(f.value(0, at(0, 0, (270 + 360 * turns) * deg)), 4 * um, 1e-17) << turns;
  }
}

TEST(ReadGrid, AddsToTheOtherTermsAndToOtherGrids) {
  const plant::ErrorModel errors = read(
      "EZX = { constant_um = 1.0, grid = ["
      "{ axes = \"X\", at_mm = [[-100, 0, 100]], value_um = [0, 4, 0], interpolation = \"cubic\" "
      "}, "
      "{ axes = \"Z\", at_mm = [[0, 200]], value_um = [0, 10] }] }");
  // the parabola through three points at half of their way: 3/4 of 4 um
  EXPECT_NEAR(errors.component(*plant::error_name_of("EZX")).value(0.05, at(0.05, 0.1)),
              (1 + 3 + 5) * um, 1e-18);
}

TEST(ReadGrid, RefusesWithTheRule) {
  const std::string head = "EZX = { grid = { axes = \"XZ\", at_mm = ";
  EXPECT_EQ(
      fault_of("EZX = { grid = { axes = \"XB\", at_mm = [[0]], value_um = [0] } }"),
      "m.toml:1:25: error: EZX.grid.axes = \"XB\"; must consist of axes of the machine, which "
      "has XYZC");
  EXPECT_EQ(fault_of("EZX = { grid = { axes = \"\", at_mm = [[0]], value_um = [0] } }"),
            "m.toml:1:25: error: EZX.grid.axes = \"\"; must name at least one axis");
  EXPECT_EQ(fault_of(head + "[[-100, 100], [0, 200]], value_um = [[0, 1], [2]] } }"),
            "m.toml:1:75: error: EZX.grid.value_um = [[0, 1], [2]]; must consist of 2 lists of 2 "
            "finite numbers");
  EXPECT_EQ(
      fault_of(head + "[[-100, 100], [0, 150]], value_um = [[0, 1], [2, 3]] } }"),
      "m.toml:1:39: error: EZX.grid.at_mm = [[-100, 100], [0, 150]]; must cover the travel of "
      "Z, 0 to 200 mm; covers 0 to 150");
  EXPECT_EQ(fault_of(head + "[[100, -100], [0, 200]], value_um = [[0, 1], [2, 3]] } }"),
            "m.toml:1:16: error: EZX.grid: -100 follows 100 among the positions of X; positions "
            "must increase");
  EXPECT_EQ(fault_of(head + "[[-100, 100]], value_um = [0, 1] } }"),
            "m.toml:1:16: error: EZX.grid: has positions of 1 axes and names 2 axes; the numbers "
            "must be equal");
  EXPECT_EQ(
      fault_of(head + "[[-100, 100], [0, 200]], value_um = [[0, 1], [2, 3]], "
                      "interpolation = \"spline\" } }"),
      "m.toml:1:109: error: EZX.grid.interpolation = \"spline\"; must be one of linear, cubic");
}

TEST(ReadGrid, WantsOneTurnOfAnEndlessAxis) {
  EXPECT_EQ(fault_of("EXC = { grid = { axes = \"C\", at_deg = [[0, 270]], value_um = [0, 0] } }"),
            "m.toml:1:39: error: EXC.grid.at_deg = [[0, 270]]; must cover one turn of C, whose "
            "travel is endless: 360 deg; covers 0 to 270");
  EXPECT_EQ(fault_of("EXC = { grid = { axes = \"C\", at_deg = [[0, 720]], value_um = [0, 0] } }"),
            "m.toml:1:39: error: EXC.grid.at_deg = [[0, 720]]; must cover one turn of C, whose "
            "travel is endless: 360 deg; covers 0 to 720");
  EXPECT_EQ(fault_of("EXC = { grid = { axes = \"C\", at_deg = [[0, 360]], value_um = [0, 1] } }"),
            "m.toml:1:16: error: EXC.grid: ends at 1 um or urad where it begins at 0 um or urad; "
            "over C, which repeats, both must be equal");
}

// An axis whose travel nobody knows cannot be covered.
TEST(ReadGrid, DoesNotAskForTravelThatIsNotKnown) {
  EXPECT_EQ(fault_of("EZX = { grid = { axes = \"Y\", at_mm = [[0, 1]], value_um = [0, 1] } }"),
            "none");
}

}  // namespace
}  // namespace servomill::sim::input::read_grid_test
