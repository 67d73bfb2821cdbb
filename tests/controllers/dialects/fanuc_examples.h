/// Fanuc programs with their actions, worked out by hand from the manuals.
///
/// Machine coordinates (mm): G54 at X200 Y250 Z-100, G55 at X300 Y200 Z-95 B10, G56 unknown;
/// lengths H1 50, H2 55.5, H3 120. Nothing is known of the start.
#pragma once

#include <string_view>
#include <vector>

namespace servomill::controllers {

struct FanucExample {
  const char* name;
  /// Settings under which it holds: conditions such as "EVO=0 IS-B"; "" all.
  std::string_view settings;
  std::string_view program;
  std::string_view actions;  // or "error: ...": the message with line and column
};

// Line 1 ... 5. An action of the body is of line 6 at least.
#define FANUC_BEGIN FANUC_MODES("G17 G40 G80 G90 G94 G97 G69 G15 G50")
#define FANUC_MODES(modes) "G21\n" modes "\n" FANUC_SHIFTS
#define FANUC_SHIFTS                \
  "G50.1 X0. Y0. Z0. A0. B0. C0.\n" \
  "G52 X0. Y0. Z0. A0. B0. C0.\n"   \
  "G92.1 X0. Y0. Z0. A0. B0. C0.\n"

inline const std::vector<FanucExample>& fanuc_examples() {
  static const std::vector<FanucExample> examples = {
      // ---- positions
      {"work offset and length", "LRP=1",
       FANUC_BEGIN "G54 G0 X10. Y20.\n"
                   "G43 H1 Z5.\n"
                   "M30\n",
       "6 rapid X210 Y270\n"
       "7 rapid (X210) (Y270) Z-45 H1\n"
       "8 end\n"},
      {"each axis at its own rate", "LRP=0", FANUC_BEGIN "G54 G0 X10. Y20.\n",
       "6 rapid X210 Y270 ~\n"},
      {"another work system", "LRP=1",
       FANUC_BEGIN "G0 G55 X10. Y20. B5.\n"
                   "G54 X0. B0.\n",
       "6 rapid X310 Y220 B15\n"
       "7 rapid X200 (Y220) B0\n"},
      {"increments", "LRP=1",
       FANUC_BEGIN "G54 G0 X10. Y20.\n"
                   "G91 X5. Y-2.5\n"
                   "X.5\n"
                   "G90 X5.\n",
       "6 rapid X210 Y270\n"
       "7 rapid X215 Y267.5\n"
       "8 rapid X215.5 (Y267.5)\n"
       "9 rapid X205 (Y267.5)\n"},
      {"increments from an unknown place", "", FANUC_BEGIN "G54 G91 G0 X5.\n",
       "error: 6:12: an incremental move needs the position of X, which is not known"},
      {"a number without point on IS-B", "IS-B LRP=1", FANUC_BEGIN "G54 G0 X1000\n",
       "6 rapid X201\n"},
      {"a number without point on IS-C", "IS-C LRP=1", FANUC_BEGIN "G54 G0 X1000\n",
       "6 rapid X200.1\n"},
      {"digits below the increment", "IS-B", FANUC_BEGIN "G54 G0 X1.2345\n",
       "error: 6:8: X has 4 decimals; the control cuts off after 3"},
      {"a tenth of a micrometre", "IS-C LRP=1", FANUC_BEGIN "G54 G0 X1.2345\n",
       "6 rapid X201.2345\n"},
      {"zeros below the increment", "LRP=1", FANUC_BEGIN "G54 G0 X1.2000\n", "6 rapid X201.2\n"},
      {"inches", "LRP=1",
       "G20\n"
       "G17 G40 G80 G90 G94 G69 G15 G50\n" FANUC_SHIFTS "G54 G0 X1. B45.\n"
       "G1 X2.5 F10.\n",
       "6 rapid X225.4 B45\n"
       "7 feed X263.5 (B45) F254\n"},
      {"a switch of the unit", "", "G21\nG20\n",
       "error: 2:1: a switch between G20 and G21 changes work offsets and compensation values"},
      {"the unit beside other words", "", "G21 G90\n",
       "error: 1:1: G20 and G21 stand in a block of their own at the begin of the program"},
      {"a place that nobody has entered", "", FANUC_BEGIN "G56 G0 X0.\n",
       "error: 6:8: the place of G56 is not known"},

      // ---- modes at the start
      {"no G90", "", FANUC_MODES("G17 G40 G80 G94 G69 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: moves while G90 or G91 is not known to be in force"},
      {"no G40", "", FANUC_MODES("G17 G80 G90 G94 G69 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: moves while G40 is not known to be in force"},
      {"no G69", "", FANUC_MODES("G17 G40 G80 G90 G94 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: moves while G69 is not known to be in force"},
      {"no G97", "", FANUC_MODES("G17 G40 G80 G90 G94 G69 G15 G50") "S500 M3\n",
       "error: 6:1: S while G97 is not known to be in force: under G96 it is a cutting speed"},
      {"a mirror image of B", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG0 B0.\n",
       "error: 4:1: moves while G51.1 may mirror B; G50.1 B0. ends it"},
      {"local coordinates", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG52 Y0.\nG92.1 X0. Y0.\n"
       "G54 G0 Y0. X0.\n",
       "error: 6:12: moves X while a shift by G52 may be in force"},
      {"work systems shifted by G92", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG52 X0.\nG54 G0 X0.\n",
       "error: 5:8: moves X while a shift by G92 may be in force"},
      {"other local coordinates", "", FANUC_BEGIN "G52 X5.\n",
       "error: 6:5: G52 and G92.1 with another value than 0 are not read"},
      {"G92.1 with a tool length", "", FANUC_BEGIN "G54 G0 G43 H1 Z5.\nG92.1 Z0.\n",
       "error: 7:1: G92.1 while a tool length is in force cancels it"},
      // G53 counts from the machine's zero, whatever shifts the work
      {"machine positions need no work system", "LRP=1",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG49 G53 G0 Z0.\n",
       "4 rapid Z0 machine\n"},
      // B-63534EN/02 p. 531: the way of each block and the coordinate after it, from A0: -150
      // (210),
      // -30 (180), -80 (100), +380 (120), -840 (0)
      {"a rotary axis that rolls over", "ROA=1",
       FANUC_BEGIN "G54 G0 A0.\n"
                   "A-150.\n"
                   "A540.\n"
                   "A-620.\n"
                   "G91 A380.\n"
                   "A-840.\n",
       "6 rapid A0 ~\n"
       "7 rapid A-150 ~\n"
       "8 rapid A-180 ~\n"
       "9 rapid A-260 ~\n"
       "10 rapid A120 ~\n"
       "11 rapid A-720 ~\n"},
      {"half a turn of an axis that rolls over", "ROA=1", FANUC_BEGIN "G54 G0 A0.\nA180.\n",
       "error: 7:1: moves A by half a turn: which way is not determined where No. 1008#0 (ROA) is "
       "1"},
      {"no G0", "", FANUC_BEGIN "G54 X0.\n",
       "error: 6:1: moves while G0, G1, G2 or G3 is not known to be in force"},
      {"no G54", "", FANUC_BEGIN "G0 X0.\n",
       "error: 6:4: moves while none of G54 ... G59 is in force"},
      {"no tool length", "", FANUC_BEGIN "G54 G0 Z0.\n",
       "error: 6:8: Z while none of G43, G44 and G49 is known to be in force"},

      // ---- places of the machine and the tool length
      {"G53 and the reference position", "LRP=1",
       FANUC_BEGIN "G49 G53 G0 Z0.\n"
                   "G53 X-100. Y-50.\n"
                   "G54 X0.\n"
                   "G91 G28 Y0.\n",
       "6 rapid Z0 machine\n"
       "7 rapid X-100 Y-50 (Z0) machine\n"
       "8 rapid X200 (Y-50) (Z0)\n"
       "9 rapid (X200) Y? (Z0) home\n"},
      {"G28 through a point", "LRP=1",
       FANUC_BEGIN "G54 G0 X10. Y10. G43 H1 Z5.\n"
                   "G28 X20. Z30.\n",
       "6 rapid X210 Y260 Z-45 H1\n"
       "7 rapid X220 (Y260) Z-20 H1\n"
       "7 rapid X? (Y260) Z? home\n"},
      {"G53 cancels the length while G43 stays displayed", "EVO=0 LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "G53 Z-10.\n"
                   "Z5.\n"
                   "G43 H1 Z5.\n",
       "6 rapid X200 Y250 Z-45 H1\n"
       "7 rapid (X200) (Y250) Z-10 machine\n"
       "8 rapid (X200) (Y250) Z-95\n"
       "9 rapid (X200) (Y250) Z-45 H1\n"},
      {"the length returns by itself", "EVO=1 LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "G53 Z-10.\n"
                   "X1.\n"
                   "Z5.\n",
       "6 rapid X200 Y250 Z-45 H1\n"
       "7 rapid (X200) (Y250) Z-10 machine\n"
       "8 rapid X201 (Y250) (Z-10)\n"
       "9 rapid (X201) (Y250) Z-45 H1\n"},
      {"G53 of other axes keeps the length", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "G53 X-100.\n"
                   "Z6.\n",
       "6 rapid X200 Y250 Z-45 H1\n"
       "7 rapid X-100 (Y250) (Z-45) machine\n"
       "8 rapid (X-100) (Y250) Z-44 H1\n"},
      {"G28 cancels the length, too", "EVO=0 LRP=1",
       FANUC_BEGIN "G54 G0 G43 H1 Z5.\n"
                   "G91 G28 Z0.\n"
                   "G90 Z5.\n",
       "6 rapid Z-45 H1\n"
       "7 rapid Z? home\n"
       "8 rapid Z-95\n"},
      {"G49 alone moves Z down", "TOS=0 LRP=1",
       FANUC_BEGIN "G54 G0 G43 H1 Z5.\n"
                   "G49\n"
                   "Z5.\n",
       "6 rapid Z-45 H1\n"
       "7 rapid Z-95\n"
       "8 rapid Z-95\n"},
      {"G49 alone shifts coordinates", "TOS=1 LRP=1",
       FANUC_BEGIN "G54 G0 G43 H1 Z5.\n"
                   "G49\n"
                   "Z5.\n",
       "6 rapid Z-45 H1\n"
       "8 rapid Z-95\n"},
      {"G49 alone at the start", "TOS=0", FANUC_BEGIN "G0 G49\n",
       "error: 6:4: moves Z by the change of the tool length where No. 5006#6 (TOS) is 0, and the "
       "length before is not known"},
      {"another length without Z", "TOS=0 LRP=1",
       FANUC_BEGIN "G54 G0 G43 H1 Z5.\n"
                   "G43 H2\n"
                   "H3\n",
       "6 rapid Z-45 H1\n"
       "7 rapid Z-39.5 H2\n"
       "8 rapid Z25 H3\n"},
      {"G44 subtracts", "LRP=1", FANUC_BEGIN "G54 G0 G44 H1 Z200.\n", "6 rapid Z50 H1\n"},
      {"G53 under G91", "", FANUC_BEGIN "G91 G53 G0 Z0.\n",
       "error: 6:5: G53 under G91 has no effect"},
      {"G53 while G1 is in force", "", FANUC_BEGIN "G1 G53 Z0.\n",
       "error: 6:4: G53 while G0 is not in force"},

      // ---- tool change and stops
      {"a tool change leaves nothing known", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "S1000 M3\n"
                   "M8\n"
                   "T2 M6\n"
                   "G90 G54 G17 G94 G40 G80\n"
                   "S2000 M3\n"
                   "G0 X10.\n"
                   "Y20.\n"
                   "G43 H2 Z5.\n"
                   "M7\n",
       "6 rapid X200 Y250 Z-45 H1\n"
       "7 spindle +1000\n"
       "8 coolant 2\n"
       "9 tool 2\n"
       "11 spindle +2000\n"
       "12 rapid X210\n"
       "13 rapid (X210) Y270\n"
       "14 rapid (X210) (Y270) Z-39.5 H2\n"
       "15 coolant 1\n"},
      {"a mode after the tool change", "",
       FANUC_BEGIN "T1 M6\n"
                   "G54 G40 G80 G94 G17\n"
                   "G0 X10.\n",
       "error: 8:1: moves while G90 or G91 is not known to be in force"},
      {"the spindle after the tool change", "",
       FANUC_BEGIN "S1000 M3\n"
                   "T1 M6\n"
                   "M3\n",
       "error: 8:1: M3 while no S is known"},
      {"a stop leaves positions unknown", "",
       FANUC_BEGIN "G54 G0 X0.\n"
                   "M0\n"
                   "G91 X1.\n",
       "error: 8:5: an incremental move needs the position of X, which is not known"},
      {"modes stay over a stop", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. G43 H1 Z5.\n"
                   "M1\n"
                   "X1.\n"
                   "Z6.\n",
       "6 rapid X200 Z-45 H1\n"
       "7 stop 1\n"
       "8 rapid X201 H1\n"
       "9 rapid (X201) Z-44 H1\n"},

      // ---- feeds
      {"feeds per minute, per revolution and by time", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. B0.\n"
                   "G1 X10. F300\n"
                   "X20. F450.5\n"
                   "B90. F1000.\n"
                   "G93 X30. B0. F2.\n"
                   "G95 X40. F.1\n",
       "6 rapid X200 B0\n"
       "7 feed X210 (B0) F300\n"
       "8 feed X220 (B0) F450.5\n"
       "9 feed (X220) B90 F1000\n"
       "10 feed X230 B0 F21/min\n"
       "11 feed X240 (B0) F0.1/rev\n"},
      {"F does not survive its mode", "",
       FANUC_BEGIN "G54 G0 X0.\n"
                   "G1 X10. F300\n"
                   "G93 X20. F2.\n"
                   "G94 X30.\n",
       "error: 9:1: feeds while no F is known"},
      {"F under G93 is of its block", "", FANUC_BEGIN "G54 G0 X0.\nG1 G93 X10. F2.\nX20.\n",
       "error: 8:1: a block under G93 needs F"},
      {"no F", "", FANUC_BEGIN "G54 G0 X0.\nG1 X10.\n", "error: 7:1: feeds while no F is known"},
      {"linear and rotary together", "", FANUC_BEGIN "G54 G0 X0. B0.\nG1 X1. B1. F100\n",
       "error: 7:1: linear and rotary axes together have no common feed but under G93"},

      // ---- arcs
      {"a quarter clockwise", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y10.\n"
                   "G2 X10. Y0. J-10. F100\n"
                   "G3 X0. Y10. I-10.\n",
       "6 rapid X200 Y260\n"
       "7 arc X210 Y250 F100 about Z at 200 250 turns -1\n"
       "8 arc X200 Y260 F100 about Z at 200 250 turns 1\n"},
      {"a full circle", "LRP=1",
       FANUC_BEGIN "G54 G0 X10. Y0.\n"
                   "G3 I-10. F100\n",
       "6 rapid X210 Y250\n"
       "7 arc (X210) (Y250) F100 about Z at 200 250 turns 1\n"},
      // from X0 Y0, a half turn of radius 10: 10 pi = 31.416 mm; 20 mm deep: hypot = 37.2419 mm
      {"a helix: the feed along the arc", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z0.\n"
                   "G2 X20. Y0. Z-20. I10. F100\n",
       "6 rapid X200 Y250 Z-50 H1\n"
       "7 arc X220 Y250 Z-70 F118.54471 about Z at 210 250 turns -1 H1\n"},
      // B-63943EN-1/02 p. 1654: type B
      {"a length along the normal of another plane", "TLB=1", FANUC_BEGIN "G54 G0 G18 G43 H1 Z5.\n",
       "error: 6:12: G43 outside G17: where No. 5001#1 (TLB) is 1 the length is of another axis "
       "than Z"},
      {"another plane under a length", "TLB=1",
       FANUC_BEGIN "G54 G0 X0. G43 H1 Z10.\nG18 G2 X10. Z0. K-10. F100\n",
       "error: 7:1: moves outside G17 with a tool length: whether it follows the plane where No. "
       "5001#1 (TLB) is 1 was not found in a manual"},
      {"the plane ZX", "LRP=1",
       FANUC_BEGIN "G54 G18 G0 X0. G43 H1 Z10.\n"
                   "G2 X10. Z0. K-10. F100\n",
       "6 rapid X200 Z-40 H1\n"
       "7 arc X210 Z-50 F100 about Y at 200 -50 turns -1 H1\n"},
      {"centres are increments under G90 and G91", "LRP=1",
       FANUC_BEGIN "G54 G0 X5. Y0.\n"
                   "G91 G3 X-10. Y0. I-5. F100\n",
       "6 rapid X205 Y250\n"
       "7 arc X195 Y250 F100 about Z at 200 250 turns 1\n"},
      {"another radius at the end", "", FANUC_BEGIN "G54 G0 X10. Y0.\nG3 X0. Y10.006 I-10. F100\n",
       "error: 7:1: the arc begins at a radius of 10.0000 mm and ends at one of 10.0060 mm"},
      {"an arc from an unknown place", "", FANUC_BEGIN "G54 G0 X10.\nG3 X0. Y10. I-10. F100\n",
       "error: 7:1: an arc needs the position of Y, which is not known"},

      // ---- everything else
      {"dwell on IS-B", "IS-B",
       FANUC_BEGIN "G4 X1.5\n"
                   "G4 P1500\n"
                   "G4 X500\n",
       "6 dwell 1.5\n"
       "7 dwell 1.5\n"
       "8 dwell 0.5\n"},
      {"dwell on IS-C", "IS-C",
       FANUC_BEGIN "G4 X1.5\n"
                   "G4 P1500\n",
       "6 dwell 1.5\n"
       "7 dwell 0.15\n"},
      {"spindle and coolant", "",
       FANUC_BEGIN "S500 M4\n"
                   "S600\n"
                   "M5\n"
                   "M7\n"
                   "M8\n"
                   "M9\n",
       "6 spindle -500\n"
       "7 spindle -600\n"
       "8 spindle off 600\n"
       "9 coolant 1\n"
       "10 coolant 3\n"
       "11 coolant 0\n"},
      {"S is an integer", "", FANUC_BEGIN "S4774.648 M3\n", "error: 6:1: S takes an integer"},
      {"exact stops", "LRP=1",
       FANUC_BEGIN "G54 G0 X0.\n"
                   "G1 G9 X1. F100\n"
                   "X2.\n"
                   "G61 X3.\n"
                   "G64 X4.\n",
       "6 rapid X200\n"
       "7 feed X201 F100 stops\n"
       "8 feed X202 F100\n"
       "9 feed X203 F100 stops\n"
       "10 feed X204 F100\n"},
      {"M beside a motion", "", FANUC_BEGIN "G54 G0 X0. M8\n",
       "error: 6:12: M with a motion or a dwell, whose order is the machine builder's"},
      {"a cycle", "", FANUC_BEGIN "G54 G81 X0. Z-5. R2. F100\n",
       "error: 6:5: G81 is not read here"},
      {"the frame of a program", "LRP=1",
       "%\n"
       "O1234 (PLATE)\n"
       "N1 G21\n"
       "N2 G17 G40 G80 G90 G94 G15 G50 G97 G69\n"
       "N3 G50.1 X0. Y0. Z0.\n"
       "N4 G49 G53 G0 Z0. (UP)\n"
       "G52 X0. Y0. Z0.\n"
       "G92.1 X0. Y0. Z0.\n"
       "N5 T1 M6\n"
       "N6 G90 G54 G17 G94 G40 G80\n"
       "N7 S1000 M3\n"
       "N8 G0 X10. Y20.\n"
       "N9 G43 H1 Z5.\n"
       "N10 M8\n"
       "N11 G1 Z-1. F200.\n"
       "/N12 X50.\n"
       "N13 M9\n"
       "N14 G0\n"
       "N15 G49 G53 Z0.\n"
       "N16 M5\n"
       "N17 M30\n"
       "%\n"
       "anything\n",
       "6 rapid Z0 machine\n"
       "9 tool 1\n"
       "11 spindle +1000\n"
       "12 rapid X210 Y270\n"
       "13 rapid (X210) (Y270) Z-45 H1\n"
       "14 coolant 2\n"
       "15 feed (X210) (Y270) Z-51 F200 H1\n"
       "16 feed X250 (Y270) (Z-51) F200 H1\n"
       "17 coolant 0\n"
       "19 rapid (X250) (Y270) Z0 machine\n"
       "20 spindle off 1000\n"
       "21 end\n"},
  };
  return examples;
}

}  // namespace servomill::controllers
