// Tool changes and stops, feeds, arcs and everything else.
#include "tests/controllers/dialects/fanuc_examples.h"

namespace servomill::controllers {

std::vector<FanucExample> fanuc_motion_examples() {
  return {
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
       "error: 8:1: a motion requires an active G90 or G91"},
      {"the spindle after the tool change", "",
       FANUC_BEGIN "S1000 M3\n"
                   "T1 M6\n"
                   "M3\n",
       "error: 8:1: M3 requires a known S"},
      {"a stop leaves positions unknown", "",
       FANUC_BEGIN "G54 G0 X0.\n"
                   "M0\n"
                   "G91 X1.\n",
       "error: 8:5: an incremental move requires the position of X, which is unknown"},
      {"modes stay over a stop", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. G43 H1 Z5.\n"
                   "M1\n"
                   "X1.\n"
                   "Z6.\n",
       "6 rapid X200 Z-45 H1\n"
       "7 stop 1\n"
       "8 rapid X201 H1\n"
       "9 rapid (X201) Z-44 H1\n"},

      // ---- the skip function
      {"a skip signal stops the axis of the block somewhere", "LRP=1",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "POPEN\n"
                   "G31 Z-2. F300.\n"
                   "DPRNT[X#5061[53]*Y#5062[53]*Z#5063[53]]\n"
                   "G0 Z5.\n"
                   "G31 X10.\n"
                   "PCLOS\n"
                   "Y1.\n",
       "6 rapid X200 Y250 Z-45 H1\n"
       "8 probe (X200) (Y250) Z-52 F300 H1\n"
       "10 rapid (X200) (Y250) Z-45 H1\n"
       "11 probe X210 (Y250) (Z-45) F300 H1\n"
       "13 rapid Y251 (Z-45) H1\n"},
      {"an increment behind a skip", "",
       FANUC_BEGIN "G54 G0 X0. Y0. G43 H1 Z5.\n"
                   "G31 X10. F300.\n"
                   "G91 X1.\n",
       "error: 8:5: an incremental move requires the position of X, which is unknown"},
      {"a skip without an axis", "", FANUC_BEGIN "G31 F300.\n", "error: 6:1: G31 requires an axis"},
      {"a skip with a change of the length", "",
       FANUC_BEGIN "G54 G0 X0. Y0.\nG31 G43 H1 Z5. F300.\n",
       "error: 7:1: a change of the tool length is not allowed in a block with G31"},
      {"a skip by time", "", FANUC_BEGIN "G54 G0 X0.\nG93 G31 X5. F3.\n",
       "error: 7:5: G31 requires an active G94"},

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
       "error: 9:1: a feed motion requires a known F"},
      {"F under G93 is of its block", "", FANUC_BEGIN "G54 G0 X0.\nG1 G93 X10. F2.\nX20.\n",
       "error: 8:1: G93 requires F in every block"},
      {"no F", "", FANUC_BEGIN "G54 G0 X0.\nG1 X10.\n",
       "error: 7:1: a feed motion requires a known F"},
      {"linear and rotary together", "", FANUC_BEGIN "G54 G0 X0. B0.\nG1 X1. B1. F100\n",
       "error: 7:1: linear and rotary axes in one block require G93"},

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
       "error: 6:12: G43 requires G17: with No. 5001#1 (TLB) = 1 the length applies to an axis "
       "other than Z"},
      {"another plane under a length", "TLB=1",
       FANUC_BEGIN "G54 G0 X0. G43 H1 Z10.\nG18 G2 X10. Z0. K-10. F100\n",
       "error: 7:1: a motion outside G17 with a tool length: it is undocumented whether the length "
       "follows the plane with No. 5001#1 (TLB) = 1"},
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
       "error: 7:1: the arc starts at a radius of 10.0000 mm and ends at a radius of 10.0060 mm"},
      {"an arc from an unknown place", "", FANUC_BEGIN "G54 G0 X10.\nG3 X0. Y10. I-10. F100\n",
       "error: 7:1: an arc requires the position of Y, which is unknown"},

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
      {"S is an integer", "", FANUC_BEGIN "S4774.648 M3\n", "error: 6:1: S must be an integer"},
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
       "error: 6:12: M and a motion or dwell in one block: their order is defined by the machine "
       "builder"},
      {"a cycle", "", FANUC_BEGIN "G54 G81 X0. Z-5. R2. F100\n",
       "error: 6:5: G81 is not supported here"},
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
}

}  // namespace servomill::controllers
