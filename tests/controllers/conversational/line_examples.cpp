// Lines, feeds, tools, M functions. [407] is the user's manual of the TNC 407/425/426 (280 580),
// [530] that of the iTNC 530 (60642x-04), [640] that of the TNC 640 (34059x-05).
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> line_examples() {
  return {
      {"absolute and incremental", "L X+10 Y+20 R0 F200\nL IX+5 IY-5\nL Z-3\n",
       "1 feed 10 20 0 F200\n2 feed 15 15 0 F200\n3 feed 15 15 -3 F200\n"},
      // F stays in force over blocks with FMAX
      {"FMAX acts in its block", "L X+10 F200\nL Y+5 FMAX\nL Z-1\nL Z+1 F MAX\nL X+0\n",
       "1 feed 10 0 0 F200\n2 rapid 10 5 0\n3 feed 10 5 -1 F200\n4 rapid 10 5 1\n5 feed 0 5 1 "
       "F200\n"},
      {"decimal comma, blanks and block numbers",
       "4 L X +10,5  Y-2.25 F 300 M8\n5 ; remark\n\n6 * - item\n7 L Z+1\n",
       "1 coolant 2\n1 feed 10.5 -2.25 0 F300\n5 feed 10.5 -2.25 1 F300\n"},
      {"without block numbers and signs", "L X10 Y20 F100\n", "1 feed 10 20 0 F100\n"},
      {"entries that were skipped in the dialog", "L X+10 R0 F200 M\nL Y+5 R F M\nL Z-1 F MAX M\n",
       "1 feed 10 0 0 F200\n2 feed 10 5 0 F200\n3 rapid 10 5 -1\n"},
      {"feed of TOOL CALL", "TOOL CALL 2 Z S2000 F500\nL Z+10 FAUTO\nL X+5 F100\nL X+6 FAUTO\n",
       "1 tool 2\n1 spindle 0 S2000\n2 feed 0 0 10 F500\n3 feed 5 0 10 F100\n4 feed 6 0 10 F500\n"},
      // M3 and M8 before the motion, M5 and M9 behind it
      {"M functions around a motion", "L X+10 F100 M3\nL X+0 M5\nL X+5 M13\nL X+0 M9\n",
       "1 spindle 1 S1000\n1 feed 10 0 0 F100\n2 feed 0 0 0 F100\n2 spindle 0 S1000\n"
       "3 spindle 1 S1000\n3 coolant 2\n3 feed 5 0 0 F100\n4 feed 0 0 0 F100\n4 coolant 0\n"},
      {"speed alone", "TOOL CALL S1500\nL M4\n", "1 spindle 0 S1500\n2 spindle -1 S1500\n"},
      // M0 stops the spindle and the coolant
      {"stops", "L M3\nSTOP\nL M1\n",
       "1 spindle 1 S1000\n2 spindle 0 S1000\n2 coolant 0\n2 stop 0\n3 stop 1\n"},
      {"dwell",
       "CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\nCYCL DEF 9.0 VERWEILZEIT\nCYCL DEF 9.1 "
       "V.ZEIT0.5\n",
       "2 dwell 1.5\n4 dwell 0.5\n"},
      {"rotary axes", "L C+30 F1000\nL IC+15 FMAX\nL A-20 F500\n",
       "1 feed 0 0 0 C30 F1000\n2 rapid 0 0 0 C45\n3 feed 0 0 0 A-20 C45 F500\n"},
      // 20 mm in 2 s
      {"feed by time and per revolution", "L X+20 FT2\nL X+0 FU0.1\n",
       "1 feed 20 0 0 F600\n2 feed 0 0 0 F100\n"},
      {"an increment from an unknown place", "L Z+0 FMAX M91\nL IZ-2 F100\n",
       "1 rapid 0 0 -100\n2 feed 0 0 -102 F100\n"},
      // 10 mm longer than the table: the tip of the table's tool stays 0.5 mm above
      {"oversize of TOOL CALL", "TOOL CALL 1 Z S1000 DL+0.5\nL Z+10 FMAX\n",
       "1 spindle 0 S1000\n2 rapid 0 0 10.5\n"},
      {"M140 along the tool axis", "L Z-5 F100\nL M140 MB 50\nL M140 MB10 F500\n",
       "1 feed 0 0 -5 F100\n2 rapid 0 0 45\n3 feed 0 0 55 F500\n"},
      // without M127 nothing is turned by more than half a turn; with it as written
      {"M126 and M127", "L C+10 FMAX\nL C+170 FMAX M127\nL C-170 FMAX\n",
       "1 rapid 0 0 0 C10\n2 rapid 0 0 0 C170\n3 rapid 0 0 0 C-170\n"},
  };
}

}  // namespace servomill::controllers::conversational
