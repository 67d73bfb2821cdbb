#include <gtest/gtest.h>

#include <cmath>

#include "sim/readings/readings.h"
#include "tests/sim/readings/reading_files.h"
#include "tests/text.h"

namespace servomill::sim::readings::read_readings_test {
namespace {

// The groups of README.md, each with rows.
constexpr const char* kLaser = R"([[group]]
name = "X, laser"
kind = "positioning"
axis = "X"
readings = "x.csv"
at = { Y_mm = 200, Z_mm = 100 }
point_mm = [0, 0, -120]
uncertainty_um = 0.5
)";

class ReadReadings : public testing::Test {
 protected:
  ReadReadings() {
    files_.write("x.csv", "target_mm,direction,run,deviation_um\n0,+,1,0\n500,-,2,3\n");
  }
  Readings read(const std::string& text) {
    return read_three_axis(files_.write("readings.toml", text));
  }
  std::string faults(const std::string& text) {
    return fault_messages([&] { read(text); });
  }
  ReadingFiles files_;
};

TEST_F(ReadReadings, PutsPositioningWhereItWasMeasured) {
  const Readings all = read(kLaser);
  ASSERT_EQ(all.groups.size(), 1u);
  const Group& group = all.groups[0];
  EXPECT_EQ(group.axis, Axis::X);
  EXPECT_EQ(group.uncertainty, 0.5e-6);
  EXPECT_EQ(group.p_ST, Eigen::Vector3d(0.0, 0.0, -0.12));
  ASSERT_EQ(group.rows.size(), 2u);
  Joints Q = Joints::Zero();
  Q.head<3>() << 0.5, 0.2, 0.1;
  EXPECT_EQ(group.rows[1].Q, Q);
  EXPECT_EQ(group.rows[1].deviation[0], 3e-6);
  EXPECT_EQ(group.rows[1].direction[0], -1);
  EXPECT_EQ(group.rows[1].run, 1);
  EXPECT_EQ(place_of(group, group.rows[1]), files_.path("x.csv") + ":3");
}

TEST_F(ReadReadings, ReadsPositionsOfRunsBesideTheirTarget) {
  files_.write("x.csv",
               "direction,target_mm,p1,p2\nforward,10,10.001,10.002\nbackward,10,9.999,10\n");
  const Group group = read(kLaser).groups.at(0);
  ASSERT_EQ(group.rows.size(), 4u);
  EXPECT_NEAR(group.rows[1].deviation[0], 2e-6, 1e-15);
  EXPECT_EQ(group.rows[1].run, 1);
  EXPECT_NEAR(group.rows[2].deviation[0], -1e-6, 1e-15);
  EXPECT_EQ(group.rows[2].direction[0], -1);
}

TEST_F(ReadReadings, TakesTheTargetFromAPosition) {
  files_.write("x.csv", "target_mm,position_mm\n10,10.001\n");
  EXPECT_NEAR(read(kLaser).groups.at(0).rows.at(0).deviation[0], 1e-6, 1e-15);
}

TEST_F(ReadReadings, ReadsThreeNumbersOfAnRTest) {
  files_.write("r.csv", "X_mm,Y_mm,Z_mm,dx_um,dy_um,dz_um\n1,2,3,4,5,6\n");
  const Group group = read(
                          "[[group]]\nkind = \"r_test\"\npoint_mm = [0, 0, -50]\n"
                          "uncertainty_um = 1\ntool = \"adjusted\"\nreadings = \"r.csv\"\n")
                          .groups.at(0);
  EXPECT_TRUE(group.tool_is_known);
  EXPECT_NEAR((group.rows.at(0).deviation - 1e-6 * Eigen::Vector3d(4, 5, 6)).norm(), 0.0, 1e-18);
}

TEST_F(ReadReadings, PutsACircleRoundItsCentreAndGivesAxesTheirDirections) {
  files_.write("c.csv", "angle_deg,direction,deviation_um\n45,ccw,1\n45,cw,2\n");
  const Group group = read(
                          "[[group]]\nkind = \"circle\"\nplane = \"XY\"\nradius_mm = 100\n"
                          "at = { X_mm = 300, Y_mm = 300, Z_mm = 0 }\npoint_mm = [0, 0, 0]\n"
                          "uncertainty_um = 0.5\nreadings = \"c.csv\"\n")
                          .groups.at(0);
  ASSERT_EQ(group.rows.size(), 2u);
  EXPECT_NEAR(group.rows[0].Q[0], 0.3 + 0.1 * std::sqrt(0.5), 1e-15);
  EXPECT_EQ(group.rows[0].direction[0], -1);  // counter-clockwise at 45 degrees: -X, +Y
  EXPECT_EQ(group.rows[0].direction[1], 1);
  EXPECT_EQ(group.rows[1].direction[0], 1);
}

TEST_F(ReadReadings, GivesEverySphereItsPlaceInTheOrderOfTheRows) {
  files_.write("s.csv", "sphere,X_mm,Y_mm,Z_mm\nleft,1,2,3\nright,4,5,6\nleft,1,2,3\n");
  const Group group = read(
                          "[[group]]\nkind = \"sphere\"\npoint_mm = [0, 0, -50]\n"
                          "uncertainty_um = 1\nreadings = \"s.csv\"\n")
                          .groups.at(0);
  ASSERT_EQ(group.rows.size(), 3u);
  EXPECT_EQ(group.spheres, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(group.rows[2].sphere, 0u);
}

constexpr const char* kTouches = R"([[artefact]]
name = "plate"
centres = "plate.csv"
uncertainty_um = 0.4
scale_uncertainty_um_per_m = 0.3

[[group]]
kind = "touch"
artefact = "plate"
sphere_mm = 20
stylus_mm = 6
pretravel = { waves = 3, size_um = 2 }
point_mm = [0, 0, -50]
uncertainty_um = 1
readings = "s.csv"
)";

TEST_F(ReadReadings, TouchesBallsOfAnArtefact) {
  files_.write("plate.csv", "sphere;X_mm;Y_mm;Z_mm\na;0;0;0\nb;100,0002;0;0\n");
  files_.write("s.csv", "sphere,X_mm,Y_mm,Z_mm\nb,4,5,6\n");
  const Readings all = read(kTouches);
  EXPECT_DOUBLE_EQ(all.artefacts.at(0).balls.at(1).centre.x(), 0.1000002);
  EXPECT_NEAR(all.artefacts[0].scale_uncertainty, 0.3e-6, 1e-18);
  const Group& group = all.groups.at(0);
  EXPECT_EQ(group.artefact, 0u);
  EXPECT_DOUBLE_EQ(group.radius, 0.013);
  EXPECT_EQ(group.lobes, 3);
  EXPECT_EQ(group.lobe_size, 2e-6);
}

TEST_F(ReadReadings, KnowsEveryBallOfAnArtefact) {
  files_.write("plate.csv", "sphere,X_mm,Y_mm,Z_mm\nball 1,0,0,0\nball 1,100,0,0\n");
  files_.write("s.csv", "sphere,X_mm,Y_mm,Z_mm\nball 2,4,5,6\n");
  EXPECT_EQ(faults(kTouches),
            "sphere ball 1 appears twice\n"
            "sphere ball 2 is not among the balls of \"plate\" (" +
                files_.path("plate.csv") + "); did you mean 'ball 1'?\n");
}

TEST_F(ReadReadings, ReadsTheSurfaceOfAPart) {
  files_.write("p.csv", "X_mm,Y_mm,Z_mm,nx,ny,nz,deviation_um\n1,2,3,0,0.6,0.8,4\n");
  const std::string text =
      "[[group]]\nkind = \"part\"\npoint_mm = [0, 0, -50]\nuncertainty_um = 1\n"
      "feature = \"centre\"\nreadings = \"p.csv\"\n";
  const Group group = read(text).groups.at(0);
  EXPECT_FALSE(group.is_surface);
  EXPECT_NEAR((group.rows.at(0).normal - Eigen::Vector3d(0.0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  files_.write("p.csv", "X_mm,Y_mm,Z_mm,nx,ny,nz,deviation_um\n1,2,3,0,0.6,0.6,4\n");
  EXPECT_EQ(faults(text), "nx, ny, nz have length 0.849; a normal must have length 1\n");
}

TEST_F(ReadReadings, DeadPathsAreThoseOfLasers) {
  const std::string path =
      "dead_path = { length_mm = 200, wavelength_uncertainty_um_per_m = 0.2 }\n";
  const Group group = read(kLaser + path).groups.at(0);
  EXPECT_EQ(group.dead_path->length, 0.2);
  EXPECT_NEAR(group.dead_path->change, 0.2e-6, 1e-18);
  std::string angle = kLaser + path;
  angle.replace(angle.find("positioning"), 11, "straightness");
  angle += "direction = \"Y\"\n";
  EXPECT_EQ(faults(angle),
            "group[0].dead_path = {...}; must be a laser group of kind positioning\n");
}

TEST_F(ReadReadings, WantsToKnowWhereEveryAxisStood) {
  std::string text = kLaser;
  text.replace(text.find("at = "), text.find("point") - text.find("at = "),
               "at = { Y_mm = 200 }\n");
  EXPECT_EQ(faults(text),
            "group \"X, laser\" does not give the position of Z; add Z_mm to its table at, "
            "or a column to " +
                files_.path("x.csv") + "\n");
}

TEST_F(ReadReadings, NamesAllThatIsWrongWithRowsAtOnce) {
  files_.write("x.csv",
               "target_mm,direction,deviation_um,temperature_degC\n"
               "0,left,0,20\n"
               "1500,+,0,20\n"
               "100,+,7000,20\n"
               "200,+,,20\n"
               "300,+,1,68\n");
  EXPECT_EQ(faults(kLaser),
            "direction = left; must be forward or backward (up, down, positive, negative, +, -, "
            "cw, ccw)\n"
            "X = 1500 mm is outside the travel of the machine, 0 to 1000 mm\n"
            "deviation of 7 mm; must be at most 5 mm: check unit and sign of target and position\n"
            "deviation_um is empty\n"
            "temperature_degC = 68; must be between -10 and 50 degC (is it in Fahrenheit?)\n");
}

TEST_F(ReadReadings, RefusesColumnsThatAKindDoesNotHaveAndUnitsOfAnotherQuantity) {
  files_.write("x.csv", "target_mm,deviaton_um\n0,0\n");
  EXPECT_EQ(faults(kLaser),
            "column deviaton_um is unknown in readings of kind positioning; did you mean "
            "'deviation'?; known are direction, run, time, temperature_degC, X, Y, Z, deviation, "
            "position, target\n"
            "no column of values; expected one of deviation, position\n");
  files_.write("x.csv", "target_mm,deviation_urad\n0,0\n");
  EXPECT_EQ(faults(kLaser),
            "column deviation_urad must name a length in its unit, such as deviation_mm\n");
}

TEST_F(ReadReadings, RefusesATargetTwiceInARun) {
  files_.write("x.csv", "target_mm,run,deviation_um\n0,1,1\n100,1,2\n0,1,1\n0,2,1\n");
  EXPECT_EQ(faults(kLaser),
            "repeats the target of line 2, run 1 and direction; number the runs, or remove one of "
            "the two\n");
  files_.write("x.csv", "target_mm,deviation_um\n0,1\n100,2\n0,1\n");
  EXPECT_EQ(read(kLaser).groups.at(0).rows.size(), 3u);
}

TEST_F(ReadReadings, NamesTheRunThatIsMissing) {
  files_.write("x.csv", "direction,target_mm,p1,p2\nforward,10,10.001,\n");
  EXPECT_EQ(faults(kLaser),
            "run 2 is missing at this target; use one row per reading (columns target, run, "
            "position) to omit readings\n");
}

TEST_F(ReadReadings, SharesTheScaleOfAnInstrument) {
  const Readings all =
      read("[[instrument]]\nname = \"laser\"\nscale_uncertainty_um_per_m = 0.25\n" +
           std::string(kLaser) + "instrument = \"laser\"\n");
  ASSERT_EQ(all.instruments.size(), 1u);
  EXPECT_EQ(all.instruments[0].scale_uncertainty, 0.25e-6);
  EXPECT_EQ(all.groups[0].instrument, 0u);
  EXPECT_EQ(faults("[[instrument]]\nname = \"laser\"\n" + std::string(kLaser) +
                   "instrument = \"lasr\"\n"),
            "group[0].instrument = \"lasr\"; is not in the list [[instrument]]; did you mean "
            "'laser'?\n");
}

TEST_F(ReadReadings, EstimatesAnUncertaintyOnlyWhereItIsAskedTo) {
  std::string text = kLaser;
  text.replace(text.find("uncertainty_um = 0.5"), 20, "uncertainty = \"estimate\"");
  EXPECT_FALSE(read(text).groups[0].uncertainty);
  text.replace(text.find("uncertainty = "), 24, "");
  EXPECT_EQ(faults(text), "group[0].uncertainty_um is missing\n");
}

TEST_F(ReadReadings, RefusesAxesThatTheMachineLacksAndDirectionsOfTheAxisItself) {
  EXPECT_EQ(faults("[[group]]\nkind = \"straightness\"\naxis = \"X\"\ndirection = \"X\"\n"
                   "readings = \"x.csv\"\npoint_mm = [0, 0, 0]\nuncertainty_um = 1\n"),
            "group[0].direction = \"X\"; is the direction of the axis itself: use kind = "
            "\"positioning\"\n");
  EXPECT_EQ(faults("[[group]]\nkind = \"angle\"\naxis = \"C\"\ndirection = \"A\"\n"
                   "readings = \"x.csv\"\npoint_mm = [0, 0, 0]\nuncertainty_urad = 1\n"),
            "group[0].axis = \"C\"; is not an axis of the machine\n");
}

}  // namespace
}  // namespace servomill::sim::readings::read_readings_test
