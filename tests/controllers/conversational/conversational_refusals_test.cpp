// Conversational programs that are refused, with their full messages.
#include <gtest/gtest.h>

#include "controllers/gcode/interpreter.h"
#include "moves_text.h"

namespace servomill::controllers::conversational::conversational_refusals_test {
namespace {

struct Refusal {
  const char* lines;
  const char* message;
};

// The first line is line 4 of the file.
const Refusal kRefusals[] = {
    {"L X+1\n", "t.h:4:1: error: no F in the block, and none is in force"},
    {"L X+2 F5\nTOOL DEF 9 L+5 R+1 F300\nL X+1\n",
     "t.h:6:1: error: no F in the block, and none is in force"},
    {"L X+1 X+2 F1\n", "t.h:4:7: error: 'X+2': X is in the block already"},
    {"L X+ F1\n", "t.h:4:3: error: '+' is neither a number nor a Q parameter"},
    {"L X+1..2 F1\n", "t.h:4:3: error: '+1..2' is neither a number nor a Q parameter"},
    {"L U+1 F1\n", "t.h:4:3: error: 'U+1': there are no axes U, V, W"},
    {"L X+1 F0\n", "t.h:4:7: error: F0: a feed must be > 0"},
    {"L X+1 F1 FMAX\n", "t.h:4:10: error: 'FMAX': a second feed in the block"},
    {"L X+1 FZ0.1\n", "t.h:4:7: error: 'FZ0.1': this feed is not read; write F in mm/min"},
    {"L X+1 FAUTO\n", "t.h:4:7: error: FAUTO: the last TOOL CALL has no F"},
    {"L X+Q5 F1\n",
     "t.h:4:3: error: Q5 has no value here: the control would take what the program before left; "
     "assign it, or pass --parameter Q5=NUMBER"},
    {"LX X+1\n", "t.h:4:1: error: 'LX' begins no block; did you mean 'L'?"},
    {"FL X+1\n",
     "t.h:4:1: error: FL: free contour programming (FK) is not read; let the control convert it to "
     "L and C"},
    {"LN X+1 NX+0 NY+0 NZ+1\n",
     "t.h:4:1: error: LN: lines with surface normals (3-D compensation) are not read; post L with "
     "M128"},
    {"TCH PROBE 427\n",
     "t.h:4:1: error: TCH: touch probe cycles are not read: what they measure is not known"},
    {"/ TCH PROBE 427\n",
     "t.h:4:3: error: TCH: touch probe cycles are not read: what they measure is not known; "
     "--block-delete leaves out lines that start with '/'"},
    {"L X+1 F1 M103\n", "t.h:4:10: error: M103: the feed factor for plunging is not read; write F"},
    {"L M136\n",
     "t.h:4:3: error: M136: F in micrometres per revolution on a TNC 426, in mm per revolution on "
     "an "
     "iTNC 530; write FU"},
    {"L M92 X+1 FMAX\n",
     "t.h:4:1: error: M92: the builder's reference point is not known; use M91"},
    {"L IX+1 R0 FMAX M91\n", "t.h:4:3: error: M91 with an incremental coordinate"},
    {"L M140 MB MAX\n",
     "t.h:4:1: error: M140 MB MAX: the end of travel of Z is the machine's; name a machine that "
     "has "
     "it (--machine), or write MB with a number or M91"},
    {"L X+1 M140 MB MAX\n",
     "t.h:4:1: error: M140 with coordinates; write them in a block of their own"},
    {"L X+9 RL F1\nL Y+9\nL M140 MB MAX\n",
     "t.h:6:1: error: M140 MB MAX with RL or RR in force; write a block with R0 before"},
    {"PLANE SPATIAL SPA+90 SPB+0 SPC+0 STAY\nL M140 MB MAX\n",
     "t.h:5:1: error: M140 MB MAX with M128 or in a tilted plane: the direction is that of the "
     "inclined tool; end them before, or write MB with a number"},
    {"C X+1 Y+1 DR+ F1\n", "t.h:4:1: error: no CC before the circle, or its frame has changed"},
    {"CC X+5 Y+0\nC X+5 Y+9 DR+ F1\n",
     "t.h:5:1: error: the end of the circle is 9.0000 mm from CC, its begin 5.0000 mm; controls "
     "take "
     "0.016 mm at most (MP7431)"},
    {"CC X+5 Y+0\nC X+10 Y+0 F1\n",
     "t.h:5:1: error: C without DR: which way holds then is up to the block before; write DR"},
    {"CC X+0 Y+0\nC X+1 Y+0 DR+ F1\n", "t.h:5:1: error: the circle begins at CC"},
    {"CC X+5 Y+0\nC X+10 Y+0 DR+ FMAX\n", "t.h:5:1: error: FMAX on a circle; write F"},
    {"CR X+30 R+10 DR+ F1\n",
     "t.h:4:1: error: CR R10: the ends are 30.0000 mm apart; a full circle takes two blocks, and "
     "no "
     "arc spans more than its diameter"},
    {"CT X+3 Y+3 F1\n",
     "t.h:4:1: error: CT: the block before it must move in the plane of the arc"},
    {"RND R3\n", "t.h:4:1: error: a contour element in the plane must precede RND and CHF"},
    {"L X+5 F1\nRND R9\nL Y+5\n",
     "t.h:5:1: error: RND R9 is longer than the elements at the corner"},
    {"L X+5 RL F1\nL X+9\nCC X+9 Y+2\nC X+9 Y+4 DR+\n",
     "t.h:7:1: error: the tool of radius 5 mm does not fit inside the arc of radius 2 mm"},
    {"CC X+5 Y+0\nC X+10 Y+0 DR+ RL F1\n",
     "t.h:5:1: error: RL and RR cannot begin in a circle; write a straight line before"},
    {"L X+9 RL F1\nL Y+9\nL X+0 RR\n",
     "t.h:6:1: error: RL and RR: the other side is in force; write a block with R0 between"},
    {"L X+9 RL F1\nL Y+9\nL X+0 R0\n",
     "t.h:6:1: error: the block that ends RL or RR must name both axes of the plane: where the "
     "other "
     "one goes was not found in a manual"},
    {"L X+9 RL F1\nTOOL CALL 2 Z S1\n",
     "t.h:5:1: error: TOOL CALL with RL or RR in force; write a block with R0 before"},
    {"APPR LT X+9 Y+9 LEN5 R0 F1\n",
     "t.h:4:1: error: APPR LT with R0: an iTNC 530 and a TNC 640 do different things; write RL or "
     "RR"},
    {"DEP LT LEN5 F1\n", "t.h:4:1: error: DEP: a contour element with RL or RR must precede it"},
    {"APPR LT X+9 Y+0 LEN5 RL F1\nL Y+9\nDEP LT LEN5 Z+3\n",
     "t.h:6:1: error: DEP LT with Z: some controls move it with the departure, some behind; write "
     "it "
     "in the next block"},
    {"TOOL CALL \"MILL\" Z S1\n",
     "t.h:4:11: error: a tool called by its name: the tool table of the control has the names, the "
     "one here numbers; write the number"},
    {"TOOL CALL 1 Y S1\n", "t.h:4:1: error: tool axis Y: only Z is read"},
    {"TOOL DEF 1 L+90 R+5\n",
     "t.h:4:1: error: TOOL DEF 1: the tool table has L100 R5; a control with a tool table takes "
     "those, one without takes the block; leave out one of them"},
    {"CALL LBL 7\n", "t.h:4:1: error: there is no LBL 7 in the program"},
    {"CALL LBL 7\nL M2\nLBL 7\n", "t.h:7:1: error: LBL 0 is missing: the program ends in LBL 7"},
    {"LBL 1\nLBL 1\n", "t.h:5:1: error: LBL 1 stands twice in the program"},
    {"CALL PGM HOLE\n",
     "t.h:4:10: error: CALL PGM HOLE: no file HOLE.H next to the program or in the folders of "
     "--subs"},
    {"Q1 = SQRT -1\n", "t.h:4:6: error: SQRT of -1: must be >= 0"},
    {"Q1 = 5 / 0\n", "t.h:4:8: error: '/': division by zero"},
    {"Q1 = -2^2\n",
     "t.h:4:8: error: '^': behind a sign: the order was not found in a manual; use brackets"},
    {"Q1 = SGN 0\n",
     "t.h:4:6: error: SGN of 0: 1 on an iTNC 530, 0 on a TNC 640; compare with FN 9 to FN 12"},
    {"Q1 = SINUS 3\n", "t.h:4:6: error: 'SINUS': no function; did you mean 'SIN'?"},
    {"FN 14: ERROR = 1000\n",
     "t.h:4:1: error: FN 14: the program stops here with its error message"},
    {"FN 18: SYSREAD Q1 = ID220\nL X+Q1 F1\n",
     "t.h:5:3: error: Q1 was read from the control (FN 18: SYSREAD Q1 = ID220), which is not known "
     "here; assign it instead"},
    {"FN 18: SYSREAD QS1 = ID220\n",
     "t.h:4:1: error: FN 18: a Q parameter that takes the value is expected"},
    {"FN 17: SYSWRITE ID 10 = 1\n",
     "t.h:4:1: error: FN 17: writes data of the control or of its PLC, whose effect is not known "
     "here; take the block out if it moves nothing"},
    {"CYCL CALL PAT\n",
     "t.h:4:1: error: CYCL CALL PAT without PATTERN DEF: a table of points is not in the program"},
    {"PATTERN DEF SQUARE1 (X+0 Y+0)\n",
     "t.h:4:13: error: PATTERN DEF: POS, ROW, PAT, FRAME, CIRC or PITCHCIRC with its number is "
     "expected"},
    {"PATTERN DEF ROW1 (X+0 Y+0 D+5)\n", "t.h:4:1: error: PATTERN DEF without NUM"},
    {"PATTERN DEF PAT1 (X+0 Y+0 DX+5 DY+5 NUMX2 NUMY2 ROTX+5)\n",
     "t.h:4:1: error: PATTERN DEF with ROTX, which distorts the pattern, is not read; write POS"},
    {"CYCL DEF 208 BORE MILLING\n",
     "t.h:4:10: error: CYCL DEF 208: bore milling: the way to the wall of the hole is the "
     "control's; write it with CC and CP IPA"},
    {"CYCL DEF 253 SLOT MILLING\n",
     "t.h:4:10: error: CYCL DEF 253: slots: the path of the roughing is the control's; let the CAM "
     "system write the moves"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN FMAX SYM+\n",
     "t.h:4:1: error: PLANE: SYM chooses a solution by a rule of the machine; write SEQ+, SEQ- or "
     "neither"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY SEQ+\nPLANE RESET STAY\nL A+Q120 FMAX\n",
     "t.h:6:3: error: Q120 is the angle of a rotary axis after PLANE, which is not known here; "
     "assign it instead"},
    {"CYCL CALL\n", "t.h:4:1: error: no cycle is defined to be called"},
    {"CYCL DEF 251 RECTANGULAR POCKET\n",
     "t.h:4:10: error: CYCL DEF 251: pockets, slots, studs and threads are not read; let the CAM "
     "system write their moves"},
    {"CYCL DEF 7.0\nCYCL DEF 7.1 #5\n",
     "t.h:5:14: error: a line of a datum table, which is not in the program"},
    {"CYCL DEF 8.0\nCYCL DEF 8.1 X\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+30\n",
     "t.h:7:1: error: cycles 8 and 10 are both active: what they make together depends on their "
     "order; reset one"},
    {"CYCL DEF 26.0\nCYCL DEF 26.1 X 1 Y 0.5\n",
     "t.h:5:19: error: cycle 26: Y scaled by 0.5; only factors of 1, which end it, are read"},
    {"CYCL DEF 11.0\nCYCL DEF 11.1 SCL 0.5\nL Z-5 F1\n",
     "t.h:6:1: error: Z moves while cycle 11 is active: MP7410 decides if it is scaled; move Z "
     "before"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 MOVE DIST0 F500\n",
     "t.h:4:1: error: PLANE ... MOVE: the compensating movement of the linear axes is not read; "
     "write "
     "TURN"},
    {"PLANE PROJECTED PROPR+30\n",
     "t.h:4:1: error: PLANE: only SPATIAL and RESET are read; write the plane with spatial angles"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN FMAX\n",
     "t.h:4:1: error: read as \"G53.1\": G53.1: where the rotary axes go depends on the machine, "
     "and "
     "none is given (--machine)"},
    {"L M128\nL X+1 RL F1\n", "t.h:5:1: error: RL and RR with M128; end it with M129"},
    {"L M128\nL Z+1 FMAX M91\n", "t.h:5:1: error: M91 with M128; end it with M129: [530] p. 290"},
    {"L C+0 FMAX\nL C+190 FMAX\n",
     "t.h:5:3: error: C would turn by 190 degrees, or by -170 on the shorter way: the machine "
     "decides "
     "(MP7682); write M126 or M127"},
    {"CYCL DEF 247 Q339=12\n",
     "t.h:4:1: error: preset 12: presets 1 to 9 are known here, as G54 to G59.3"},
};

TEST(ConversationalRefusals, SayWhereWhyAndWhatToDo) {
  for (const Refusal& refusal : kRefusals) {
    SCOPED_TRACE(refusal.lines);
    EXPECT_EQ(fault_of(refusal.lines), refusal.message);
  }
}

TEST(ConversationalRefusals, OfPrograms) {
  const auto fault = [](const std::string& program) -> std::string {
    try {
      interpret(program, "t.h", example_setup());
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(fault("L X+1\n"), "t.h:1:1: error: a conversational program begins with BEGIN PGM");
  EXPECT_EQ(fault("BEGIN PGM T\n"), "t.h:1:1: error: BEGIN PGM must end with MM or INCH");
  EXPECT_EQ(fault("BEGIN PGM T MM\n"), "t.h:1: error: END PGM is missing");
  EXPECT_EQ(fault("BEGIN PGM T MM\nLBL 1\nCALL LBL 1\n"),
            "t.h:3:1: error: more than 19 calls in each other");
}

TEST(ConversationalRefusals, EndlessProgramsEnd) {
  ProgramSetup setup = example_setup();
  setup.most_jumps = 100;
  EXPECT_EQ(fault_of("LBL 1\nFN 9: IF +0 EQU +0 GOTO LBL 1\n", setup),
            "t.h:5:1: error: 100 jumps: the program seems endless; raise it with --max-jumps");
}

TEST(ConversationalRefusals, WarnsOfWhatItReadsOneWay) {
  Interpreter interpreter(with_frame("L X+1 C+5 F100 M25\nL X+2 C+9\n"), "t.h", example_setup());
  interpreter.rest();
  ASSERT_EQ(interpreter.warnings().size(), 2u);
  EXPECT_EQ(
      to_string(interpreter.warnings()[0]),
      "t.h:4:1: error: M25: a function of the machine builder; read as without effect on motion");
  EXPECT_EQ(
      to_string(interpreter.warnings()[1]),
      "t.h:4:1: error: F of a block with linear and rotary axes: read as the feed of the linear "
      "axes; on some machines it is that of all axes together");
}

}  // namespace
}  // namespace servomill::controllers::conversational::conversational_refusals_test
