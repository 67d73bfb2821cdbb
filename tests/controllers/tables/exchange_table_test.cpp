// Parameter files of the volumetric compensation of the ISG kernel, as its document has them.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>

#include "controllers/tables/etalon_table.h"
#include "controllers/tables/isg_table.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::exchange_table_test {
namespace {

ErrorColumns isg(const std::string& text) { return read_isg_table({"v.csv", text}); }
ErrorColumns etalon(const std::string& text) { return read_etalon_table({"v.exc", text}); }

std::string fault_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

std::string isg_fault(const std::string& text) {
  return fault_of([&] { isg(text); });
}

std::string etalon_fault(const std::string& text) {
  return fault_of([&] { etalon(text); });
}

// The examples of the document (296429067.html), joined by a file break.
constexpr const char* kExample =
    "// The header only contains position errors.\n"
    "Y0A Z0A X0B\n"
    "0.1 0.2 0.11\n"
    "#\n"
    "X      EXX    EYX    EZX    EAX    EBX    ECX\n"
    "0.0    0.02   0.01   0.07   0.00   0.0042 0.003\n"
    "10.0   0.00   -0.1   0.01   0.00   0.0011 0.002 // last record\n";

TEST(IsgTable, ReadsTheExamplesOfTheDocument) {
  const ErrorColumns errors = isg(kExample);
  ASSERT_EQ(errors.components.size(), 6U);
  EXPECT_EQ(errors.components[1].name, "EYX");
  EXPECT_EQ(errors.components[1].base_axis, Axis::X);
  ASSERT_EQ(errors.components[1].points.size(), 2U);
  EXPECT_DOUBLE_EQ(errors.components[1].points[1].position, 10.0 * mm);
  EXPECT_DOUBLE_EQ(errors.components[1].points[1].up, -0.1 * mm);
  EXPECT_EQ(errors.components[1].points[1].line, 7);
  EXPECT_DOUBLE_EQ(errors.components[4].points[0].up, 0.0042);  // rad
  ASSERT_EQ(errors.locations.size(), 3U);
  EXPECT_DOUBLE_EQ(errors.locations.at("EX0B").value, 0.11 * mm);
}

TEST(IsgTable, ArgumentsOfRotaryAxesAreInDegrees) {
  const ErrorColumns errors = isg("C\tECC\n0 0\n90 1e-5\n");
  EXPECT_DOUBLE_EQ(errors.components.at(0).points.at(1).position, 90.0 * deg);
  EXPECT_DOUBLE_EQ(errors.components.at(0).points.at(1).up, 1e-5);
}

TEST(IsgTable, ListsTheKinematicsThatItDoesNotRead) {
  EXPECT_EQ(isg("P0Z PXC LNX IDX C0Y\n-100 1 3 0 1e-5\n").not_read,
            (std::vector<std::string>{"P0Z", "PXC", "LNX"}));
}

// The example of the document: two blocks in one, for Z = 0 and Z = 100.
TEST(IsgTable, ReadsErrorsOverTwoAxes) {
  const ErrorColumns errors =
      isg("Z X EXX EYX\n0.0 0.0 0.02 0.01\n0.0 10.0 0.00 -0.1\n100.0 0.0 0.01 0.02\n"
          "100.0 10.0 0.03 -0.09\n");
  ASSERT_EQ(errors.grids.size(), 2U);
  EXPECT_TRUE(errors.components.empty());
  const ErrorGrid& EYX = errors.grids[1];
  EXPECT_EQ(EYX.name, "EYX");
  EXPECT_EQ(EYX.axes, (std::vector{Axis::Z, Axis::X}));
  EXPECT_DOUBLE_EQ(EYX.value(std::array{100 * mm, 10 * mm}), -0.09 * mm);
  // bilinear: a quarter of the way in Z, half of it in X
  EXPECT_DOUBLE_EQ(EYX.value(std::array{25 * mm, 5 * mm}),
                   (0.75 * (0.01 - 0.1) / 2 + 0.25 * (0.02 - 0.09) / 2) * mm);
  EXPECT_DOUBLE_EQ(EYX.value(std::array{-9 * mm, 70 * mm}), -0.1 * mm);
}

TEST(IsgTable, ReadsAnErrorOverAnotherAxisThanItsOwn) {
  const ErrorColumns errors = isg("C EXX\n0 0\n90 1\n");
  EXPECT_DOUBLE_EQ(errors.grids.at(0).value(std::array{45 * deg}), 0.5 * mm);
}

TEST(IsgTable, RefusesTheSameErrorOverOneAndOverTwoAxes) {
  EXPECT_EQ(isg_fault("X EXX\n0 0\n1 0\n#\nZ X EXX\n0 0 1\n0 1 2\n1 0 1\n1 1 2\n"),
            "v.csv:5: error: EXX appears twice");
}

TEST(IsgTable, RefusesByNameWhatItDoesNotHold) {
  EXPECT_EQ(isg_fault("EXX\n0.1\n"),
            "v.csv:1: error: EXX has no argument; must be a function of an axis position");
  EXPECT_EQ(isg_fault("X C0Y\n0 1e-5\n10 1e-5\n"),
            "v.csv:1: error: C0Y is a function of X; only constant position errors are supported");
  EXPECT_EQ(isg_fault("C0Y\n1e-5\n1e-5\n"),
            "v.csv:3: error: C0Y: 2 records of a position error; must be one");
  EXPECT_EQ(isg_fault("VXC VYC VZC C0Y\n0 0.7 0.7 1e-5\n"),
            "v.csv:2: error: VYC is not 0; axes with modified orientation are not supported");
  EXPECT_EQ(isg_fault("IDX C0Y\n5 1e-5\n"),
            "v.csv:2: error: IDX is not 0; offsets of the programmed values are not supported");
}

TEST(IsgTable, RefusesWhatIsNoTable) {
  EXPECT_EQ(isg_fault("X,EXX\n0,0\n1,0\n"),
            "v.csv:1: error: contains a comma or a semicolon; columns must be separated by spaces "
            "and numbers use decimal points");
  EXPECT_EQ(isg_fault("X EXX\n0 0,1\n"),
            "v.csv:2: error: contains a comma or a semicolon; columns must be separated by spaces "
            "and numbers use decimal points");
  EXPECT_EQ(isg_fault("X EXX EYX\n0 0\n"), "v.csv:2: error: 2 values for 3 columns");
  EXPECT_EQ(isg_fault("X EXX\n0 0\n"), "v.csv:1: error: EXX: 1 points; must be >= 2");
  EXPECT_EQ(isg_fault("X EXX\n0 0\n0 0\n"), "v.csv:3: error: EXX: the positions must increase");
  EXPECT_EQ(isg_fault("X EXX\n0 0\n1 nan\n"), "v.csv:3: error: 'nan' must be a number");
  EXPECT_EQ(isg_fault("X EXX EXX\n0 0 0\n1 0 0\n"), "v.csv:1: error: EXX appears twice");
  EXPECT_EQ(isg_fault("X EXX\n0 0\n1 0\n#\nX EXX\n0 0\n1 0\n"),
            "v.csv:5: error: EXX appears twice");
  EXPECT_EQ(isg_fault("X EXQ\n0 0\n1 0\n"), "v.csv:1: error: 'EXQ' is not a parameter of TF5280");
  EXPECT_EQ(isg_fault("U EXX\n0 0\n1 0\n"), "v.csv:1: error: 'U' is not an axis");
  EXPECT_EQ(isg_fault("C0Y\n#\n"), "v.csv:1: error: a header without a record");
  EXPECT_EQ(isg_fault("// nothing\n"), "v.csv: error: contains no geometric error");
}

// The examples of the document (296430091.html).
TEST(EtalonTable, ReadsTheExamplesOfTheDocument) {
  const ErrorColumns errors = etalon(
      "// Every parameter is specified in a block.\n"
      "[C0B]\nVALUE = 0.000022355737\n[A0B]\nVALUE = 0.000047622950\n"
      "[EXY]\nGridpoints = {\n  -280.0 -0.001358635132\n  -270.0 -0.000240680764\n"
      "}  // end of EXY\n");
  EXPECT_DOUBLE_EQ(errors.locations.at("EC0B").value, 0.000022355737);
  EXPECT_EQ(errors.locations.at("EA0B").line, 5);
  ASSERT_EQ(errors.components.size(), 1U);
  EXPECT_EQ(errors.components[0].name, "EXY");
  EXPECT_EQ(errors.components[0].base_axis, Axis::Y);
  EXPECT_DOUBLE_EQ(errors.components[0].points.at(1).position, -270.0 * mm);
  EXPECT_DOUBLE_EQ(errors.components[0].points.at(1).up, -0.000240680764 * mm);
}

TEST(EtalonTable, RefusesWhatTheDocumentDoesNotHave) {
  EXPECT_EQ(etalon_fault("[General]\nUnit = mm\n"),
            "v.exc:1: error: [General] is not a geometric error");
  EXPECT_EQ(etalon_fault("[C0B]\n[A0B]\nVALUE = 0\n"), "v.exc:1: error: [C0B] has no value");
  EXPECT_EQ(etalon_fault("[C0B]\nValue = 0\n"),
            "v.exc:2: error: 'Value' is not supported in [C0B]; must be VALUE = number");
  EXPECT_EQ(etalon_fault("[EXY]\nVALUE = 0\n"),
            "v.exc:2: error: 'VALUE' is not supported in [EXY]; must be Gridpoints = {");
  EXPECT_EQ(etalon_fault("VALUE = 0\n"), "v.exc:1: error: VALUE is outside any block");
  EXPECT_EQ(etalon_fault("[EXY]\nGridpoints = {\n0 0\n1 0\n"),
            "v.exc:4: error: the file ends within Gridpoints");
  EXPECT_EQ(etalon_fault("[EXY]\nGridpoints = {\n0 0 0\n"),
            "v.exc:3: error: 3 values; a grid point requires two");
  EXPECT_EQ(etalon_fault("[C0B]\nVALUE = 0\nVALUE = 1\n"),
            "v.exc:3: error: the block already has a value");
  EXPECT_EQ(etalon_fault("[C0B]\nVALUE = 0\n[C0B]\nVALUE = 1\n"),
            "v.exc:4: error: EC0B appears twice");
  EXPECT_EQ(etalon_fault("[C0B\nVALUE = 0\n"), "v.exc:1: error: ']' is missing");
  EXPECT_EQ(etalon_fault("[C0B]\nVALUE\n"), "v.exc:2: error: 'VALUE' is not an assignment");
}

}  // namespace
}  // namespace servomill::controllers::exchange_table_test
