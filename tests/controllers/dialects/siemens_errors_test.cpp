// Programs that the reader for Siemens 840D sl refuses, with the whole message.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "controllers/dialects/siemens_reader.h"
#include "plant/vocabulary/input_error.h"
#include "tests/controllers/dialects/siemens_examples.h"

namespace servomill::controllers::siemens_errors_test {
namespace {

std::string fault_of(const std::string& program, const SiemensSettings& settings = {}) {
  try {
    read_siemens(program, "p.mpf", siemens_example_setup(), settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

struct Refused {
  const char* program;  // M30 follows it
  const char* message;
};

void expect_refused(const std::string& head, std::initializer_list<Refused> cases) {
  for (const auto& [program, message] : cases) {
    EXPECT_EQ(fault_of(head + program + "\nM30\n"), std::string("p.mpf:") + message) << program;
  }
}

TEST(SiemensErrors, TextThatIsNoBlock) {
  expect_refused(
      "",
      {
          {"?", "1:1: error: '?' does not start a word"},
          {"G1 X1.2.3", "1:8: error: '.' does not start a word"},
          {"G1 \x01", "1:4: error: byte 0x01 does not start a word"},
          {"X", "1:2: error: X requires a number"},
          {"X-", "1:2: error: X requires a number"},
          {"X=", "1:3: error: X requires a number"},
          {"X=R1", "1:3: error: X=R1: only numbers, AC(...) and IC(...) are supported"},
          {"X=IC(R1)", "1:6: error: IC requires a number"},
          {"X=IC(1,2)", "1:7: error: IC(...) must contain one number"},
          {"X=IC 1", "1:6: error: IC requires a number in parentheses"},
          {"X=2*3", "1:4: error: X=: expressions are not supported"},
          {"T=\"A", "1:3: error: the string is not closed; '\"' is missing"},
          {"MSG(\"a)", "1:4: error: the parenthesis is not closed"},
          {"S2=1000", "1:1: error: S2=: extended addresses are not supported"},
          {"LABEL: G0", "1:1: error: LABEL: labels and jumps are not supported"},
          {"/3 G0", "1:1: error: /3: skip level 3 has its own switch; only that of / is supported"},
          {"/00 G0", "1:1: error: skip levels are /0 ... /9"},
          {"N1234567890 G0", "1:2: error: block number with 10 digits; at most 9"},
          {"G0 N10", "1:4: error: N is the block number and must start the block"},
          {"; ok\n\nG0 \xef\xbb\xbf", "3:4: error: byte 0xef does not start a word"},
      });
  EXPECT_EQ(fault_of(std::string(600, 'X')),
            "p.mpf:1:513: error: the line has 600 characters; a block has at most 512");
  EXPECT_EQ(fault_of("X" + std::string(400, '9')), "p.mpf:1:2: error: X: the number is too long");
  EXPECT_EQ(fault_of("X-2000000000"),
            "p.mpf:1:2: error: X = -2000000000; must be between -1e9 and 1e9");
}

TEST(SiemensErrors, WordsThatAreNotRead) {
  expect_refused(
      "",
      {
          {"SUPPA", "1:1: error: SUPPA is not supported; did you mean 'SUPA'?"},
          {"ABCDEFGH", "1:1: error: ABCDEFGH is not supported"},
          {"G33", "1:1: error: G33 is not supported"},
          {"G1.5", "1:1: error: G = 1.5; must be an integer from 0 to 999"},
          {"G41 X1", "1:1: error: G41 activates cutter radius compensation; it is not supported"},
          {"G53 X1",
           "1:1: error: G53 leaves the basic frame active, which is unknown here; use SUPA to "
           "suppress it; it is not supported"},
          {"G59",
           "1:1: error: G59 is an axial offset of the programmable frame, not a work offset; it is "
           "not supported"},
          {"TRAORI",
           "1:1: error: TRAORI activates a transformation with unknown parameters; it is not "
           "supported"},
          {"AP=30", "1:1: error: AP is a polar angle; it is not supported"},
          {"GOTOF", "1:1: error: GOTOF jumps; it is not supported"},
          {"M98", "1:1: error: M98 is not supported"},
          {"H1", "1:1: error: H is not supported"},
          {"R1=2", "1:1: error: R1=: extended addresses are not supported"},
          {"CYCLE800(1)",
           "1:1: error: CYCLE800 swivels the plane by data of the machine builder; it is not "
           "supported"},
          {"SUPA(1)", "1:1: error: SUPA does not have this form"},
          {"T=\"MILL\"", "1:1: error: T=\"MILL\": only numeric tool names are supported"},
          {"X=\"1\"", "1:1: error: X=\"...\": only T accepts a name"},
          {"F=AC(1)", "1:1: error: F: AC(...) and IC(...) are allowed for axes and I J K only"},
      });
}

TEST(SiemensErrors, WordsThatDoNotGoTogether) {
  expect_refused(
      "",
      {
          {"G0 X1 X2", "1:7: error: X appears twice"},
          {"T1 T2", "1:4: error: T appears twice"},
          {"G0 G1", "1:4: error: G0 and G1 in one block (same G group)"},
          {"G54 G507", "1:5: error: G54 and G507 in one block (same G group)"},
          {"TRANS X10", "1:1: error: TRANS must be in a separate block"},
          {"G0 TRAFOOF", "1:4: error: TRAFOOF must be in a separate block"},
          {"G1 CYCLE832(0.1,1,1)", "1:4: error: CYCLE832 must be in a separate block"},
          {"CYCLE832(0.1,1)",
           "1:1: error: CYCLE832(0.1,1): tolerance, type and orientation tolerance are required"},
          {"CYCLE832(0.1,112,1)",
           "1:1: error: CYCLE832(0.1,112,1): types 0 to 4 and 10 to 14 are supported"},
          {"CYCLE832(0,1,1)", "1:1: error: CYCLE832(0,1,1): the tolerance must be > 0"},
          {"CYCLE832(0.1,_FINISH,1)",
           "1:1: error: CYCLE832(0.1,_FINISH,1): the parameters must be numbers"},
          {"G4",
           "1:1: error: G4 must be in a separate block, with F in seconds or S in revolutions"},
          {"G4 F1 M3",
           "1:1: error: G4 must be in a separate block, with F in seconds or S in revolutions"},
          {"G4 F-1", "1:1: error: dwell time -1 s; must be from 0 to 1e+06 s"},
          {"M3 M5", "1:4: error: two M functions of the same group in one block"},
          {"T1 M6 G0",
           "1:1: error: a tool change must be in a separate block, with T, M6 and D only"},
          {"G0 X1 M8",
           "1:7: error: M8 in a block with a motion: the machine builder defines whether it acts "
           "before or after the motion"},
          {"G0 X1 S500",
           "1:7: error: S in a block with a motion: the machine builder defines whether it acts "
           "before or after the motion"},
          {"F0", "1:1: error: F = 0; must be > 0"},
          {"M6", "1:1: error: M6 requires T: the tool is unknown"},
          {"T1 D1",
           "1:4: error: D with T but without M6: it is undetermined whether it applies to the old "
           "or the new tool"},
          {"D1.5", "1:1: error: D = 1.5; must be an integer from 0 to 32000"},
      });
}

TEST(SiemensErrors, ModesThatNobodySet) {
  expect_refused(
      "",
      {
          {"X1", "1:1: error: positions require an active G0, G1, G2 or G3"},
          {"G0 X1", "1:1: error: cutter radius compensation may be active; cancel it with G40"},
          {"G40 G0 SUPA X1", "1:13: error: the unit system is unknown; program G710 or G700"},
          {"G40 G0 SUPA G710 X1", "1:18: error: G90 or G91 must be active"},
          {"G40 G0 G90 G710 X1",
           "1:1: error: a programmable frame may be active; clear it with TRANS in a separate "
           "block"},
          {"TRANS\nG40 G0 G90 G710 X1",
           "2:1: error: no work offset is programmed; the active one is unknown"},
          {"TRANS\nG40 G0 G90 G710 G57 X1",
           "2:1: error: G57: the values of this work offset are unknown"},
          {"TRANS\nG40 G0 G90 G710 G500 X1",
           "2:1: error: G500: the values of this work offset are unknown"},
          {"TRANS\nG40 G0 G90 G710 G510 X1",
           "2:1: error: G510: the values of this work offset are unknown"},
          {"TRANS\nG40 G0 G90 G710 G54 X1",
           "2:1: error: the plane is unknown, so the axis of the tool length is unknown; "
           "program G17"},
          {"TRANS\nG40 G2 G90 G710 G54 X1 I1",
           "2:1: error: the plane of the arc is unknown; program G17, G18 or G19"},
          {"G40 G0 G90 A1",
           "1:12: error: A: a transformation may be active; cancel it with TRAFOOF"},
          {"S1000",
           "1:1: error: S requires an active G93, G94 or G95: with G96 it is not a spindle speed"},
          {"M3", "1:1: error: the spindle starts, but S is unknown"},
          {"G4 S3", "1:4: error: G4 S is in spindle revolutions and requires a running spindle"},
          {"G641 ADIS=1", "1:6: error: the unit system is unknown; program G710 or G700"},
      });
  EXPECT_EQ(fault_of("G0\n"), "p.mpf:1:1: error: the program ends without M2, M17 or M30");
  EXPECT_EQ(fault_of(""), "p.mpf:1:1: error: the program ends without M2, M17 or M30");
}

TEST(SiemensErrors, MotionsThatAreNotDetermined) {
  expect_refused(
      kSiemensHead,
      {
          {"G0 Z1", "3:1: error: Z requires a tool length, but D is unknown here"},
          {"G0 Z1 D1", "3:1: error: D1: the tool in the spindle is unknown"},
          {"T1 M6\nTRANS\nG710 G17 G40 G90 G54 G0 Z1 D2",
           "5:1: error: D2 of tool 1: only the length of D1 is known"},
          {"T7 M6\nTRANS\nG710 G17 G40 G90 G54 G0 Z1 D1",
           "5:1: error: D1 of tool 7: its length is unknown"},
          {"G1 X1", "3:1: error: no feed rate has been programmed since G93, G94 or G95"},
          {"G0 X1 I2", "3:1: error: I, J, K, CR and TURN require G2 or G3; G0 is active"},
          {"G0 X=IC(1)", "3:4: error: an incremental coordinate requires a known position of X"},
          {"G0 SUPA X=IC(1)", "3:9: error: X: SUPA requires absolute positions"},
          {"G56 G0 X1", "3:1: error: the position of Y is unknown"},
          {"TRAFOOF\nG1 X1 A1 F10",
           "4:1: error: linear and rotary axes in one block: settings determine which of them F "
           "refers to; use G93"},
          {"G95 F1\nM0\nG1 G94 X1",
           "5:1: error: no feed rate has been programmed since G93, G94 or G95"},
      });
}

TEST(SiemensErrors, ArcsThatAreNotDetermined) {
  expect_refused(
      std::string(kSiemensHead) + "F60 G0 X0 Y0\n",
      {
          {"G2 X1", "4:1: error: an arc requires a centre or CR"},
          {"G2 X1 I1 CR=2", "4:10: error: CR is not allowed with a centre"},
          {"G2 X1 K1", "4:7: error: K is not in the plane of the arc"},
          {"SUPA G2 X1 I1", "4:1: error: SUPA with G2 or G3 is not supported"},
          {"G2 X10 CR=4", "4:8: error: CR = 4: start and end are 10 mm apart"},
          {"G2 CR=4", "4:4: error: CR: start and end coincide: the circle is undetermined"},
          {"G2 X10 I0", "4:1: error: the centre of the arc is its start point"},
          {"G2 X10 I5.006",
           "4:1: error: the arc starts at a radius of 5.0060 mm and ends at a radius of 4.9940 mm"},
          {"G2 X10 I5 TURN=1000", "4:11: error: TURN = 1000; must be an integer from 0 to 999"},
          {"TRAFOOF\nG2 X10 I5 A1", "5:11: error: A in a block with an arc is not supported"},
          {"G56 G18 G2 X10 I5",
           "4:1: error: an arc outside the XY plane with a rotated work offset is not supported"},
      });
}

}  // namespace
}  // namespace servomill::controllers::siemens_errors_test
