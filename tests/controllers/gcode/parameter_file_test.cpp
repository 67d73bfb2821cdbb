#include "controllers/gcode/parameter_file.h"

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::parameter_file_test {
namespace {

using Stored = std::map<int, double>;

std::string faults_of(const std::string& text) {
  try {
    parse_parameter_file(text, "p.var");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ParameterFile, HoldsANumberAndAValueInEachLine) {
  EXPECT_EQ(parse_parameter_file("100\t5.5\n5161 -3e1\r\n  5220   2  \n+5221 +.25", "p.var"),
            (Stored{{100, 5.5}, {5161, -30}, {5220, 2}, {5221, 0.25}}));
  EXPECT_EQ(parse_parameter_file("", "p.var"), Stored{});
}

TEST(ParameterFile, MayHoldRemarks) {
  EXPECT_EQ(
      parse_parameter_file("# by hand\n\n   \n; mine\n100 5 ;five\n(x)\n101 6#six\n%\n", "p.var"),
      (Stored{{100, 5}, {101, 6}}));
}

TEST(ParameterFile, NamesEveryFaultAtItsPlace) {
  EXPECT_EQ(faults_of("150 7\n100 5\n100.5 1\n0 1\n5602 1\n99999999999 1\n160\n170 x\n180 inf\n"
                      "190 5 6\n200 1,5\n5220 12\n5221 5"),
            "p.var:2:1: error: parameter 100 after 150; the numbers must increase\np.var:3:1: "
            "error: must start with a parameter number from 1 to 5601\np.var:4:1: error: parameter "
            "number 0; must be in 1 ... 5601\np.var:5:1: error: parameter number 5602; must be in "
            "1 ... 5601\np.var:6:1: error: must start with a parameter number from 1 to "
            "5601\np.var:7:4: error: parameter 160 requires a value\np.var:8:5: error: parameter "
            "170 requires a value\np.var:9:5: error: parameter 180 = inf; must be "
            "finite\np.var:10:7: error: unexpected '6' after the value of parameter "
            "190\np.var:11:6: error: unexpected ',5' after the value of parameter 200\np.var:12:6: "
            "error: parameter 5220 = 12, the active work offset; must be an integer from 1 to 9");
  EXPECT_EQ(faults_of("100 1\n100 1"),
            "p.var:2:1: error: parameter 100 after 100; the numbers must increase");
}

TEST(ParameterFile, IsWhatAProgramBeginsWith) {
  ProgramSetup setup = usual_setup();
  setup.stored = parse_parameter_file(
      "100 7\n5161 40\n5181 50\n5210 1\n5211 5\n5220 2\n5241 10\n5250 90\n5400 99\n", "p.var");
  setup.work_system = work_system_of(setup.stored);
  // machine = turned by 90 degrees (X5 + 7, 0) + 10
  const Move move = last_move("G0 X#100 Y0", setup);
  EXPECT_EQ(move.work_offset, 2);
  expect_axes(move.end_machine, axes(10, 12, 0));
  expect_axes(last_move("G28", setup).end_machine, axes(40, 0, 0));
  expect_axes(last_move("G0 X[#5400] Y0", setup).end,
              axes(0, 0, 0));  // no tool: set by the machine
}

TEST(ParameterFile, GivesWayToWhatIsSetForTheRun) {
  ProgramSetup setup = usual_setup();
  setup.stored = {{100, 7}, {5221, 3}};
  setup.parameters = {{"#100", 8}};
  setup.work_offset[0] = axes(4, 0, 0);
  expect_axes(last_move("G0 X#100", setup).end_machine, axes(12, 0, 0));
}

}  // namespace
}  // namespace servomill::controllers::parameter_file_test
