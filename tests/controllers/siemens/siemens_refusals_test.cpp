// Siemens programs that are refused, with their full messages.
#include <gtest/gtest.h>

#include "siemens_examples.h"

namespace servomill::controllers::siemens::siemens_refusals_test {
namespace {

struct Refusal {
  const char* lines;
  const char* message;
};

// The first line is line 4 of the file.
const Refusal kRefusals[] = {
    {"G1 X1\n", "t.mpf:4:1: error: no F is active"},
    {"N10 G1 X1 X2 F1\n", "t.mpf:4:11: error: X appears twice in the block"},
    {"N10 G1 X F1\n", "t.mpf:4:8: error: X needs a number, or '=' with a value"},
    {"G1 X=R5 F1\n",
     "t.mpf:4:6: error: R5 has no value here: the control would use the value left by an earlier "
     "program; assign it, or pass --parameter R5=NUMBER"},
    {"G1 X=DEPTH F1\n",
     "t.mpf:4:6: error: DEPTH is not defined: DEF is missing before it, or it is a variable of the "
     "machine, whose value is not in the program"},
    {"R1=$P_UIFR[1, X,TR]\n",
     "t.mpf:4:4: error: $P_UIFR[1,X,TR] is a variable of the control, whose value is not in the "
     "program; pass --parameter '$P_UIFR[1,X,TR]=NUMBER'"},
    {"G1 X=$P_TOOLR F1\n",
     "t.mpf:4:6: error: $P_TOOLR is a variable of the control, whose value is not in the program; "
     "pass --parameter '$P_TOOLR=NUMBER'"},
    {"$P_UIFR[1]=5\n",
     "t.mpf:4:1: error: $P_UIFR[1]: assigns to a variable of the control, whose effect is not "
     "supported; remove the block if it causes no motion"},
    {"DEPTH=5\n",
     "t.mpf:4:1: error: DEPTH= is neither an address nor a variable: DEF is missing before it, or "
     "it is one of the machine"},
    {"DEF REAL A, A\n", "t.mpf:4:13: error: A is defined twice"},
    {"DEF FRAME A\n",
     "t.mpf:4:1: error: DEF FRAME: only REAL, INT, BOOL, CHAR, STRING and AXIS are supported"},
    {"DEF REAL A[2]\nA[2]=1\n", "t.mpf:5:1: error: A[2]: the index must be from 0 to 1"},
    {"G1 X=1/0 F1\n", "t.mpf:4:9: error: division by 0"},
    {"G1 X=SQRT(-1) F1\n", "t.mpf:4:6: error: SQRT(-1) has no value"},
    // [J] "Priority of operations": AND comes before ==
    {"IF 1==1 AND 2==2 GOTOF A\n",
     "t.mpf:4:16: error: two comparisons without parentheses: AND, OR and XOR come before == and "
     "<; write (...) AND (...)"},
    {"GOTOF NOWHERE\n", "t.mpf:4:1: error: GOTOF NOWHERE: there is no such label behind it"},
    {"IF 1==1\n", "t.mpf:4:1: error: IF without its end"},
    {"ENDWHILE\n", "t.mpf:4:1: error: ENDWHILE without WHILE"},
    {"G0 G1 X1\n", "t.mpf:4:4: error: G0 and G1 in one block: they are of one group"},
    {"G81 X1\n",
     "t.mpf:4:1: error: G81: cycles with G functions are of the ISO dialect (G291), or of "
     "SINUMERIK 810M; use MCALL CYCLE81(...)"},
    {"G43 Z1 H1\n",
     "t.mpf:4:1: error: G43: a function of the ISO dialect (G291), not of Siemens mode; if the "
     "program is written for ISO mode, choose --reader fanuc"},
    {"G123\n", "t.mpf:4:1: error: G123 is not supported"},
    {"G96 S100\n",
     "t.mpf:4:1: error: G96: constant cutting speed is not supported; use G97 with S"},
    {"TRANZ X5\n",
     "t.mpf:4:1: error: TRANZ: no such word, cycle or subprogram: no file TRANZ.SPF "
     "next to the program or in the folders of --subs, where an empty one leaves the "
     "call out; did you mean 'TRANS'?"},
    {"M202(0.5)\n",
     "t.mpf:4:1: error: M202: no such word, cycle or subprogram: no file M202.SPF "
     "next to the program or in the folders of --subs, where an empty one leaves "
     "the call out"},
    {"POCKET3(5,0,2,-10,50,30,5)\n",
     "t.mpf:4:1: error: POCKET3: the path is internal to the control; have the CAM system output "
     "the moves"},
    {"CYCLE977(1)\n",
     "t.mpf:4:1: error: CYCLE977: measuring cycles are not supported: the measured values are "
     "unknown"},
    {"CALL \"HOLE\"\n",
     "t.mpf:4:6: error: no file HOLE.SPF next to the program or in the folders of --subs"},
    {"G70 F10\n",
     "t.mpf:4:5: error: F with G70: in the basic unit of the machine (MD10240), which is not in "
     "the program; pass --parameter '$MN_SCALING_SYSTEM_IS_METRIC=1' for mm/min, '=0' for "
     "inch/min, or program G700"},
    {"G510\n",
     "t.mpf:4:1: error: G510: only G54 to G57 and G505 to G509 are supported, as the work offsets "
     "G54 to G59.3"},
    {"G1 X5 F1 RNDM=2\n",
     "t.mpf:4:10: error: RNDM: modal rounding is not supported; program RND in each block"},
    {"G2 X10 CR=2 F1\n",
     "t.mpf:4:1: error: CR=2 is less than half the distance of 10.0000 mm to the end"},
    {"G2 X10 Y0 I4 J0 F1\n",
     "t.mpf:4:1: error: the arc starts 4.0000 mm from its centre and ends 6.0000 mm from it"},
    {"G2 X10 Y0 K4 F1\n", "t.mpf:4:11: error: K is not in the plane of G17"},
    {"CIP X10 Y10 Z10 I1=5 J1=0 F1\n",
     "t.mpf:4:1: error: CIP in a plane that is none of G17, G18 and G19 is not supported"},
    {"ROT X30\nG2 X10 Y0 I5 F1\n",
     "t.mpf:5:1: error: an arc in a plane that ROT has turned in space is not supported; "
     "post-process to lines, or use CYCLE800"},
    {"G1 AP=30 RP=5 F1\n",
     "t.mpf:4:1: error: AP and RP without a pole: program G111 before, in the same frame"},
    {"G41 G1 X5 F1\nTRANS X1\n",
     "t.mpf:5:1: error: TRANS with G41 or G42 active; program G40 and a move in the plane first"},
    {"D0\nG41 G1 X5 F1\n", "t.mpf:5:1: error: G41 with D0: no tool radius is in force; program D1"},
    {"D2\n", "t.mpf:4:1: error: D2: the tool table has one cutting edge for each tool, D1"},
    {"T=\"MILL\" M6\n",
     "t.mpf:4:1: error: T=\"MILL\": only the control's own tool management has names; use the "
     "number of the tool in --tools"},
    {"TRANS X10\nG1 X=IC(5) F1\n",
     "t.mpf:5:4: error: an increment of X behind a change of the frame, the work offset or the "
     "tool "
     "length: whether it takes the change in depends on SD42440 and SD42442; program an absolute "
     "position first"},
    {"T2 M6\nG91 G0 Z5\n",
     "t.mpf:5:8: error: an increment of Z behind a change of the frame, the work offset or the "
     "tool "
     "length: whether it takes the change in depends on SD42440 and SD42442; program an absolute "
     "position first"},
    {"SUPA G91 X5\n", "t.mpf:4:10: error: SUPA with an increment"},
    {"G1 A3=0 B3=0 C3=1 F1\n",
     "t.mpf:4:4: error: A3=, B3=, C3=: tool directions are not supported; post-process to rotary "
     "axes"},
    {"WHENEVER $AA_IM>5 DO M8\n",
     "t.mpf:4:1: error: WHENEVER: synchronised actions are not supported; remove the block if it "
     "causes no motion"},
    {"MCALL CYCLE84(5,0,2,-10,,,3)\nX5\n", "t.mpf:4:7: error: CYCLE84 without MPIT and PIT"},
    {"CYCLE82(5,0,2,-10,,0,10,1,12)\n",
     "t.mpf:4:1: error: CYCLE82: a depth from the shank or by a diameter (_GMODE) is not "
     "supported; "
     "give the depth of the tip"},
    {"CYCLE82(5,0,2,-10,,0,0,2,12)\n",
     "t.mpf:4:1: error: CYCLE82: drilling along another axis than that of the active plane "
     "(_DMODE, _AXN) is not supported; program G17, G18 or G19"},
    {"F100\nCYCLE83(5,0,2,-10,,,5,0,0,0,1,1,1)\n",
     "t.mpf:5:1: error: CYCLE83: drilling along another axis than that of the active plane "
     "(_DMODE, _AXN) is not supported; program G17, G18 or G19"},
    {"S1000 G95 F0.1\nCYCLE85(5,0,2,-10,,0,0.2,0.4)\n",
     "t.mpf:5:1: error: a feed of the cycle with G95 is not supported; program G94 before the "
     "cycle"},
    {"S1000 G95 F0.1\nG1 X10 RND=1 FRC=0.05\nY10\n",
     "t.mpf:5:14: error: FRC with G95 is not supported; use it with G94"},
    {"G1 X9 G4 F1\n", "t.mpf:4:7: error: G4 stands in a block of its own; the block moves an axis"},
    {"G1 X60 G110 AP=0 RP=1\n",
     "t.mpf:4:8: error: G110 with AP and RP beside axis words; use one of both"},
};

TEST(SiemensRefusals, FullMessages) {
  for (const Refusal& refusal : kRefusals) {
    SCOPED_TRACE(refusal.lines);
    EXPECT_EQ(fault_of(refusal.lines), refusal.message);
  }
}

}  // namespace
}  // namespace servomill::controllers::siemens::siemens_refusals_test
