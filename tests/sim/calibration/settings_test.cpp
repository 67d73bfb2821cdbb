#include <gtest/gtest.h>

#include "sim/calibration/calibration.h"
#include "tests/sim/calibration/shop.h"
#include "tests/sim/readings/reading_files.h"
#include "tests/text.h"

namespace servomill::sim::calibration::settings_test {
namespace {

using plant::operator""_err;

class Settings : public testing::Test {
 protected:
  CalibrationSettings read(const std::string& text) {
    return read_settings(files_.write("readings.toml", text), gantry().layout);
  }
  std::string faults(const std::string& text) {
    return fault_messages([&] { read(text); });
  }
  readings::ReadingFiles files_;
};

TEST_F(Settings, AreDefaultsWithoutTheTable) {
  const CalibrationSettings settings = read("[[group]]\nkind = \"angle\"\n");
  EXPECT_TRUE(settings.errors.empty());
  EXPECT_FALSE(settings.robust);
  EXPECT_EQ(settings.frame, (std::array{Axis::X, Axis::Y}));
}

TEST_F(Settings, GiveEveryErrorItsForm) {
  const CalibrationSettings settings = read(R"([adjustment]
errors = ["EXX", "EC0Y"]
frame = "YX"
robust = true
[adjustment.form]
linear = { knots_mm = [0, 250, 1000], reversal = 1, reversal_distance_mm = 0.05 }
EXX = { polynomial = 3, harmonics_mm = [5, 10] }
EYX = { knots = 9 }
)");
  EXPECT_EQ(settings.errors, (std::vector{"EXX"_err, "EC0Y"_err}));
  EXPECT_EQ(settings.frame, (std::array{Axis::Y, Axis::X}));
  EXPECT_TRUE(settings.robust);
  EXPECT_EQ(*settings.form_linear.knots, (std::vector{0.0, 0.25, 1.0}));
  EXPECT_EQ(settings.form_linear.reversal_distance, 0.05e-3);
  ASSERT_EQ(settings.forms.size(), 2u);
  EXPECT_EQ(settings.forms[0].second.degree, 3);
  EXPECT_EQ(settings.forms[0].second.periods, (std::vector{5e-3, 10e-3}));
  EXPECT_EQ(settings.forms[1].second.number_of_knots, 9);
}

TEST_F(Settings, GiveErrorsGridsOverAnotherAxis) {
  const CalibrationSettings settings = read(R"([adjustment.form]
EZX = { knots = 9, grid = { axes = "XZ", knots = [5, 3] } }
EYX = { grid = [{ axes = "ZX", knots = [4, 7] }, { axes = "XY" }] }
)");
  ASSERT_EQ(settings.forms.size(), 2u);
  const FormSettings &one = settings.forms[0].second, &two = settings.forms[1].second;
  EXPECT_EQ(one.number_of_knots, 9);
  ASSERT_EQ(one.grids.size(), 1u);
  EXPECT_EQ(one.grids[0].across, Axis::Z);
  EXPECT_EQ(one.grids[0].knots, (std::array<std::optional<int>, 2>{5, 3}));
  ASSERT_EQ(two.grids.size(), 2u);
  EXPECT_EQ(two.grids[0].across, Axis::Z);
  EXPECT_EQ(two.grids[0].knots, (std::array<std::optional<int>, 2>{7, 4}));
  EXPECT_EQ(two.grids[1].across, Axis::Y);
  EXPECT_FALSE(two.grids[1].knots[0]);
}

TEST_F(Settings, RefuseGridsOfOtherAxes) {
  const std::string rule = "; must be X and another axis of the machine, as \"XZ\"\n";
  for (const char* axes : {"YZ", "X", "XX", "XB", "XYZ", "Xq"}) {
    EXPECT_EQ(
        faults(std::string("[adjustment.form]\nEZX = { grid = { axes = \"") + axes + "\" } }\n"),
        std::string("adjustment.form.EZX.grid.axes = \"") + axes + "\"" + rule);
  }
  EXPECT_EQ(faults("[adjustment.form]\nEZX = { grid = { axes = \"XZ\", knots = [5, 1] } }\n"),
            "adjustment.form.EZX.grid.knots = [5, 1]; must be two integers, a number for each of "
            "axes, from 2 to 100\n");
  EXPECT_EQ(
      faults("[adjustment.form]\nEZX = { grid = [{ axes = \"XZ\" }, { axes = \"ZX\" }] }\n"),
      "adjustment.form.EZX.grid = [{ axes = \"XZ\" }, { axes = \"ZX\" }]; has two grids over X "
      "and Z\n");
  EXPECT_EQ(faults("[adjustment.form]\nlinear = { grid = { axes = \"XZ\" } }\n"),
            "adjustment.form.linear.grid is not known\n");
}

TEST_F(Settings, NameAllThatIsWrong) {
  EXPECT_EQ(
      faults("[adjustment]\nerrors = [\"EXX\", \"EQX\"]\nframe = \"XX\"\n[adjustment.form]\n"
             "EC0Y = { polynomial = 1 }\nEXX = { knots = 1 }\n"
             "EYX = { knots_mm = [3, 3] }\nEZX = { polynomal = 3 }\n"),
      "adjustment.errors = [\"EXX\", \"EQX\"]; 'EQX' is not an error of ISO 230-1; expected a name "
      "such as EYX or EC0Y; did you mean 'EXX'?\nadjustment.frame = \"XX\"; must be two linear "
      "axes of the machine, such as \"XY\": the first one is straight by convention, the second is "
      "in their plane\nadjustment.form.EC0Y.polynomial is not known\nadjustment.form.EXX.knots = "
      "1; must be 0 or at least 2\nadjustment.form.EYX.knots_mm = [3, 3]; must be at least two "
      "positions, in ascending order\nadjustment.form.EZX.polynomal is not known; did you mean "
      "'polynomial'?\n");
}

}  // namespace
}  // namespace servomill::sim::calibration::settings_test
