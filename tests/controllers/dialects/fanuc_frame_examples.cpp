// Positions, modes at the start, places of the machine and the tool length.
#include "tests/controllers/dialects/fanuc_examples.h"

namespace servomill::controllers {

std::vector<FanucExample> fanuc_frame_examples() {
  return {
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
       "error: 6:12: an incremental move requires the position of X, which is unknown"},
      {"a number without point on IS-B", "IS-B LRP=1", FANUC_BEGIN "G54 G0 X1000\n",
       "6 rapid X201\n"},
      {"a number without point on IS-C", "IS-C LRP=1", FANUC_BEGIN "G54 G0 X1000\n",
       "6 rapid X200.1\n"},
      {"digits below the increment", "IS-B", FANUC_BEGIN "G54 G0 X1.2345\n",
       "error: 6:8: X has 4 decimals; the control truncates after 3"},
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
       "error: 2:1: switching between G20 and G21 changes work offsets and compensation values"},
      {"the unit beside other words", "", "G21 G90\n",
       "error: 1:1: G20 and G21 must be in a separate block at the start of the program"},
      {"a place that nobody has entered", "", FANUC_BEGIN "G56 G0 X0.\n",
       "error: 6:8: work offset G56 is unknown"},

      // ---- modes at the start
      {"no G90", "", FANUC_MODES("G17 G40 G80 G94 G69 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: a motion requires an active G90 or G91"},
      {"no G40", "", FANUC_MODES("G17 G80 G90 G94 G69 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: a motion requires an active G40"},
      {"no G69", "", FANUC_MODES("G17 G40 G80 G90 G94 G15 G50") "G54 G0 X0.\n",
       "error: 6:1: a motion requires an active G69"},
      {"no G97", "", FANUC_MODES("G17 G40 G80 G90 G94 G69 G15 G50") "S500 M3\n",
       "error: 6:1: S requires G97: with G96 it is a cutting speed"},
      {"a mirror image of B", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG0 B0.\n",
       "error: 4:1: G51.1 may be active in B; cancel it with G50.1 B0."},
      {"local coordinates", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG52 Y0.\nG92.1 X0. Y0.\n"
       "G54 G0 Y0. X0.\n",
       "error: 6:12: X moves, and a shift by G52 may be active"},
      {"work systems shifted by G92", "",
       "G21\nG17 G40 G80 G90 G94 G69 G15 G50\nG50.1 X0. Y0. Z0.\nG52 X0.\nG54 G0 X0.\n",
       "error: 5:8: X moves, and a shift by G92 may be active"},
      {"other local coordinates", "", FANUC_BEGIN "G52 X5.\n",
       "error: 6:5: G52 and G92.1 are supported with values of 0 only"},
      {"G92.1 with a tool length", "", FANUC_BEGIN "G54 G0 G43 H1 Z5.\nG92.1 Z0.\n",
       "error: 7:1: G92.1 cancels the active tool length"},
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
       "error: 7:1: A moves by 180 degrees: the direction is undetermined with No. 1008#0 (ROA) = "
       "1"},
      {"no G0", "", FANUC_BEGIN "G54 X0.\n",
       "error: 6:1: a motion requires an active G0, G1, G2 or G3"},
      {"no G54", "", FANUC_BEGIN "G0 X0.\n", "error: 6:4: a motion requires an active G54 ... G59"},
      {"no tool length", "", FANUC_BEGIN "G54 G0 Z0.\n",
       "error: 6:8: Z requires an active G43, G44 or G49"},

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
       "error: 6:4: moves Z by the change of the tool length with No. 5006#6 (TOS) = 0, and the "
       "previous length is unknown"},
      {"another length without Z", "TOS=0 LRP=1",
       FANUC_BEGIN "G54 G0 G43 H1 Z5.\n"
                   "G43 H2\n"
                   "H3\n",
       "6 rapid Z-45 H1\n"
       "7 rapid Z-39.5 H2\n"
       "8 rapid Z25 H3\n"},
      {"G44 subtracts", "LRP=1", FANUC_BEGIN "G54 G0 G44 H1 Z200.\n", "6 rapid Z50 H1\n"},
      {"G53 under G91", "", FANUC_BEGIN "G91 G53 G0 Z0.\n",
       "error: 6:5: G53 has no effect with G91"},
      {"G53 while G1 is in force", "", FANUC_BEGIN "G1 G53 Z0.\n",
       "error: 6:4: G53 requires an active G0"},

  };
}

}  // namespace servomill::controllers
