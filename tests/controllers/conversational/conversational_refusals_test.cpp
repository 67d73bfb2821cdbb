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
    {"L X+1\n", "t.h:4:1: error: no feed rate is active; program F"},
    {"L X+2 F5\nTOOL DEF 9 L+5 R+1 F300\nL X+1\n",
     "t.h:6:1: error: no feed rate is active; program F"},
    {"L X+1 X+2 F1\n", "t.h:4:7: error: 'X+2': X appears twice in the block"},
    {"L X+ F1\n", "t.h:4:3: error: '+' is neither a number nor a Q parameter"},
    {"L X+1..2 F1\n", "t.h:4:3: error: '+1..2' is neither a number nor a Q parameter"},
    {"L U+1 F1\n", "t.h:4:3: error: 'U+1': axes U, V and W are not supported"},
    {"L X+1 F0\n", "t.h:4:7: error: F0: the feed rate must be > 0"},
    {"L X+1 F1 FMAX\n", "t.h:4:10: error: 'FMAX': the feed rate appears twice in the block"},
    {"L X+1 FZ0.1\n",
     "t.h:4:7: error: 'FZ0.1': this type of feed rate is not supported; program F in mm/min"},
    {"L X+1 FAUTO\n", "t.h:4:7: error: FAUTO: the last TOOL CALL has no F"},
    {"L X+Q5 F1\n",
     "t.h:4:3: error: Q5 is not defined: the control would use the value from an earlier program; "
     "assign it, or pass --parameter Q5=NUMBER"},
    {"LX X+1\n", "t.h:4:1: error: 'LX' does not start a block; did you mean 'L'?"},
    {"FL X+1\n",
     "t.h:4:1: error: FL: free contour programming (FK) is not supported; have the control convert "
     "it to L and C"},
    {"LN X+1 NX+0 NY+0 NZ+1\n",
     "t.h:4:1: error: LN: lines with surface normals (3-D compensation) are not supported; "
     "post-process to L with M128"},
    {"TCH PROBE 427\n",
     "t.h:4:1: error: TCH: touch probe cycles are not supported: the measured values are unknown"},
    {"/ TCH PROBE 427\n",
     "t.h:4:3: error: TCH: touch probe cycles are not supported: the measured values are unknown; "
     "--block-delete skips lines that start with '/'"},
    {"L X+1 F1 M103\n",
     "t.h:4:10: error: M103: the plunging feed factor is not supported; program F"},
    {"L M136\n",
     "t.h:4:3: error: M136: F is in um/rev on a TNC 426, in mm/rev on an iTNC 530; use FU"},
    {"CYCL DEF 251 Q218=60\n",
     "t.h:4:10: error: CYCL DEF 251: pockets, slots, studs and threads are not supported; have the "
     "CAM system output the moves"},
    {"CYCL DEF 4.0 POCKET\n",
     "t.h:4:10: error: CYCL DEF 4: pockets, slots and contour cycles are not supported; have the "
     "CAM system output the moves"},
    {"CYCL DEF 19.0\nCYCL DEF 19.1 A+0 B+30\n",
     "t.h:5:19: error: cycle 19 with B: a spatial angle or a rotary axis position, depending on "
     "MP7500; use PLANE SPATIAL"},
    {"L B+45 F1000\nCYCL DEF 19.0\nCYCL DEF 19.1 A+0 B+0 C+0 F2000 ABST10\n",
     "t.h:6:15: error: cycle 19 with angles of 0 while rotary axes are not at zero: some machines "
     "move them there, others do not; program cycle 19 without angles, then L"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY\nPLANE RESET TURN MB+20 F500\n",
     "t.h:5:1: error: MB after PLANE ... STAY, before the rotary axes are positioned: the "
     "direction is undetermined (tool axis or Z of the plane); position them first, or program L"},
    {"L B+45 R0 FMAX M91\nPLANE RESET TURN FMAX\n",
     "t.h:5:1: error: PLANE RESET TURN: the rotary axes depend on the machine; pass it with "
     "--machine"},
    {"CYCL DEF 17.0\nCYCL DEF 17.1 ABST2\nCYCL DEF 17.1 ABST-3\n",
     "t.h:6:10: error: CYCL DEF 17.1: expected CYCL DEF 17.2"},
    {"CYCL DEF 1.0\nCYCL DEF 1.1 ABST2\nCYCL DEF 1.3 ZUSTLG5\n",
     "t.h:6:10: error: CYCL DEF 1.3: expected CYCL DEF 1.2"},
    {"CYCL DEF 220 Q241=2\n",
     "t.h:4:1: error: CYCL DEF 220 requires a preceding drilling cycle (200 or higher)"},
    {"CYCL DEF 240 Q200=1\nCYCL DEF 220 Q365=1\n",
     "t.h:5:1: error: cycle 220 with Q365 (travel along the pitch circle): the feed rate is "
     "undocumented; set Q365=0"},
    {"CYCL DEF 240 Q200=1\nCYCL DEF 221 Q225=0 Q226=0 Q237=1 Q238=1 Q242=0 Q243=1 Q224=0\n",
     "t.h:5:1: error: Q242 and Q243 must be > 0"},
    {"CYCL DEF 240 Q200=1\nCYCL DEF 221 Q225=0 Q226=0 Q237=1 Q238=1 Q242=1 Q243=1 Q224=0 Q203=0 "
     "Q204=20 Q301=0\n",
     "t.h:5:1: error: Q301=0 with a second set-up clearance: the height after the last hole is "
     "undocumented; set Q301=1, or Q204=0"},
    {"CYCL DEF 240 Q200=1\nCYCL DEF 221 Q225=0 Q226=0 Q237=1 Q238=1 Q242=1 Q243=1 Q224=0 Q203=0 "
     "Q204=20 Q301=2\n",
     "t.h:5:1: error: Q301=2; must be 0 or 1"},
    {"CYCL DEF 240 Q200=1 Q203=0 M99\n",
     "t.h:4:28: error: 'M99' is not allowed in a cycle definition; program it in a separate block"},
    {"CYCL DEF 17.0\nCYCL DEF 17.1 ABST2\nCYCL CALL\n",
     "t.h:6:1: error: cycle 17 is incomplete; CYCL DEF 17.1 to 17.3 are required"},
    {"CYCL DEF 2.0\nCYCL DEF 2.1 ABST2\nCYCL DEF 2.2 T-5\nCYCL DEF 2.3 V.ZEIT0\nCYCL DEF 2.4 "
     "F9\nCYCL CALL\n",
     "t.h:9:1: error: cycle 2 requires M3 or M4"},
    {"L M92 X+1 FMAX\n",
     "t.h:4:1: error: M92: the machine builder's reference point is unknown; use M91"},
    {"L IX+1 R0 FMAX M91\n", "t.h:4:3: error: M91 requires absolute coordinates"},
    {"L M140 MB MAX\n",
     "t.h:4:1: error: M140 MB MAX: the upper travel limit of Z is unknown; pass a machine with "
     "--machine, or use MB with a number or M91"},
    {"L X+1 M140 MB MAX\n",
     "t.h:4:1: error: M140 does not accept coordinates; program them in a separate block"},
    {"L X+9 RL F1\nL Y+9\nL M140 MB MAX\n",
     "t.h:6:1: error: M140 MB MAX is not allowed with RL or RR active; program R0 first"},
    {"PLANE SPATIAL SPA+90 SPB+0 SPC+0 STAY\nL M140 MB MAX\n",
     "t.h:5:1: error: M140 MB MAX with M128 or in a tilted plane is not supported: the retraction "
     "follows the inclined tool axis; cancel them first, or program MB with a number"},
    {"C X+1 Y+1 DR+ F1\n",
     "t.h:4:1: error: a circle requires a preceding CC in the same coordinate system"},
    {"CC X+5 Y+0\nC X+5 Y+9 DR+ F1\n",
     "t.h:5:1: error: the end of the circle is 9.0000 mm from CC, its start 5.0000 mm; controls "
     "accept a difference of at most 0.016 mm (MP7431)"},
    {"CC X+5 Y+0\nC X+10 Y+0 F1\n",
     "t.h:5:1: error: C without DR: the direction of rotation depends on the preceding block; "
     "program DR"},
    {"CC X+0 Y+0\nC X+1 Y+0 DR+ F1\n", "t.h:5:1: error: the circle starts at its centre (CC)"},
    {"CC X+5 Y+0\nC X+10 Y+0 DR+ FMAX\n",
     "t.h:5:1: error: FMAX is not allowed in a circle block; program F"},
    {"CR X+30 R+10 DR+ F1\n",
     "t.h:4:1: error: CR R10: start and end are 30.0000 mm apart; the distance must be > 0 and at "
     "most the diameter; program a full circle in two blocks"},
    {"CT X+3 Y+3 F1\n",
     "t.h:4:1: error: CT requires a preceding motion block in the plane of the arc"},
    {"RND R3\n", "t.h:4:1: error: RND and CHF require a preceding motion block in the plane"},
    {"L X+5 F1\nL Z-5\nRND R1\nL Y+5\n",
     "t.h:6:1: error: RND and CHF require a preceding motion block in the plane"},
    {"L X+5 F1\nRND R9\nL Y+5\n",
     "t.h:5:1: error: RND R9 is longer than the elements at the corner"},
    {"L X+5 RL F1\nL X+9\nCC X+9 Y+2\nC X+9 Y+4 DR+\n",
     "t.h:7:1: error: a tool of radius 5 mm does not fit inside an arc of radius 2 mm"},
    {"CC X+5 Y+0\nC X+10 Y+0 DR+ RL F1\n",
     "t.h:5:1: error: RL and RR must not be activated in a circle block; program a straight line "
     "first"},
    {"L X+9 RL F1\nL Y+9\nL X+0 RR\n",
     "t.h:6:1: error: RL and RR: compensation on the other side is active; program R0 in "
     "between"},
    {"L X+9 RL F1\nL Y+9\nL X+0 R0\n",
     "t.h:6:1: error: the block after R0 must program both axes of the plane: the position of the "
     "other axis is undocumented"},
    {"L X+9 RL F1\nL X+0 R0\n",
     "t.h:5:1: error: the block after R0 must program both axes of the plane: the position of the "
     "other axis is undocumented"},
    {"L X+9 RL F1\nTOOL CALL 2 Z S1\n",
     "t.h:5:1: error: TOOL CALL is not allowed with RL or RR active; program R0 first"},
    {"APPR LT X+9 Y+9 LEN5 R0 F1\n",
     "t.h:4:1: error: APPR LT with R0: iTNC 530 and TNC 640 behave differently; program RL or RR"},
    {"DEP LT LEN5 F1\n", "t.h:4:1: error: DEP requires a preceding contour element with RL or RR"},
    {"APPR LT X+9 Y+0 LEN5 RL F1\nL Y+9\nDEP LT LEN5 Z+3\n",
     "t.h:6:1: error: DEP LT with Z: controls differ, some move Z during the departure, others "
     "after it; program Z in the next block"},
    {"TOOL CALL \"MILL\" Z S1\n",
     "t.h:4:11: error: tool names are not supported with --tools; use the tool number"},
    {"TOOL CALL 1 Y S1\n", "t.h:4:1: error: tool axis Y is not supported; only Z"},
    {"TOOL DEF 1 L+90 R+5\n",
     "t.h:4:1: error: TOOL DEF 1: the tool table has L100 R5; a control with a tool table uses "
     "these values, one without uses the block; remove one of them"},
    {"CALL LBL 7\n", "t.h:4:1: error: LBL 7 is not defined in the program"},
    {"CALL LBL 7\nL M2\nLBL 7\n",
     "t.h:7:1: error: LBL 0 is missing: the program ends within LBL 7"},
    {"LBL 1\nLBL 1\n", "t.h:5:1: error: LBL 1 appears twice"},
    {"CALL PGM HOLE\n",
     "t.h:4:10: error: CALL PGM HOLE: file HOLE.H found neither next to the program nor in the "
     "folders of --subs"},
    {"Q1 = SQRT -1\n", "t.h:4:6: error: SQRT of -1: must be >= 0"},
    {"Q1 = 5 / 0\n", "t.h:4:8: error: '/': division by zero"},
    {"Q1 = -2^2\n",
     "t.h:4:8: error: '^': a power after a sign: the order of evaluation is undocumented; use "
     "parentheses"},
    {"Q1 = SGN 0\n",
     "t.h:4:6: error: SGN of 0: 1 on an iTNC 530, 0 on a TNC 640; use FN 9 to FN 12 for the "
     "comparison"},
    {"Q1 = SINUS 3\n", "t.h:4:6: error: 'SINUS': unknown function; did you mean 'SIN'?"},
    {"FN 14: ERROR = 1000\n",
     "t.h:4:1: error: FN 14: the program stops here with an error message"},
    {"FN 18: SYSREAD Q1 = ID220\nL X+Q1 F1\n",
     "t.h:5:3: error: Q1 was read from the control (FN 18: SYSREAD Q1 = ID220; set it with "
     "--parameter Q1=NUMBER) and is unknown here; assign it in the program"},
    {"FN 18: SYSREAD QS1 = ID220\n",
     "t.h:4:1: error: FN 18: expected a Q parameter for the result"},
    {"FN 17: SYSWRITE ID 10 = 1\n",
     "t.h:4:1: error: FN 17 writes data of the control or PLC, with unknown effect; remove the "
     "block if it causes no motion"},
    {"CYCL CALL PAT\n",
     "t.h:4:1: error: CYCL CALL PAT requires PATTERN DEF: point tables are not supported"},
    {"PATTERN DEF SQUARE1 (X+0 Y+0)\n",
     "t.h:4:13: error: PATTERN DEF: expected POS, ROW, PAT, FRAME, CIRC or PITCHCIRC with its "
     "number"},
    {"PATTERN DEF ROW1 (X+0 Y+0 D+5)\n", "t.h:4:1: error: PATTERN DEF requires NUM"},
    {"PATTERN DEF PAT1 (X+0 Y+0 DX+5 DY+5 NUMX2 NUMY2 ROTX+5)\n",
     "t.h:4:1: error: PATTERN DEF with ROTX, which distorts the pattern, is not supported; use "
     "POS"},
    {"CYCL DEF 208 BORE MILLING\n",
     "t.h:4:10: error: CYCL DEF 208: bore milling: the approach path to the wall is internal to "
     "the control; program it with CC and CP IPA"},
    {"CYCL DEF 253 SLOT MILLING\n",
     "t.h:4:10: error: CYCL DEF 253: slots: the roughing path is internal to the control; have the "
     "CAM system output the moves"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN FMAX SYM+\n",
     "t.h:4:1: error: PLANE: SYM selects a solution by a machine-specific rule and is not "
     "supported; use SEQ+, SEQ- or neither"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY SEQ+\nPLANE RESET STAY\nL A+Q120 FMAX\n",
     "t.h:6:3: error: Q120 is the rotary axis angle of PLANE and is unknown here; assign it in the "
     "program"},
    {"CYCL CALL\n", "t.h:4:1: error: no cycle is defined"},
    {"CYCL DEF 251 RECTANGULAR POCKET\n",
     "t.h:4:10: error: CYCL DEF 251: pockets, slots, studs and threads are not supported; have the "
     "CAM system output the moves"},
    {"CYCL DEF 7.0\nCYCL DEF 7.1 #5\n",
     "t.h:5:14: error: datum tables are not supported; program the shift"},
    {"CYCL DEF 8.0\nCYCL DEF 8.1 X\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT+30\n",
     "t.h:7:1: error: cycles 8 and 10 are both active: their combined effect depends on their "
     "order; reset one"},
    {"CYCL DEF 26.0\nCYCL DEF 26.1 X 1 Y 0.5\n",
     "t.h:5:19: error: cycle 26: Y scaled by 0.5; only factors of 1, which cancel it, are "
     "supported"},
    {"CYCL DEF 11.0\nCYCL DEF 11.1 SCL 0.5\nL Z-5 F1\n",
     "t.h:6:1: error: Z moves while cycle 11 is active: MP7410 determines whether it is scaled; "
     "move Z first"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 MOVE DIST0 F500\n",
     "t.h:4:1: error: PLANE ... MOVE: the compensating movement of the linear axes is not "
     "supported; use TURN"},
    {"PLANE PROJECTED PROPR+30\n",
     "t.h:4:1: error: PLANE: only SPATIAL and RESET are supported; define the plane with spatial "
     "angles"},
    {"PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN FMAX\n",
     "t.h:4:1: error: read as \"G53.1\": G53.1: the rotary axis positions depend on the machine; "
     "pass it with --machine"},
    {"L M128\nL X+1 RL F1\n",
     "t.h:5:1: error: RL and RR are not allowed with M128; cancel it with M129"},
    {"L M128\nL Z+1 FMAX M91\n",
     "t.h:5:1: error: M91 is not allowed with M128; cancel it with M129"},
    {"L C+0 FMAX\nL C+190 FMAX\n",
     "t.h:5:3: error: C would rotate by 190 degrees, or by -170 in the shorter direction: the "
     "direction depends on the machine (MP7682); program M126 or M127"},
    {"CYCL DEF 247 Q339=12\n",
     "t.h:4:1: error: preset 12: only presets 1 to 9 are supported, mapped to G54 to G59.3"},
    {"CYCL DEF 247 Q339=0\nCYCL DEF 247 Q339=1\n",
     "t.h:5:1: error: preset 0, the manually set datum, together with other presets: the offset "
     "between them is unknown; use presets 1 to 9"},
    {"CYCL DEF 247 Q339=2\nCYCL DEF 247 Q339=0\n",
     "t.h:5:1: error: preset 0, the manually set datum, together with other presets: the offset "
     "between them is unknown; use presets 1 to 9"},
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
  EXPECT_EQ(fault("L X+1\n"), "t.h:1:1: error: a conversational program must start with BEGIN PGM");
  EXPECT_EQ(fault("BEGIN PGM T\n"), "t.h:1:1: error: BEGIN PGM must end with MM or INCH");
  EXPECT_EQ(fault("BEGIN PGM T MM\n"), "t.h:1: error: END PGM is missing");
  EXPECT_EQ(fault("BEGIN PGM T MM\nLBL 1\nCALL LBL 1\n"),
            "t.h:3:1: error: calls nested deeper than 19");
}

// Steps of a cycle belong to its first block, which another cycle ends.
TEST(ConversationalRefusals, AStepWithoutTheFirstBlockOfItsCycle) {
  EXPECT_EQ(fault_of("CYCL DEF 0.2 DEPTH -10\n"),
            "t.h:4:10: error: CYCL DEF 0.2 requires CYCL DEF 0.0 before it");
  const std::string other = "CYCL DEF 1.0 PECKING\nCYCL DEF 247 Q339=+1\nCYCL DEF 1.1 SET UP 2\n";
  EXPECT_EQ(fault_of(other), "t.h:6:10: error: CYCL DEF 1.1 requires CYCL DEF 1.0 before it");
}

TEST(ConversationalRefusals, EndlessProgramsEnd) {
  ProgramSetup setup = example_setup();
  setup.most_jumps = 100;
  EXPECT_EQ(fault_of("LBL 1\nFN 9: IF +0 EQU +0 GOTO LBL 1\n", setup),
            "t.h:5:1: error: 100 jumps: the program appears to loop endlessly; raise --max-jumps "
            "if intended");
}

TEST(ConversationalRefusals, WarnsOfWhatItReadsOneWay) {
  Interpreter interpreter(with_frame("L X+1 C+5 F100 M25\nL X+2 C+9\n"), "t.h", example_setup());
  interpreter.rest();
  ASSERT_EQ(interpreter.warnings().size(), 2u);
  EXPECT_EQ(to_string(interpreter.warnings()[0]),
            "t.h:4:1: error: M25 is ignored: machine-builder function; no effect on motion");
  EXPECT_EQ(to_string(interpreter.warnings()[1]),
            "t.h:4:1: error: F in a block with linear and rotary axes: treated as the feed rate of "
            "the linear axes; on some machines it applies to all axes combined");
}

}  // namespace
}  // namespace servomill::controllers::conversational::conversational_refusals_test
