// Straight lines, feeds, tools and M functions. Datum X200 Y250 Z-100; Z counts from -50 with
// tool 1.
#include "heidenhain_examples.h"

namespace servomill::controllers {
namespace {

HeidenhainSettings with(bool HeidenhainSettings::*setting, bool value) {
  HeidenhainSettings settings;
  settings.*setting = value;
  return settings;
}

std::vector<HeidenhainExample> motion_examples() {
  return {
      // Absolute from the datum, incremental from the last position; comma and point. M
      {"coordinates", "L X+10 Y+5 R0 F500\nL IX+10\nL IX-2.5 IY+1,5\nL X.5 Y-.25\n",
       "1 feed X210 Y255 (Z?) F500\n2 feed X220 (Y255) (Z?) F500\n"
       "3 feed X217.5 Y256.5 (Z?) F500\n4 feed X200.5 Y249.75 (Z?) F500\n"},
      // FMAX acts in its block only, then F holds again. [430] p. 108 for F; M for FMAX
      {"rapid traverse", "L X+1 F300\nL X+2 FMAX\nL X+3\nL X+4 F MAX\n",
       "1 feed X201 (Y250) (Z?) F300\n2 rapid X202 (Y250) (Z?)\n3 feed X203 (Y250) (Z?) F300\n"
       "4 rapid X204 (Y250) (Z?)\n"},
      // Not found in a manual whether FMAX is a straight line
      {"rapid traverse of each axis", "L X+2 FMAX\n", "1 rapid bent X202 (Y250) (Z?)\n",
       with(&HeidenhainSettings::is_rapid_straight, false)},
      // The tool length acts on Z
      {"tool length", "L Z+2 FMAX\n", "1 rapid (X200) (Y250) Z-48\n"},
      // [472] p. 122: machine datum, no tool length, effective in its block only
      {"machine datum", "L Z-5 FMAX M91\nL Z+10 FMAX\nL X+0 Y+0 F100 M91\nL IX+5\n",
       "1 rapid M91 (X200) (Y250) Z-5\n2 rapid (X200) (Y250) Z-40\n3 feed M91 X0 Y0 (Z-40) F100\n"
       "4 feed X5 (Y0) (Z-40) F100\n"},
      // The limit of travel is unknown. M
      {"retract to the limit", "L Z+2 FMAX\nL M140 MB MAX\nL X+1 FMAX\n",
       "1 rapid (X200) (Y250) Z-48\n2 rapid limit (X200) (Y250) Z?\n3 rapid X201 (Y250) (Z?)\n"},
      // To the position of 0.1 at rapid, along the axis until the probe switches, and back. M
      {"touch probe cycle 0",
       "L X+1 Y+2 R0 FMAX\nL Z+5 FMAX\nTCH PROBE 0.0 REF. PLANE Q5 Z-\n"
       "TCH PROBE 0.1 X+1 Y+2 Z+5\nFN 16: F-PRINT TOUCH.A / TNC:\\TOUCHES.TXT\nL IZ+1 FMAX\n",
       "1 rapid X201 Y252 (Z?)\n2 rapid (X201) (Y252) Z-45\n4 rapid X201 Y252 Z-45\n"
       "4 probe - (X201) (Y252) Z-45\n6 rapid (X201) (Y252) Z-44\n"},
      // FT: seconds for the block. CONTROLS 15; M
      {"feed as a time", "L X+10 FT2.5\nL X+20 F100\n",
       "1 feed X210 (Y250) (Z?) T2.5\n2 feed X220 (Y250) (Z?) F100\n"},
      // FU: mm per revolution. M
      {"feed per revolution", "L X+10 FU0.125\n", "1 feed X210 (Y250) (Z?) R0.125\n"},
      // M136: mm per revolution since 280 476, um before. [ISO] p. 159
      {"M136", "L M136\nL X+10 F0.2\nL M137\nL X+20 F100\n",
       "2 feed X210 (Y250) (Z?) R0.2\n4 feed X220 (Y250) (Z?) F100\n"},
      {"M136 of older software", "L M136\nL X+10 F200\n", "2 feed X210 (Y250) (Z?) R0.2\n",
       with(&HeidenhainSettings::is_m136_in_micrometres, true)},
      // A block of F only
      {"feed of its own", "L F250\nL X+1\n", "2 feed X201 (Y250) (Z?) F250\n"},
  };
}

std::vector<HeidenhainExample> rotary_examples() {
  const HeidenhainSettings reduced = with(&HeidenhainSettings::is_rotary_display_reduced, true);
  HeidenhainSettings shorter = reduced;
  shorter.is_shorter_path_usual = true;
  return {
      // Degrees per minute where only rotary axes move, M116 off. [ISO] p. 164
      {"rotary axes", "L M117\nL B+30 C+90 F360\n", "2 feed (X200) (Y250) (Z?) B30 C90 F360\n"},
      // 3 mm and 4 degrees: path 5, so that the linear axis takes 3/5 of F, or F. Not in a manual
      {"rotary and linear axes", "L M117\nL X+0 C+0 FMAX\nL X+3 C+4 F100\n",
       "2 rapid X200 (Y250) (Z?) C0\n3 feed X203 (Y250) (Z?) C4 F60\n"},
      {"rotary and linear axes, F of the linear ones", "L M117\nL X+0 C+0 FMAX\nL X+3 C+4 F100\n",
       "2 rapid X200 (Y250) (Z?) C0\n3 feed X203 (Y250) (Z?) C4 F100\n",
       with(&HeidenhainSettings::is_feed_of_all_axes, false)},
      // [476] p. 192, the table: 350 to 10 takes -340 without M126 ...
      {"rotary axis without M126", "L C+350 FMAX M127\nL C+10 FMAX\n",
       "1 rapid (X200) (Y250) (Z?) C350\n2 rapid (X200) (Y250) (Z?) C10\n", reduced},
      // ... and +20 with it; 10 to 340 takes -30
      {"rotary axis with M126", "L C+350 FMAX M126\nL C+10 FMAX\nL C-20 FMAX\n",
       "1 rapid (X200) (Y250) (Z?) C350\n2 rapid (X200) (Y250) (Z?) C370\n"
       "3 rapid (X200) (Y250) (Z?) C340\n",
       reduced},
      // The display is not reduced: M126 does not act
      {"rotary axis on a number line", "L C+350 FMAX M126\nL C+10 FMAX\n",
       "1 rapid (X200) (Y250) (Z?) C350\n2 rapid (X200) (Y250) (Z?) C10\n"},
      // MP7682 bit 2. [530] p. 520
      {"shorter path as a setting", "L C+350 FMAX\nL C+10 FMAX\n",
       "1 rapid (X200) (Y250) (Z?) C350\n2 rapid (X200) (Y250) (Z?) C370\n", shorter},
  };
}

std::vector<HeidenhainExample> tool_examples() {
  return {
      // After a tool change all places are unknown; the new length acts: -100 + 80. CONTROLS 2
      {"tool change", "L Z+0 FMAX\nTOOL CALL 2 Z S500\nL X+1 R0 FMAX\nL Z+0 FMAX\n",
       "1 rapid (X200) (Y250) Z-50\n2 tool 2\n3 rapid X201 (Y?) (Z?)\n4 rapid (X201) (Y?) Z-20\n"},
      // The delta value adds to the length: -100 + 50 + 0.2. [430] p. 108
      {"oversize of the length", "TOOL CALL 1 Z S500 DL+0.2 DR-1\nL Z+0 R0 FMAX\n",
       "1 tool 1\n2 rapid (X?) (Y?) Z-49.8\n"},
      // F of TOOL CALL holds until another F, FAUTO takes it again. [430] p. 108; FAUTO: M
      {"feed of the tool call",
       "TOOL CALL 1 Z S500 F350\nL X+1 R0\nL X+2 F100\nL X+3\nL X+4 FAUTO\n",
       "1 tool 1\n2 feed X201 (Y?) (Z?) F350\n3 feed X202 (Y?) (Z?) F100\n"
       "4 feed X203 (Y?) (Z?) F100\n5 feed X204 (Y?) (Z?) F350\n"},
      // Without a number only the speed changes. M
      {"speed by TOOL CALL",
       "L X+1 FMAX M3\nTOOL CALL S2000\nL IX+1 FMAX M5\nTOOL CALL S3000\nL M4\n",
       "1 spindle 1 S1000\n1 rapid X201 (Y250) (Z?)\n2 spindle 1 S2000\n3 rapid X202 (Y250) (Z?)\n"
       "3 spindle 0 S0\n5 spindle -1 S3000\n"},
      // TOOL DEF selects in advance. [430] p. 108. Tool 0 has the length 0. [640] p. 170
      {"tool 0", "TOOL DEF 2\nTOOL CALL 0 Z\nL Z+0 R0 FMAX\n",
       "2 tool 0\n3 rapid (X?) (Y?) Z-100\n"},
      // M6 halts the program where MP7440 bit 0 says so. [306] p. 4-99
      {"M6 that halts", "L X+1 FMAX M6\nL X+2 R0 FMAX\n",
       "1 rapid X201 (Y250) (Z?)\n1 stop 0\n2 rapid X202 (Y?) (Z?)\n"},
      {"M6 that does not halt", "L X+1 FMAX M6\nL X+2 R0 FMAX\n",
       "1 rapid X201 (Y250) (Z?)\n2 rapid X202 (Y?) (Z?)\n",
       with(&HeidenhainSettings::is_m6_halting, false)},
  };
}

// [155] p. 15: M3, M4, M8, M13, M14 at the beginning of a block, M5 and M9 at its end
std::vector<HeidenhainExample> function_examples() {
  return {
      {"spindle", "L X+1 FMAX M3\nL X+2 FMAX M5\nL X+3 FMAX M4\n",
       "1 spindle 1 S1000\n1 rapid X201 (Y250) (Z?)\n2 rapid X202 (Y250) (Z?)\n2 spindle 0 S0\n"
       "3 spindle -1 S1000\n3 rapid X203 (Y250) (Z?)\n"},
      {"coolant", "L X+1 FMAX M8\nL X+2 FMAX M9\n",
       "1 coolant 2\n1 rapid X201 (Y250) (Z?)\n2 rapid X202 (Y250) (Z?)\n2 coolant 0\n"},
      {"spindle and coolant", "L X+1 FMAX M13\nL X+2 FMAX M5 M9\nL M14\n",
       "1 spindle 1 S1000\n1 coolant 2\n1 rapid X201 (Y250) (Z?)\n2 rapid X202 (Y250) (Z?)\n"
       "2 spindle 0 S0\n2 coolant 0\n3 spindle -1 S1000\n3 coolant 2\n"},
      {"M functions alone", "M3\nM8\n", "1 spindle 1 S1000\n2 coolant 2\n"},
      // M0 stops spindle and coolant after the motion; then the operator may move axes
      {"stop", "L X+1 FMAX M3\nL X+2 F100 M0\nL X+3 FMAX\n",
       "1 spindle 1 S1000\n1 rapid X201 (Y250) (Z?)\n2 feed X202 (Y250) (Z?) F100\n2 spindle 0 S0\n"
       "2 coolant 0\n2 stop 0\n3 rapid X203 (Y?) (Z?)\n"},
      {"stop that leaves the spindle on", "L X+1 FMAX M0\n", "1 rapid X201 (Y250) (Z?)\n1 stop 0\n",
       with(&HeidenhainSettings::is_stop_switching_off, false)},
      {"optional stop", "L X+1 FMAX M1\nL X+2 FMAX\n",
       "1 rapid X201 (Y250) (Z?)\n1 stop 1\n2 rapid X202 (Y?) (Z?)\n",
       with(&HeidenhainSettings::is_optional_stop_on, false)},
  };
}

}  // namespace

std::vector<HeidenhainExample> heidenhain_line_examples() {
  std::vector<HeidenhainExample> all = motion_examples();
  for (const auto& more : {rotary_examples(), tool_examples(), function_examples()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (auto& example : all) example.setup = heidenhain_example_setup();
  return all;
}

}  // namespace servomill::controllers
