// Cycles, and whole programs. Datum X200 Y250 Z-100; Z counts from -50 with tool 1.
#include "heidenhain_examples.h"

namespace servomill::controllers {

std::vector<HeidenhainExample> heidenhain_cycle_examples() {
  std::vector<HeidenhainExample> all = {
      // Cycle 7: a new shift replaces that before, an incremental one adds to it. M
      {"datum shift",
       "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 Y+20\nL X+1 Y+1 F100\n"
       "CYCL DEF 7.0\nCYCL DEF 7.1 X+5\nL X+1\nCYCL DEF 7.0\nCYCL DEF 7.1 IX+5\nL X+1\n",
       "4 feed X211 Y271 (Z?) F100\n7 feed X206 (Y271) (Z?) F100\n10 feed X211 (Y271) (Z?) F100\n"},
      {"TRANS DATUM", "TRANS DATUM AXIS X+10 Z+3\nL X+1 Z+1 F100\nTRANS DATUM RESET\nL X+1 Z+1\n",
       "2 feed X211 (Y250) Z-46 F100\n4 feed X201 (Y250) Z-49 F100\n"},
      // Cycle 8 mirrors coordinates, and one mirrored axis reverses circles: DR+ runs clockwise. M
      {"mirrored",
       "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nL X+10 Y+0 F100\nCC X+0 Y+0\nC X+0 Y+10 DR+\n"
       "L IX+5 IY+5\nCYCL DEF 8.0\nCYCL DEF 8.1\nL X+10\n",
       "3 feed X190 Y250 (Z?) F100\n5 arc X200 Y260 (Z?) about X200 Y250 turns -1 F100\n"
       "6 feed X195 Y265 (Z?) F100\n9 feed X210 (Y265) (Z?) F100\n"},
      // Both mirrored: half a turn, circles keep their direction
      {"mirrored twice",
       "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X Y\nL X+10 Y+0 F100\nCC X+0 Y+0\nC X+0 Y+10 DR+\n",
       "3 feed X190 Y250 (Z?) F100\n5 arc X200 Y240 (Z?) about X200 Y250 turns 1 F100\n"},
      // Cycle 10: positive angles counter-clockwise, about the datum; both axes move. M
      {"rotated",
       "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nL X+10 Y+0 F100\nL IX+10\nL Y+5\n"
       "CC X+20 Y+0\nC X+20 Y-5 DR+\n",
       "3 feed X200 Y260 (Z?) F100\n4 feed X200 Y270 (Z?) F100\n5 feed X195 Y270 (Z?) F100\n"
       "7 arc X205 Y270 (Z?) about X200 Y270 turns 1 F100\n"},
      // A preset with a basic rotation of 90 degrees at X10 Y20: X+10 Y+5 lies at X10-5, Y20+10
      {"preset with a basic rotation",
       "CYCL DEF 247 DATUM SETTING ~\n  Q339=+3 ;DATUM NUMBER\nL X+10 Y+5 F100\nL IY+1\n"
       "TRANS DATUM AXIS X+1\nL X+0 Y+0\n",
       "3 feed X5 Y30 (Z?) F100\n4 feed X4 Y30 (Z?) F100\n6 feed X10 Y21 (Z?) F100\n"},
      // Cycle 247: preset 2 at X300 Y100 Z-50, tool 50. M
      {"preset", "CYCL DEF 247 DATUM SETTING ~\n  Q339=+2    ;DATUM NUMBER\nL X+10 Z+1 F100\n",
       "3 feed X310 (Y250) Z1 F100\n"},
      // Seconds. M; the name depends on the language
      {"dwell time",
       "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\nCYCL DEF 9.0 VERWEILZEIT\n"
       "CYCL DEF 9.1 V.ZEIT 0,25\n",
       "2 dwell 1.5\n4 dwell 0.25\n"},
      // Cycle 32: tolerance of the path, without a value that of the machine. M
      {"tolerance",
       "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.05\nCYCL DEF 32.2 HSC-MODE:1 TA0.5\nL X+1 F100\n"
       "CYCL DEF 32.0\nCYCL DEF 32.1\nL X+2 FMAX\n",
       "4 feed X201 (Y250) (Z?) F100 tolerance 0.05\n"
       "7 rapid X202 (Y250) (Z?) tolerance of the machine\n"},
      // Comments, structure items, blank forms and skipped blocks
      {"blocks without a motion",
       "; a comment\n* - a heading\nBLK FORM 0.1 Z X+0 Y+0 Z-40\nBLK FORM 0.2 X+100 Y+100 Z+0\n"
       "L X+1 FMAX ; L X+5\n/ L X+2 FMAX\n",
       "5 rapid X201 (Y250) (Z?)\n6 rapid X202 (Y250) (Z?)\n"},
      {"skipped block", "L X+1 FMAX\n/ L X+2 FMAX\nL IX+1 FMAX\n",
       "1 rapid X201 (Y250) (Z?)\n3 rapid X202 (Y250) (Z?)\n"},
  };
  for (auto& example : all) example.setup = heidenhain_example_setup();
  all.back().setup.skips_blocks = true;
  return all;
}

std::vector<HeidenhainExample> heidenhain_whole_examples() {
  HeidenhainSettings tilting;
  tilting.has_tilting = true;
  std::vector<HeidenhainExample> all = {
      // Inches; F counts tenths of an inch per minute: F100 is 10 inch/min
      {"inch",
       "BEGIN PGM I INCH\r\nTRANS DATUM RESET\r\nCYCL DEF 8.0\r\nCYCL DEF 8.1\r\nCYCL DEF 10.0\r\n"
       "CYCL DEF 10.1 ROT 0\r\nCYCL DEF 11.0\r\nCYCL DEF 11.1 SCL1\r\nCYCL DEF 26.0\r\nCYCL DEF "
       "26.1 X1 Y1.0 Z1\r\nTOOL CALL 1 Z S100 DL+1\r\n"
       "M137\r\n\r\nL X+1 Z+0 R0 F100\r\nL X+1.00001 FU0.01\r\nL M2\r\nEND PGM I INCH\r\n",
       "11 tool 1\n14 feed X225.4 (Y?) Z-24.6 F254\n15 feed X225.40025 (Y?) (Z-24.6) R0.254\n"
       "16 end 2\n"},
      // The safe frame for five axes: cycles, plane and M128 off, retract, tool, approach
      {"safe frame",
       "0 BEGIN PGM FRAME MM\n1 CYCL DEF 7.0 DATUM SHIFT\n2 CYCL DEF 7.1 X+0\n3 CYCL DEF 7.2 Y+0\n"
       "4 CYCL DEF 7.3 Z+0\n5 CYCL DEF 8.0 MIRROR IMAGE\n6 CYCL DEF 8.1\n7 CYCL DEF 10.0 ROTATION\n"
       "8 CYCL DEF 10.1 ROT+0\n9 CYCL DEF 11.0 SCALING\n10 CYCL DEF 11.1 SCL 1\n"
       "11 CYCL DEF 26.0 AXIS-SPECIFIC SCALING\n12 CYCL DEF 26.1 X 1 Y 1 Z 1\n"
       "13 PLANE RESET STAY\n14 L M129\n15 L Z-1 R0 FMAX M91\n16 TOOL CALL 1 Z S1000\n"
       "17 L X+10 Y+10 R0 FMAX M3\n18 L Z+5 FMAX M8\n19 L Z-1 F200 M137\n20 L X+50\n"
       "21 L Z-1 R0 FMAX M91 M9\n22 L M5\n23 L M30\n24 END PGM FRAME MM\n",
       "16 rapid M91 (X?) (Y?) Z-1\n17 tool 1\n18 spindle 1 S1000\n18 rapid X210 Y260 (Z?)\n"
       "19 coolant 2\n19 rapid (X210) (Y260) Z-45\n20 feed (X210) (Y260) Z-51 F200\n"
       "21 feed X250 (Y260) (Z-51) F200\n22 rapid M91 (X250) (Y260) Z-1\n22 coolant 0\n"
       "23 spindle 0 S0\n24 end 30\n",
       tilting},
      // Cycle 19 ends by angles of 0, then by no angle. M
      {"end of cycle 19",
       "BEGIN PGM P MM\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+0 C+0\nCYCL DEF 19.0\n"
       "CYCL DEF 19.1\nFUNCTION RESET TCPM\nCYCL DEF 8.0\nCYCL DEF 8.1\nCYCL DEF 10.0\n"
       "CYCL DEF 10.1 ROT+0\nCYCL DEF 11.0\nCYCL DEF 11.1 SCL 1\n"
       "CYCL DEF 26.0\nCYCL DEF 26.1 X 1 Z 1 Y 1\nL Z+0 R0 FMAX M91\nM30\nEND PGM P MM",
       "15 rapid M91 (X?) (Y?) Z0\n16 end 30\n", tilting},
  };
  for (auto& example : all) example.setup = heidenhain_example_setup();
  return all;
}

}  // namespace servomill::controllers
