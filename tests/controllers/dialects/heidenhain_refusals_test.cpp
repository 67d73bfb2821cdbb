// Refusals of the reader of Heidenhain programs, with the whole message.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "controllers/dialects/heidenhain_reader.h"
#include "heidenhain_examples.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::heidenhain_refusals_test {
namespace {

std::string refusal(const std::string& program, const HeidenhainSettings& settings = {},
                    const ControlSetup& setup = heidenhain_example_setup()) {
  try {
    read_heidenhain(program, "t.h", setup, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

HeidenhainSettings tilting() {
  HeidenhainSettings settings;
  settings.has_tilting = true;
  return settings;
}

// Lines in the frame of the examples, which resets everything and calls tool 1; they begin at line
// 14, and their columns after the block number.
std::string refusal_of(const std::string& lines, const HeidenhainSettings& settings = {},
                       const ControlSetup& setup = heidenhain_example_setup()) {
  return refusal(heidenhain_program(lines), settings, setup);
}

// Without a block number, M137 and R0 set, and these lines from line 2
std::string refusal_at_start(const std::string& lines, const HeidenhainSettings& settings = {}) {
  return refusal("BEGIN PGM T MM\n" + lines + "M30\nEND PGM T MM\n", settings);
}

constexpr const char* kCycles =
    "CYCL DEF 8.0\nCYCL DEF 8.1\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+0\nCYCL DEF 11.0\n"
    "CYCL DEF 11.1 SCL 1\nCYCL DEF 26.0\nCYCL DEF 26.1 X 1 Y 1 Z 1\n";  // eight lines

TEST(HeidenhainRefusals, OfTheFrameOfAProgram) {
  EXPECT_EQ(refusal(""), "t.h:1:1: error: the program is empty; it must start with BEGIN PGM");
  EXPECT_EQ(refusal("L X+1\n"), "t.h:1:1: error: expected BEGIN PGM name MM (or INCH)");
  EXPECT_EQ(refusal("BEGIN PGM A B MM\n"),
            "t.h:1:1: error: BEGIN PGM requires a name without spaces, then MM or INCH");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nM30\nEND PGM B MM\n"),
            "t.h:3:9: error: END PGM B: the name must match BEGIN PGM A");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nM30\nEND PGM A INCH\n"),
            "t.h:3:11: error: END PGM in INCH: the unit must match BEGIN PGM (MM)");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nM30\n"), "t.h:2: error: END PGM A is missing");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nEND PGM A MM\n"),
            "t.h:2:1: error: END PGM without M2 or M30: whether the spindle stops depends on the "
            "machine");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nM30\nL X+1\nEND PGM A MM\n"),
            "t.h:3:1: error: no block is allowed after M2 or M30");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nM30\nEND PGM A MM\nM5\n"),
            "t.h:4:1: error: no block is allowed after END PGM");
}

TEST(HeidenhainRefusals, OfBlockNumbersAndLines) {
  EXPECT_EQ(refusal("0 BEGIN PGM A MM\n2 M30\n3 END PGM A MM\n"),
            "t.h:2:3: error: block number 2; it must be 1");
  EXPECT_EQ(refusal("0 BEGIN PGM A MM\nM30\n"), "t.h:2:1: error: no block number; it must be 1");
  EXPECT_EQ(refusal("BEGIN PGM A MM\n1 M30\n"),
            "t.h:2:3: error: block number 1: BEGIN PGM has no block number");
  EXPECT_EQ(refusal("1 BEGIN PGM A MM\n"), "t.h:1:3: error: block number 1; it must be 0");
  EXPECT_EQ(refusal("0x BEGIN PGM A MM\n"), "t.h:1:1: error: '0x' is not a block number");
  EXPECT_EQ(refusal("BEGIN PGM A MM\n; comment ~\nM30\n"),
            "t.h:2:1: error: a comment that ends with '~' may continue on the next line");
  EXPECT_EQ(refusal("BEGIN PGM A MM\nCYCL DEF 247 ~"),
            "t.h:2: error: '~' continues the block, but no line follows");
  EXPECT_EQ(refusal(std::string("BEGIN PGM\0A MM\n", 15)), "t.h:1:10: error: control character 0");
}

TEST(HeidenhainRefusals, OfWhatMayBeActiveFromTheProgramBefore) {
  const std::string move = "L Z+0 R0 FMAX M91\n";
  EXPECT_EQ(refusal_at_start(move),
            "t.h:2:1: error: cycle 8 may be active from the previous program: reset it first");
  EXPECT_EQ(refusal_at_start("CYCL DEF 8.0\nCYCL DEF 8.1\n" + move),
            "t.h:4:1: error: cycle 10 may be active from the previous program: reset it first");
  EXPECT_EQ(
      refusal_at_start("CYCL DEF 8.0\nCYCL DEF 8.1\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+0\n" + move),
      "t.h:6:1: error: cycle 11 may be active from the previous program: reset it first");
  EXPECT_EQ(
      refusal_at_start("CYCL DEF 8.0\nCYCL DEF 8.1\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+0\n"
                       "CYCL DEF 11.0\nCYCL DEF 11.1 SCL 1\nCYCL DEF 26.0\n"
                       "CYCL DEF 26.1 X1 Z1\n" +
                       move),
      "t.h:10:1: error: cycle 26 may be active in Y from the previous program: reset it first");
  EXPECT_EQ(refusal_at_start("CYCL DEF 26.0\nCYCL DEF 26.1 X1.01\n"),
            "t.h:3:15: error: cycle 26 with a factor other than 1 is not covered");
  EXPECT_EQ(refusal_at_start("CYCL DEF 26.0\nCYCL DEF 26.1 X1 CCX+5\n"),
            "t.h:3:18: error: cycle 26 with 'CCX+5': only X, Y and Z are covered");
  EXPECT_EQ(refusal_at_start(move, tilting()),
            "t.h:2:1: error: a tilted plane may be active from the previous program: program PLANE "
            "RESET STAY first");
  EXPECT_EQ(refusal_at_start("PLANE RESET STAY\n" + move, tilting()),
            "t.h:3:1: error: M128 may be active from the previous program: program M129 first");
  EXPECT_EQ(refusal_at_start("TOOL CALL 1 Z\n", tilting()),
            "t.h:2:1: error: M128 may be active from the previous program: program M129 before "
            "TOOL CALL");
  const std::string frame = kCycles;
  EXPECT_EQ(refusal_at_start(frame + "L Z+0 FMAX M91\n"),
            "t.h:10:1: error: cutter radius compensation may be active from the previous program: "
            "program R0 first");
  EXPECT_EQ(refusal_at_start(frame + "L Z+0 R0 F100 M91\n"),
            "t.h:10:1: error: M136 may be active from the previous program: program M137 before F");
  EXPECT_EQ(
      refusal_at_start(frame + "L X+0 R0 FMAX\n"),
      "t.h:10:1: error: a preceding TOOL CALL is required: the tool axis and length are unknown");
  EXPECT_EQ(
      refusal_at_start(frame + "TOOL CALL 1 Z\nL X+0 R0 FMAX\n"),
      "t.h:11:3: error: cycle 7 may be active in X from the previous program: reset it first");
  EXPECT_EQ(refusal_of("L C+5 F100\n"),
            "t.h:14:4: error: F for a rotary axis, and M116 may be active: program M117 first");
}

TEST(HeidenhainRefusals, OfUnknownPositionsAndLengths) {
  EXPECT_EQ(refusal_of("L IZ+1 FMAX\n"),
            "t.h:14:6: error: 'IZ+1': the position of Z is unknown here");
  EXPECT_EQ(refusal_of("L X+1 FMAX M0\nL IX+1 FMAX\n"),
            "t.h:15:6: error: 'IX+1': the position of X is unknown here");
  EXPECT_EQ(refusal_of("L X+1 FMAX M1\nCC X+0 Y+0\nC X+1 DR+ F100\n"),
            "t.h:16:4: error: the start position of the circle is unknown here");
  EXPECT_EQ(refusal_of("TOOL CALL 3 Z S10\nL Z+1 R0 FMAX\n"),
            "t.h:15:6: error: the length of tool 3 is unknown");
  EXPECT_EQ(refusal_of("TOOL CALL 2 Z\nL X+1 R0 FMAX M3\n"),
            "t.h:15:18: error: M3 requires S; none programmed since the last TOOL CALL");
  EXPECT_EQ(refusal_of("TOOL CALL 2 Z S100\nL X+1 FMAX\n"),
            "t.h:15:4: error: cutter radius compensation may be active from the previous program: "
            "program R0 first");
  EXPECT_EQ(refusal_of("L X+1 F100\nTOOL CALL 2 Z S100\nL X+2 R0\n"),
            "t.h:16:4: error: no feed rate is active; program F");
  EXPECT_EQ(refusal_of("CYCL DEF 247 ~\n  Q339=+4 ;DATUM NUMBER\nL X+1 FMAX\n"),
            "t.h:16:6: error: the work offset of preset 4 is unknown");
  EXPECT_EQ(refusal_of("CC\nTOOL CALL 2 Z S100\nL X+1 Y+0 R0 FMAX\nC X+1 Y+0 DR+ F1\n"),
            "t.h:17:4: error: a circle requires a preceding CC with the same reference");
  EXPECT_EQ(refusal_of("CYCL DEF 247 ~\n  Q339=+3\nTOOL CALL 1 Z\nL X+1 R0 FMAX\n"),
            "t.h:17:6: error: the coordinate system is rotated, and the position of X or Y is "
            "unknown here");
}

TEST(HeidenhainRefusals, OfWhatIsNotDetermined) {
  for (const char* feed : {"FT2", "FU0.1"}) {
    EXPECT_EQ(
        refusal_of(fmt::format("L X+1 {}\nL X+2\n", feed)),
        "t.h:15:4: error: no F in the block: it is undocumented how long FT and FU remain active");
  }
  EXPECT_EQ(refusal_of("L X+1 F100\nL M136\nL X+2\n"),
            "t.h:16:4: error: no feed rate is active; program F");
  EXPECT_EQ(refusal_of("L X+1 FAUTO\n"), "t.h:14:4: error: FAUTO: the last TOOL CALL has no F");
  EXPECT_EQ(refusal_of("L M117\nL X+1 C+5 F100\n"),
            "t.h:15:4: error: F for linear and rotary axes from an unknown position: the feed rate "
            "is undetermined");
  HeidenhainSettings reduced;
  reduced.is_rotary_display_reduced = true;
  EXPECT_EQ(refusal_of("L C+0 FMAX\nL C+200 FMAX\n", reduced),
            "t.h:15:6: error: a rotary axis would rotate by 180 degrees or more, and M126 may be "
            "active from the previous program: program M127 or M126 first");
  EXPECT_EQ(
      refusal_of("L C+0 FMAX M126\nL C+180 FMAX\n", reduced),
      "t.h:15:6: error: a rotary axis would rotate by 180 degrees: the direction is undetermined");
  EXPECT_EQ(refusal_of("CYCL DEF 11.0\nCYCL DEF 11.1 SCL 0.99\n"),
            "t.h:15:22: error: cycle 11 with a factor other than 1 is not covered: the scaled axes "
            "depend on MP7410");
  EXPECT_EQ(refusal_of("TRANS DATUM AXIS X+5\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+30\n"),
            "t.h:16:4: error: cycle 10 while a datum shift or cycle 8 is active, or may be, is not "
            "covered");
  EXPECT_EQ(refusal_of("CYCL DEF 8.0\nCYCL DEF 8.1 X\nL Z+0 FMAX M91\n"),
            "t.h:16:4: error: M91 while cycle 8 or 10 is active: the effect is undocumented");
  EXPECT_EQ(refusal_of("L IX+5 FMAX M91\n"), "t.h:14:6: error: M91 requires absolute coordinates");
}

TEST(HeidenhainRefusals, OfCircles) {
  EXPECT_EQ(refusal_of("C X+1 Y+1 DR+ F100\n"),
            "t.h:14:4: error: a circle requires a preceding CC with the same reference");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nC X+20 Y+0.006 F100\n"),
            "t.h:15:4: error: C requires DR: the direction of rotation is undetermined without it");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nC X+20.006 Y+0 DR+ F100\n"),
            "t.h:15:4: error: the arc starts at a radius of 10.0000 mm and ends at a radius of "
            "10.0060 mm");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nC X+0 Y+0.0001 DR+ F100\n"),
            "t.h:15:4: error: arc of 359.99943 degrees: rounding decides between a full circle and "
            "no motion");
  EXPECT_EQ(refusal_of("CC X+0 Y+0\nC X+1 DR+ F100\n"),
            "t.h:15:4: error: the circle starts at its centre (CC)");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nC X+20 Y+0 Z+1 DR+ F100\n"),
            "t.h:15:15: error: 'Z+1' is not in the plane of CC; a helix requires CP");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nC X+20 Y+0 DR+ FMAX\n"),
            "t.h:15:4: error: FMAX on a circle is not covered");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nCP IPA+90 DR- F100\n"),
            "t.h:15:4: error: IPA and DR must have the same sign, and IPA must not be 0");
  EXPECT_EQ(refusal_of("CC X+10 Y+0\nCP PA+180 DR- F100\n"),
            "t.h:15:4: error: CP PA: start and end coincide: a full circle or no motion");
  EXPECT_EQ(refusal_of("CC X+10\n"),
            "t.h:14:4: error: CC requires two of X, Y, Z, or no coordinate");
}

TEST(HeidenhainRefusals, ByName) {
  for (const std::string word :
       {"CR X+1 Y+1 R+5 DR+", "CT X+1 Y+1", "LP PR+5 PA+3", "RND R5", "CHF 1", "LBL 1",
        "CALL LBL 1", "FN 0: Q1 = 5", "APPR LT X+1", "STOP", "LN X+1"}) {
    const std::string name = word.substr(0, word.find(' '));
    EXPECT_EQ(
        refusal_of(word + "\n"),
        fmt::format("t.h:14:4: error: {}: this block is not covered by the verification", name));
  }
  EXPECT_EQ(refusal_of("Cc X+1 Y+1\n"),
            "t.h:14:4: error: 'Cc' does not start a block; did you mean 'CC'?");
  EXPECT_EQ(refusal_of("L X+1 RL F100\n"),
            "t.h:14:10: error: 'RL': cutter radius compensation is not covered by the "
            "verification");
  EXPECT_EQ(refusal_of("L X+1 FZ0.1\n"),
            "t.h:14:10: error: 'FZ0.1': this feed is not covered by the verification");
  EXPECT_EQ(refusal_of("L X+Q1 FMAX\n"),
            "t.h:14:6: error: 'X+Q1': Q parameters are not covered by the verification");
  EXPECT_EQ(refusal_of("L X+1 FMAX M92\n"),
            "t.h:14:15: error: M92: the machine builder's reference point is unknown; use M91 "
            "(machine datum)");
  EXPECT_EQ(refusal_of("M128\n"),
            "t.h:14:4: error: M128: TCP control is not covered by the verification");
  EXPECT_EQ(refusal_of("M7\n"), "t.h:14:4: error: M7 is defined by the machine builder");
  EXPECT_EQ(refusal_of("M99\n"), "t.h:14:4: error: M99: not covered by the verification");
  EXPECT_EQ(refusal_of("M129\n"),
            "t.h:14:4: error: M129: a control without the tilting option rejects it");
  EXPECT_EQ(refusal_of("PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\n", tilting()),
            "t.h:11:4: error: M128 may be active from the previous program: program M129 before "
            "TOOL CALL");
  EXPECT_EQ(refusal_at_start("PLANE RESET TURN\n", tilting()),
            "t.h:2:1: error: PLANE: only PLANE RESET STAY, which moves no axis, is covered");
  EXPECT_EQ(refusal_of("FUNCTION TCPM F TCP\n"),
            "t.h:14:4: error: FUNCTION: only FUNCTION RESET TCPM is covered by the verification");
  EXPECT_EQ(refusal_of("CYCL DEF 200 DRILLING ~\n  Q200=2\n"),
            "t.h:14:13: error: cycle 200: not covered by the verification");
  EXPECT_EQ(refusal_of("CYCL CALL\n"),
            "t.h:14:4: error: CYCL: only CYCL DEF with a number is covered by the verification");
}

TEST(HeidenhainRefusals, OfWords) {
  EXPECT_EQ(refusal_of("L X+1 X+2 FMAX\n"),
            "t.h:14:10: error: 'X+2': X appears twice in the block");
  EXPECT_EQ(refusal_of("L X FMAX\n"), "t.h:14:6: error: 'X' requires a number");
  EXPECT_EQ(refusal_of("L X+1e3 FMAX\n"), "t.h:14:6: error: 'X+1e3': '+1e3' is not a number");
  EXPECT_EQ(refusal_of("L X+1.00001 FMAX\n"),
            "t.h:14:6: error: 'X+1.00001': the control accepts 4 decimals here");
  EXPECT_EQ(refusal_of("L X+100000 FMAX\n"),
            "t.h:14:6: error: 'X+100000': the control accepts up to +-99999.9999 here");
  EXPECT_EQ(refusal_of("L X+1 F0\n"), "t.h:14:10: error: 'F0': the feed rate must be > 0");
  EXPECT_EQ(refusal_of("L X+1 F-5\n"),
            "t.h:14:10: error: 'F-5': '-5' is not a number without a sign");
  EXPECT_EQ(refusal_of("L X+1 F5 FMAX\n"),
            "t.h:14:13: error: 'FMAX': the feed rate appears twice in the block");
  EXPECT_EQ(refusal_of("L X+1 FMAX M3 M8 M91\n"),
            "t.h:14:21: error: 'M91': at most two M functions are allowed in the block");
  EXPECT_EQ(refusal_of("L X+1 FMAX M3 M5\n"), "t.h:14:18: error: M3 and M5 in one block");
  EXPECT_EQ(refusal_of("L X+1 U+5 FMAX\n"), "t.h:14:10: error: 'U+5' is not a word of this block");
  EXPECT_EQ(refusal_of("TOOL CALL 1 X S100\n"),
            "t.h:14:16: error: TOOL CALL: tool axis X; must be Z");
  EXPECT_EQ(refusal_of("TOOL CALL 1 S100\n"),
            "t.h:14:4: error: TOOL CALL requires the tool axis Z");
  EXPECT_EQ(refusal_of("TOOL CALL \"D10\" Z S100\n"),
            "t.h:14:14: error: TOOL CALL: '\"D10\"' is not covered by the verification");
  EXPECT_EQ(refusal_of("TOOL DEF 1 L+0 R+5\n"),
            "t.h:14:4: error: TOOL DEF: only a number, which preselects a tool, is covered");
}

TEST(HeidenhainRefusals, OfCycles) {
  EXPECT_EQ(refusal_of("CYCL DEF 9.0\nL X+1 FMAX\n"),
            "t.h:15:4: error: cycle 9 is incomplete: CYCL DEF 9.1 is missing");
  EXPECT_EQ(refusal_of("CYCL DEF 9.1 DWELL 1\n"),
            "t.h:14:13: error: CYCL DEF 9.1 does not follow CYCL DEF 9.0");
  EXPECT_EQ(refusal_of("CYCL DEF 9.0\nCYCL DEF 9.1 DWELL 3600.1\n"),
            "t.h:15:23: error: '3600.1': the control accepts up to +-3600 here");
  EXPECT_EQ(refusal_of("CYCL DEF 7.0\nCYCL DEF 7.2 X+0\n"),
            "t.h:15:13: error: CYCL DEF 7.2 does not follow CYCL DEF 7.1");
  EXPECT_EQ(refusal_of("CYCL DEF 7.0\nCYCL DEF 7.1 #5\n"),
            "t.h:15:17: error: '#5': the datum table is unknown");
  EXPECT_EQ(refusal_of("CYCL DEF 10.0\nCYCL DEF 10.1\n"),
            "t.h:15:4: error: the cycle requires ROT and a value");
  EXPECT_EQ(refusal_of("CYCL DEF 247 ~\n  Q339=+10\n"),
            "t.h:15:3: error: 'Q339=+10': presets 1 to 9 are covered");
  EXPECT_EQ(refusal_at_start("CYCL DEF 19.0\nCYCL DEF 19.1\n", tilting()),
            "t.h:3:1: error: cycle 19 without angles requires cycle 19 with angles of 0 first");
  EXPECT_EQ(refusal_at_start("CYCL DEF 19.0\nCYCL DEF 19.1 A+0 B+30 C+0\n", tilting()),
            "t.h:3:1: error: cycle 19: only A+0 B+0 C+0, then no angle, is covered");
}

// Whatever a file holds, the reader returns or names a place.
TEST(HeidenhainRefusals, DamagedProgramsEndInAMessage) {
  std::mt19937 random(1);
  int refused = 0;
  for (const auto& example : heidenhain_cycle_examples()) {
    for (int i = 0; i < 300; ++i) {
      std::string program = heidenhain_program(example.program);
      for (int k = 0; k < 3; ++k) program[random() % program.size()] = static_cast<char>(random());
      if (i % 3 == 0) program.resize(random() % program.size());
      const std::string message = refusal(program);
      refused += message.empty() ? 0 : 1;
      EXPECT_TRUE(message.empty() || message.rfind("t.h:", 0) == 0) << message;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace servomill::controllers::heidenhain_refusals_test
