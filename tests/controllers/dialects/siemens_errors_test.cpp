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
      "", {
              {"?", "1:1: error: '?' begins no word"},
              {"G1 X1.2.3", "1:8: error: '.' begins no word"},
              {"G1 \x01", "1:4: error: byte 0x01 begins no word"},
              {"X", "1:2: error: X needs a number"},
              {"X-", "1:2: error: X needs a number"},
              {"X=", "1:3: error: X needs a number"},
              {"X=R1", "1:3: error: X=R1: plain numbers, AC(...) and IC(...) are read"},
              {"X=IC(R1)", "1:6: error: IC needs a number"},
              {"X=IC(1,2)", "1:7: error: IC(...) holds one number"},
              {"X=IC 1", "1:6: error: IC needs a number in parentheses"},
              {"X=2*3", "1:4: error: X=: expressions are not read"},
              {"T=\"A", "1:3: error: the text has no closing quote"},
              {"MSG(\"a)", "1:4: error: the parenthesis is not closed"},
              {"S2=1000", "1:1: error: S2=: extended addresses are not read"},
              {"LABEL: G0", "1:1: error: LABEL: labels and jumps are not read"},
              {"/3 G0",
               "1:1: error: /3: skip level 3 has a switch of its own; only that of / is known"},
              {"/00 G0", "1:1: error: skip levels are /0 ... /9"},
              {"N1234567890 G0", "1:2: error: block number with 10 digits; at most 9"},
              {"G0 N10", "1:4: error: N is the block number and begins the block"},
              {"; ok\n\nG0 \xef\xbb\xbf", "3:4: error: byte 0xef begins no word"},
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
          {"SUPPA", "1:1: error: SUPPA is not read; did you mean 'SUPA'?"},
          {"ABCDEFGH", "1:1: error: ABCDEFGH is not read"},
          {"G33", "1:1: error: G33 is not read"},
          {"G1.5", "1:1: error: G = 1.5; must be a whole number from 0 to 999"},
          {"G41 X1", "1:1: error: G41 compensates the cutter radius; it is not read"},
          {"G53 X1",
           "1:1: error: G53 leaves the basic frame in force, which nothing here determines; SUPA "
           "suppresses it; it is not read"},
          {"G59",
           "1:1: error: G59 is an axial offset of the programmable frame, no work offset; it "
           "is not read"},
          {"TRAORI",
           "1:1: error: TRAORI switches a transformation on whose parameters nothing here "
           "determines; it is not read"},
          {"AP=30", "1:1: error: AP is a polar angle; it is not read"},
          {"GOTOF", "1:1: error: GOTOF jumps; it is not read"},
          {"M98", "1:1: error: M98 is not read"},
          {"H1", "1:1: error: H is not read"},
          {"R1=2", "1:1: error: R1=: extended addresses are not read"},
          {"CYCLE800(1)",
           "1:1: error: CYCLE800 swivels the plane by data of the builder; it is not "
           "read"},
          {"SUPA(1)", "1:1: error: SUPA does not have this form"},
          {"T=\"MILL\"",
           "1:1: error: T=\"MILL\": only names that are numbers lead to a tool length"},
          {"X=\"1\"", "1:1: error: X=\"...\": only T has a name"},
          {"F=AC(1)", "1:1: error: F: AC(...) and IC(...) are for axes and I J K"},
      });
}

TEST(SiemensErrors, WordsThatDoNotGoTogether) {
  expect_refused(
      "",
      {
          {"G0 X1 X2", "1:7: error: X appears twice"},
          {"T1 T2", "1:4: error: T appears twice"},
          {"G0 G1", "1:4: error: G0 and G1 in one block: they are of one group"},
          {"G54 G507", "1:5: error: G54 and G507 in one block: they are of one group"},
          {"TRANS X10", "1:1: error: TRANS needs a block of its own"},
          {"G0 TRAFOOF", "1:4: error: TRAFOOF needs a block of its own"},
          {"G1 CYCLE832(0.1,1,1)", "1:4: error: CYCLE832 needs a block of its own"},
          {"CYCLE832(0.1,1)",
           "1:1: error: CYCLE832(0.1,1): tolerance, kind and orientation tolerance are needed"},
          {"CYCLE832(0.1,112,1)",
           "1:1: error: CYCLE832(0.1,112,1): kinds 0 to 4 and 10 to 14 are read"},
          {"CYCLE832(0,1,1)", "1:1: error: CYCLE832(0,1,1): the tolerance must be > 0"},
          {"CYCLE832(0.1,_FINISH,1)",
           "1:1: error: CYCLE832(0.1,_FINISH,1): its parameters are numbers"},
          {"G4", "1:1: error: G4 needs a block of its own, with F in seconds or S in revolutions"},
          {"G4 F1 M3",
           "1:1: error: G4 needs a block of its own, with F in seconds or S in revolutions"},
          {"G4 F-1", "1:1: error: a dwell of -1 s; must be from 0 to 1e+06 s"},
          {"M3 M5", "1:4: error: two M functions of one kind in one block"},
          {"T1 M6 G0", "1:1: error: a tool change needs a block of its own, with T, M6 and D only"},
          {"G0 X1 M8",
           "1:7: error: M8 in a block with a motion: the builder decides whether it acts "
           "before or after"},
          {"G0 X1 S500",
           "1:7: error: S in a block with a motion: the builder decides whether it "
           "acts before or after"},
          {"F0", "1:1: error: F = 0; must be > 0"},
          {"M6", "1:1: error: M6 without T: the tool is not known"},
          {"T1 D1",
           "1:4: error: D with T and without M6: whether it is of the old or the new tool "
           "is not known"},
          {"D1.5", "1:1: error: D = 1.5; must be a whole number from 0 to 32000"},
      });
}

TEST(SiemensErrors, ModesThatNobodySet) {
  expect_refused(
      "",
      {
          {"X1", "1:1: error: positions without a known G0, G1, G2 or G3"},
          {"G0 X1", "1:1: error: the cutter compensation may be on; G40 switches it off"},
          {"G40 G0 SUPA X1", "1:13: error: inch or metric is not known; G710 or G700 sets it"},
          {"G40 G0 SUPA G710 X1", "1:18: error: G90 or G91 is not known"},
          {"G40 G0 G90 G710 X1",
           "1:1: error: a programmable frame may be active; TRANS in a block of its own clears it"},
          {"TRANS\nG40 G0 G90 G710 X1",
           "2:1: error: no work offset is programmed; any may be active"},
          {"TRANS\nG40 G0 G90 G710 G57 X1",
           "2:1: error: G57: the place of this work offset is not known"},
          {"TRANS\nG40 G0 G90 G710 G500 X1",
           "2:1: error: G500: the place of this work offset is not known"},
          {"TRANS\nG40 G0 G90 G710 G510 X1",
           "2:1: error: G510: the place of this work offset is not known"},
          {"TRANS\nG40 G0 G90 G710 G54 X1",
           "2:1: error: the plane is not known, and with it the axis of the tool length; G17 sets "
           "it"},
          {"TRANS\nG40 G2 G90 G710 G54 X1 I1",
           "2:1: error: the plane of the arc is not known; G17, G18 or G19 sets it"},
          {"G40 G0 G90 A1",
           "1:12: error: A: a transformation may be active; TRAFOOF switches it off"},
          {"S1000",
           "1:1: error: S needs a known G93, G94 or G95: with G96 it is no speed of rotation"},
          {"M3", "1:1: error: the spindle starts, and S is not known"},
          {"G4 S3", "1:4: error: G4 S counts revolutions, and the spindle is not known to turn"},
          {"G641 ADIS=1", "1:6: error: inch or metric is not known; G710 or G700 sets it"},
      });
  EXPECT_EQ(fault_of("G0\n"), "p.mpf:1:1: error: the program ends without M2, M17 or M30");
  EXPECT_EQ(fault_of(""), "p.mpf:1:1: error: the program ends without M2, M17 or M30");
}

TEST(SiemensErrors, MotionsThatAreNotDetermined) {
  expect_refused(
      kSiemensHead,
      {
          {"G0 Z1", "3:1: error: Z needs a tool length, and D is not known here"},
          {"G0 Z1 D1", "3:1: error: D1: the tool in the spindle is not known"},
          {"T1 M6\nTRANS\nG710 G17 G40 G90 G54 G0 Z1 D2",
           "5:1: error: D2 of tool 1: only the length of D1 is known"},
          {"T7 M6\nTRANS\nG710 G17 G40 G90 G54 G0 Z1 D1",
           "5:1: error: D1 of tool 7: its length is not known"},
          {"G1 X1", "3:1: error: no feed is programmed since G93, G94 or G95"},
          {"G0 X1 I2", "3:1: error: I, J, K, CR and TURN are for G2 and G3; G0 is in force"},
          {"G0 X=IC(1)", "3:4: error: an increment from an unknown position of X"},
          {"G0 SUPA X=IC(1)", "3:9: error: X: SUPA needs absolute positions"},
          {"G56 G0 X1", "3:1: error: the position of Y is not known"},
          {"TRAFOOF\nG1 X1 A1 F10",
           "4:1: error: linear and rotary axes together: settings decide which of them F counts; "
           "G93 does not depend on them"},
          {"G95 F1\nM0\nG1 G94 X1", "5:1: error: no feed is programmed since G93, G94 or G95"},
      });
}

TEST(SiemensErrors, ArcsThatAreNotDetermined) {
  expect_refused(
      std::string(kSiemensHead) + "F60 G0 X0 Y0\n",
      {
          {"G2 X1", "4:1: error: the arc has neither a centre nor CR"},
          {"G2 X1 I1 CR=2", "4:10: error: CR and a centre in one block"},
          {"G2 X1 K1", "4:7: error: K is not in the plane of the arc"},
          {"SUPA G2 X1 I1", "4:1: error: SUPA with G2 or G3 is not read"},
          {"G2 X10 CR=4", "4:8: error: CR = 4: start and end are 10 mm apart"},
          {"G2 CR=4", "4:4: error: CR with equal start and end: the circle is not determined"},
          {"G2 X10 I0", "4:1: error: the centre of the arc is where it begins"},
          {"G2 X10 I5.006",
           "4:1: error: the arc begins at a radius of 5.0060 mm and ends at one of 4.9940 mm"},
          {"G2 X10 I5 TURN=1000", "4:11: error: TURN = 1000; must be a whole number from 0 to 999"},
          {"TRAFOOF\nG2 X10 I5 A1", "5:11: error: A in a block with an arc is not read"},
          {"G56 G18 G2 X10 I5",
           "4:1: error: an arc outside the XY plane under a rotated work offset is not read"},
      });
}

}  // namespace
}  // namespace servomill::controllers::siemens_errors_test
