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
    {"N10 G1 X F1\n", "t.mpf:4:8: error: X requires a number, or '=' and a value"},
    {"G1 X=R5 F1\n",
     "t.mpf:4:6: error: R5 is not defined: the control would use the value from an earlier "
     "program; assign it, or pass --parameter R5=NUMBER"},
    {"G1 X=DEPTH F1\n",
     "t.mpf:4:6: error: DEPTH is not defined: DEF is missing, or it is a machine variable with an "
     "unknown value"},
    {"R1=$P_UIFR[1, X,TR]\n",
     "t.mpf:4:4: error: $P_UIFR[1,X,TR] is a control variable with an unknown value; pass "
     "--parameter '$P_UIFR[1,X,TR]=NUMBER'"},
    {"G1 X=$P_TOOLR F1\n",
     "t.mpf:4:6: error: $P_TOOLR is a control variable with an unknown value; pass --parameter "
     "'$P_TOOLR=NUMBER'"},
    {"$P_UIFR[1]=5\n",
     "t.mpf:4:1: error: $P_UIFR[1]: assignments to control variables are not supported; remove the "
     "block if it causes no motion"},
    {"DEPTH=5\n",
     "t.mpf:4:1: error: DEPTH= is neither an address nor a variable: DEF is missing, or it is a "
     "machine variable"},
    {"DEF REAL A, A\n", "t.mpf:4:13: error: A is defined twice"},
    {"DEF FRAME A\n",
     "t.mpf:4:1: error: DEF FRAME: only REAL, INT, BOOL, CHAR, STRING and AXIS are supported"},
    {"DEF REAL A[2]\nA[2]=1\n", "t.mpf:5:1: error: A[2]: the index must be from 0 to 1"},
    {"G1 X=1/0 F1\n", "t.mpf:4:9: error: division by zero"},
    {"G1 X=SQRT(-1) F1\n", "t.mpf:4:6: error: SQRT(-1) is undefined"},
    // [J] "Priority of operations": AND comes before ==
    {"IF 1==1 AND 2==2 GOTOF A\n",
     "t.mpf:4:16: error: two comparisons without parentheses: AND, OR and XOR take precedence over "
     "== and <; write (...) AND (...)"},
    {"GOTOF NOWHERE\n", "t.mpf:4:1: error: GOTOF NOWHERE: label not found after it"},
    {"IF 1==1\n", "t.mpf:4:1: error: IF is not closed; its end is missing"},
    {"ENDWHILE\n", "t.mpf:4:1: error: ENDWHILE requires WHILE"},
    {"G0 G1 X1\n", "t.mpf:4:4: error: G0 and G1 in one block (same G group)"},
    {"G81 X1\n",
     "t.mpf:4:1: error: G81: a cycle of the ISO dialect (G291) or of SINUMERIK 810M; use MCALL "
     "CYCLE81(...)"},
    {"G43 Z1 H1\n",
     "t.mpf:4:1: error: G43: an ISO dialect function (G291), not available in Siemens mode; for "
     "programs in ISO mode choose --reader fanuc"},
    {"G123\n", "t.mpf:4:1: error: G123 is not supported"},
    {"G96 S100\n",
     "t.mpf:4:1: error: G96: constant cutting rate is not supported; use G94 or G95 with S"},
    {"TRANZ X5\n",
     "t.mpf:4:1: error: TRANZ: unknown word, cycle or subprogram: file TRANZ.SPF found neither "
     "next to the program nor in the folders of --subs (an empty one skips the call); did you mean "
     "'TRANS'?"},
    {"M202(0.5)\n",
     "t.mpf:4:1: error: M202: unknown word, cycle or subprogram: file M202.SPF found neither next "
     "to the program nor in the folders of --subs (an empty one skips the call)"},
    {"POCKET3(5,0,2,-10,50,30,5)\n",
     "t.mpf:4:1: error: POCKET3: the path is internal to the control; have the CAM system output "
     "the moves"},
    {"CYCLE977(1)\n",
     "t.mpf:4:1: error: CYCLE977: measuring cycles are not supported: the measured values are "
     "unknown"},
    {"CALL \"HOLE\"\n",
     "t.mpf:4:6: error: file HOLE.SPF found neither next to the program nor in the folders of "
     "--subs"},
    {"G70 F10\n",
     "t.mpf:4:5: error: F with G70 is in the basic unit of the machine (MD10240), which is unknown "
     "here; pass --parameter '$MN_SCALING_SYSTEM_IS_METRIC=1' for mm/min, '=0' for inch/min, or "
     "program G700"},
    {"G510\n",
     "t.mpf:4:1: error: G510: only G54 to G57 and G505 to G509 are supported, mapped to G54 to "
     "G59.3"},
    {"G1 X5 F1 RNDM=2\n",
     "t.mpf:4:10: error: RNDM: modal rounding is not supported; program RND in each block"},
    {"G2 X10 CR=2 F1\n", "t.mpf:4:1: error: CR=2 is less than half the chord length of 10.0000 mm"},
    {"G2 X10 Y0 I4 J0 F1\n",
     "t.mpf:4:1: error: the arc starts 4.0000 mm and ends 6.0000 mm from its centre"},
    {"G2 X10 Y0 K4 F1\n", "t.mpf:4:11: error: K is not in the plane of G17"},
    {"CIP X10 Y10 Z10 I1=5 J1=0 F1\n",
     "t.mpf:4:1: error: CIP is supported only in the planes G17, G18 and G19"},
    {"ROT X30\nG2 X10 Y0 I5 F1\n",
     "t.mpf:5:1: error: an arc in a plane tilted by ROT is not supported; post-process to lines, "
     "or use CYCLE800"},
    {"G1 AP=30 RP=5 F1\n",
     "t.mpf:4:1: error: AP and RP require a pole in the same frame; program G111 first"},
    {"G41 G1 X5 F1\nTRANS X1\n",
     "t.mpf:5:1: error: TRANS is not allowed with G41 or G42 active; program G40 and a move in the "
     "plane first"},
    {"D0\nG41 G1 X5 F1\n", "t.mpf:5:1: error: G41 with D0: no tool radius is active; program D1"},
    {"D2\n", "t.mpf:4:1: error: D2: the tool table has only one cutting edge per tool, D1"},
    {"T=\"MILL\" M6\n",
     "t.mpf:4:1: error: T=\"MILL\": tool names are not supported with --tools; use the tool "
     "number"},
    {"TRANS X10\nG1 X=IC(5) F1\n",
     "t.mpf:5:4: error: an increment of X after a change of frame, work offset or tool length: "
     "SD42440 and SD42442 determine whether it includes the change; program an absolute position "
     "first"},
    {"G0 A10\nTRANS A5\nG91 A10\n",
     "t.mpf:6:5: error: an increment of A after a change of frame, work offset or tool length: "
     "SD42440 and SD42442 determine whether it includes the change; program an absolute position "
     "first"},
    {"SUPA G0 X5\nX=IC(5)\n",
     "t.mpf:5:1: error: an increment of X after a change of frame, work offset or tool length: "
     "SD42440 and SD42442 determine whether it includes the change; program an absolute position "
     "first"},
    {"TRANS X10\nG110 X5\n",
     "t.mpf:5:1: error: an increment of X after a change of frame, work offset or tool length: "
     "SD42440 and SD42442 determine whether it includes the change; program an absolute position "
     "first"},
    {"MCALL CYCLE81(5,0,2,-3)\nF100 MCALL X5\n",
     "t.mpf:5:1: error: MCALL must be in a block without axis words"},
    {"T2 M6\nG91 G0 Z5\n",
     "t.mpf:5:8: error: an increment of Z after a change of frame, work offset or tool length: "
     "SD42440 and SD42442 determine whether it includes the change; program an absolute position "
     "first"},
    {"SUPA G91 X5\n", "t.mpf:4:10: error: SUPA requires absolute positions"},
    {"G1 A3=0 B3=0 C3=1 F1\n",
     "t.mpf:4:4: error: A3=, B3=, C3=: tool directions are not supported; post-process to rotary "
     "axes"},
    {"WHENEVER $AA_IM>5 DO M8\n",
     "t.mpf:4:1: error: WHENEVER: synchronised actions are not supported; remove the block if it "
     "causes no motion"},
    {"MCALL HOLES1(10,20,90,5,5,3)\nX5\n",
     "t.mpf:4:7: error: MCALL HOLES1: only drilling cycles and subprograms can be called modally"},
    {"MCALL CYCLE84(5,0,2,-10,,,3)\nX5\n", "t.mpf:4:7: error: CYCLE84 requires MPIT or PIT"},
    {"CYCLE82(5,0,2,-10,,0,10,1,12)\n",
     "t.mpf:4:1: error: CYCLE82: a depth referred to the shank or a diameter (_GMODE) is not "
     "supported; program the depth of the tip"},
    {"CYCLE82(5,0,2,-10,,0,0,2,12)\n",
     "t.mpf:4:1: error: CYCLE82: drilling along an axis other than that of the active plane "
     "(_DMODE, _AXN) is not supported; program G17, G18 or G19"},
    {"F100\nCYCLE83(5,0,2,-10,,,5,0,0,0,1,1,1)\n",
     "t.mpf:5:1: error: CYCLE83: drilling along an axis other than that of the active plane "
     "(_DMODE, _AXN) is not supported; program G17, G18 or G19"},
    {"S1000 G95 F0.1\nCYCLE85(5,0,2,-10,,0,0.2,0.4)\n",
     "t.mpf:5:1: error: a feed rate of the cycle with G95 is not supported; program G94 before the "
     "cycle"},
    {"G1 X9 G4 F1\n", "t.mpf:4:7: error: G4 must be in a block without axis words"},
    {"G1 X60 G110 AP=0 RP=1\n",
     "t.mpf:4:8: error: G110 accepts either AP and RP or axis words, not both"},
    {"G1 X=IC(5)+1 F1\n",
     "t.mpf:4:11: error: X: AC, IC, DC, ACP and ACN must contain the whole value; write the sum in "
     "their parentheses"},
    {"G1 X5 F=IC(100)\n", "t.mpf:4:7: error: F: AC and IC are allowed for positions only"},
    {"G1 X=DC(5) F1\n", "t.mpf:4:4: error: X: DC, ACP and ACN are allowed for rotary axes only"},
    {"SUPA G0 C=DC(5)\n",
     "t.mpf:4:9: error: SUPA does not accept DC, ACP or ACN; program the absolute position"},
    {"F1=5\n", "t.mpf:4:1: error: the address F1= is not supported"},
    {"G1 X5 P2 F1\n",
     "t.mpf:4:7: error: P, the number of repetitions, requires a subprogram call in the same "
     "block, as in L10 P3"},
    {"MCALL CYCLE81(5,0,2,-3) P2\n",
     "t.mpf:4:25: error: P, the number of repetitions, requires a subprogram call in the same "
     "block, as in L10 P3"},
    {"CYCLE81(5,0,2,-3) P2\n",
     "t.mpf:4:1: error: CYCLE81: P is allowed for subprograms only; program a loop"},
    {"G1 X5 F1 CYCLE81(5,0,2,-3)\n",
     "t.mpf:4:10: error: a cycle or subprogram call must be in a block without axis words"},
    {"G111 X0\nG1 AP=0 RP=5 F1\nG111 X10\nAP=IC(90)\n",
     "t.mpf:7:1: error: AP=IC requires a previous angle about this pole; program AP=AC(...) first"},
    {"G111 X0\nG1 AP=0 RP=5 F1\nG111 X10\nRP=5\n",
     "t.mpf:7:1: error: AP is missing and was not programmed since the pole was set"},
    {"G111 X0\nG91 G1 AP=0 RP=5 F1\n",
     "t.mpf:5:8: error: AP with G91 is ambiguous; write AP=AC(...) or AP=IC(...)"},
    {"G111 X0\nG1 AP=0 RP=-5 F1\n", "t.mpf:5:9: error: RP must be >= 0"},
    {"G111 X=IC(5)\n", "t.mpf:4:6: error: G111 does not accept AC, IC, DC, ACP or ACN"},
    {"G111 X0 Z5\n", "t.mpf:4:9: error: G111: the pole must be in the plane of G17"},
    {"ATRANS X=IC(5)\n", "t.mpf:4:8: error: ATRANS does not accept AC, IC, DC, ACP or ACN"},
    {"RNDM=2\n",
     "t.mpf:4:1: error: RNDM: modal rounding is not supported; program RND in each block"},
    {"RND=2\n",
     "t.mpf:4:1: error: RND has no effect in this block; it requires a move in the plane with G1 "
     "to G3, CIP or CT"},
    {"SUPA G0 X5 RND=2\n",
     "t.mpf:4:12: error: RND has no effect in this block; it requires a move in the plane with G1 "
     "to G3, CIP or CT"},
    {"G1 X5 CR=3 F1\n", "t.mpf:4:7: error: CR has no effect in this block; it requires G2 or G3"},
    {"G1 X5 F1\nCT X9 Y2 TURN=1\n",
     "t.mpf:5:10: error: TURN has no effect in this block; it requires G2 or G3"},
    {"G111 X0\nCIP AP=0 RP=5 I1=2 J1=2 F1\n",
     "t.mpf:5:5: error: AP has no effect in this block; it requires G0 to G3, CT or G110 to G112"},
    {"G2 X10 Y0 J1=5 I5 F1\n",
     "t.mpf:4:11: error: J1 has no effect in this block; it requires CIP"},
    {"TRANS X10 RPL=45\n",
     "t.mpf:4:11: error: RPL has no effect in this block; it requires ROT or AROT"},
    {"G2 X10 Y0 I5 CR=5 F1\n",
     "t.mpf:4:14: error: CR is not allowed with the centre or the angle of the arc; program one of "
     "them"},
    {"G1 X5 F1 FRC=2\n",
     "t.mpf:4:10: error: FRC has no effect in this block; it requires RND, CHR or CHF"},
    {"G1 X5 F1 RND=1 CHR=1\n",
     "t.mpf:4:1: error: RND, CHR and CHF are mutually exclusive; program one of them"},
    {"F1 G0 X5 RND=1\nY5\n",
     "t.mpf:4:10: error: RND, CHF and CHR between rapid moves are not supported; use G1"},
    {"G93 G1 X5 F1 RND=1\nY5\n",
     "t.mpf:4:14: error: RND, CHF and CHR with G93 are not supported; use them with G94 or G95"},
    {"G93 F1\nCYCLE81(5,0,2,-3)\n",
     "t.mpf:5:1: error: CYCLE81 is not allowed with G93; program G94 or G95 first"},
    {"G700 F10\nG1 A5\n",
     "t.mpf:5:1: error: F in inches for rotary axes only: the conversion to degrees depends on "
     "FGREF; program G710"},
    {"FD=100\n", "t.mpf:4:1: error: FD: handwheel feed has no defined duration; remove the word"},
    {"OVRA[S1]=50\n",
     "t.mpf:4:1: error: OVRA: overrides of positioning axes and spindles are not supported; "
     "program S"},
    {"OVR=0\n", "t.mpf:4:1: error: OVR=0: must be > 0 and <= 200"},
    {"DISC=50\n",
     "t.mpf:4:1: error: DISC: overshoot at outside corners is not supported; use DISC=0"},
    {"SETMS(2)\n", "t.mpf:4:1: error: SETMS(2): a second spindle is not supported"},
    {"TRAORI(2)\n",
     "t.mpf:4:1: error: TRAORI(2): only the first transformation is supported, without parameters"},
    {"G26 S500\n",
     "t.mpf:4:5: error: S1000 is above the limit S500 of G26, to which the control clamps it; "
     "program a speed within the limits"},
    {"G25 S800\nS700\n",
     "t.mpf:5:1: error: S700 is below the limit S800 of G25, to which the control clamps it; "
     "program a speed within the limits"},
    {"M3\nG33 X5 Z-20 K2\n",
     "t.mpf:5:5: error: a thread must run along the axis of its pitch only; program X with I, Y "
     "with J or Z with K"},
    {"G331 X5 K2\n",
     "t.mpf:4:6: error: a thread must run along the axis of its pitch only; program X with I, Y "
     "with J or Z with K"},
    {"SCALE Z2\nG331 Z-5 K1\n",
     "t.mpf:5:1: error: a thread while SCALE is active: it is undocumented whether the pitch is "
     "scaled; cancel it with SCALE"},
    {"SCALE Z2\nCYCLE84(5,0,3,-10,,0.5,3,8,,0,400)\n",
     "t.mpf:5:1: error: CYCLE84 while SCALE is active: it is undocumented whether the pitch is "
     "scaled; cancel it with SCALE"},
    {"G1 X10 F1 RND=1\nM8\nM9\nM8\nM9\nY10\n",
     "t.mpf:8:1: error: RND, CHF and CHR allow at most three following blocks without motion in "
     "the plane: the control inserts nothing otherwise; program the next element earlier"},
    {"F100\nCYCLE83(5,0,2,,10,,5,90,0,0,100,0,0,1,1,0,0,0,1,11211112)\n",
     "t.mpf:5:1: error: CYCLE83: _AMODE 11211112 changes the meaning of other parameters, which is "
     "not supported; program the cycle without _AMODE"},
    {"F100\nCYCLE83(5,0,2,,10,,5,0,0,0,100)\n",
     "t.mpf:5:1: error: CYCLE83: FRF must be from 0 to 1"},
    {"F100\nCYCLE83(5,0,2,,10,,5,-90)\n",
     "t.mpf:5:1: error: CYCLE83: DAM < 0 is a factor and must be >= -1"},
    {"F100\nCYCLE82(5,0,2,,10,1,0,1,12)\n",
     "t.mpf:5:1: error: CYCLE82: _AMODE selects the depth DP, but the call specifies DPR"},
    {"F100\nCYCLE85(5,0,2,,10,100,50,50,0,1,21)\n",
     "t.mpf:5:1: error: CYCLE85: dwell in revolutions selected by _AMODE is not supported; program "
     "DTB < 0"},
    {"M3 F100\nCYCLE840(5,0,2,,10,,3,3,0,,1)\n",
     "t.mpf:5:1: error: CYCLE840: SDR must reverse the spindle: 0, 4 after M3, or 3 after M4"},
    {"HOLES2(0,0,5,0,30,12,1010,0,\"2,3\")\n",
     "t.mpf:4:1: error: HOLES2: parameters after NUM are not supported; program the positions"},
    {"M3 G0 X5 M5\n", "t.mpf:4:10: error: M3 and M5 in one block: they cancel each other"},
    {"G4 F1 S2\n", "t.mpf:4:1: error: G4 accepts either F or S; program one of them"},
    {"FOR R1=1 TO 3\nENDFOR\nG1 X=R1 F1\n",
     "t.mpf:6:6: error: R1 is the counter of a finished FOR loop: it holds the last value or the "
     "next one, depending on the control; assign it before reading it"},
    {"DEF INT I\nFOR I=1 TO 3\nENDFOR\nG1 X=I F1\n",
     "t.mpf:7:6: error: I is the counter of a finished FOR loop: it holds the last value or the "
     "next one, depending on the control; assign it before reading it"},
    {"GOTOF AB X5\nAB:\n", "t.mpf:4:10: error: unexpected text after AB"},
    {"IF 1==1\nENDIF X5\n", "t.mpf:5:7: error: unexpected text after ENDIF"},
    {"AB: G1 X1 F1\nREPEAT AB CD\nCD:\n",
     "t.mpf:5:1: error: REPEAT: the repeated section contains this block; repeat a section before "
     "or after it"},
    {"AB: G1 X1 F1\nENDLABEL: X2\nREPEAT AB\n",
     "t.mpf:5:11: error: text after ENDLABEL: it is undocumented whether REPEAT repeats it; "
     "program it in the next block"},
    {"REPEAT AB\nAB: X1\n",
     "t.mpf:4:1: error: REPEAT of a section after it requires ENDLABEL: at the end of the section"},
    {"ENDLABEL\n", "t.mpf:4:1: error: ENDLABEL is a label; write ENDLABEL:"},
    {"REPEAT AB P=1.5\n", "t.mpf:4:1: error: REPEAT: P must be an integer from 0 to 9999"},
};

TEST(SiemensRefusals, FullMessages) {
  for (const Refusal& refusal : kRefusals) {
    SCOPED_TRACE(refusal.lines);
    EXPECT_EQ(fault_of(refusal.lines), refusal.message);
  }
}

}  // namespace
}  // namespace servomill::controllers::siemens::siemens_refusals_test
