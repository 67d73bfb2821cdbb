// Datum, mirror image, rotation, scaling, M91, presets. Sources as in line_examples.cpp.
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> transformation_examples() {
  return {
      {"cycle 7",
       "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+60\nCYCL DEF 7.2 Y-40\nL X+10 Y+10 Z+1 F100\n"
       "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 IX+5\nL X+0\nTRANS DATUM RESET\nL X+1 Y+1\n",
       "4 feed 70 -30 1 F100\n7 feed 65 -30 1 F100\n9 feed 1 1 1 F100\n"},
      {"TRANS DATUM AXIS", "TRANS DATUM AXIS X+10 Z-5\nL X+1 Z+1 F100\n", "2 feed 11 0 -4 F100\n"},
      // turned by 90 degrees: (10, 0) becomes (0, 10)
      {"cycle 10",
       "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\nL X+10 Y+0 F100\nCC X+0 Y+0\nC X+0 Y+10 "
       "DR+\nL IX+5\n"
       "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0\nL X+0 Y+0\n",
       "3 feed 0 10 0 F100\n5 arc -10 0 0 about 0 0 turns 1 F100\n6 feed -10 5 0 F100\n9 feed 0 0 "
       "0 F100\n"},
      {"rotation about a shifted datum",
       "CYCL DEF 7.0\nCYCL DEF 7.1 X+100\nCYCL DEF 10.0\nCYCL DEF 10.1 ROT-90\nL X+10 Y+5 F100\n",
       "5 feed 105 -10 0 F100\n"},
      // an axis mirrored turns arcs round
      {"cycle 8",
       "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nL X+10 Y+0 F100\nCC X+0 Y+0\nC X+0 Y+10 DR+\n"
       "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1\nL X+10\n",
       "3 feed -10 0 0 F100\n5 arc 0 10 0 about 0 0 turns -1 F100\n8 feed 10 10 0 F100\n"},
      {"cycle 8 with RL",
       "CYCL DEF 8.0\nCYCL DEF 8.1 X\nL X-20 Y+0 FMAX\nL X+0 Y+0 RL F100\nL Y+10\nL X-20 Y+10 R0\n",
       "3 rapid 20 0 0\n4 feed 5 0 0 F100\n5 feed 5 10 0 F100\n6 feed 20 10 0 F100\n"},
      {"cycle 11 in the plane",
       "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.5\nL X+10 Y+20 F100\nL IX+10\nCC X+0 Y+20\nC "
       "X+0 Y+40 DR+\n",
       "3 feed 5 10 0 F100\n4 feed 10 10 0 F100\n6 arc 0 20 0 about 0 10 turns 1 F100\n"},
      // M91 counts from the machine datum; tool 1 is 100 mm long
      {"M91", "L Z-10 R0 FMAX M91\nL X-5 Y-6 FMAX M91\nL Z+5 FMAX\n",
       "1 rapid 0 0 -110\n2 rapid -5 -6 -110\n3 rapid -5 -6 5\n"},
      {"cycle 32 is without moves",
       "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.05\nCYCL DEF 32.2 HSC-MODE:1 TA0.5\nL X+1 F100\n",
       "4 feed 1 0 0 F100\n"},
      {"the frame of a written program",
       "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1\nCYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1\n"
       "PLANE RESET STAY\nM129\nM127\nM117\nM137\nL Z+0 R0 FMAX M91\n",
       "10 rapid 0 0 -100\n"},
      // tilted about X by 90 degrees: Y of the plane is Z of the workpiece
      {"PLANE SPATIAL STAY",
       "PLANE SPATIAL SPA+90 SPB+0 SPC+0 STAY\nL X+1 Y+2 Z+3 F100\nPLANE RESET STAY\nL X+5 Y+5 "
       "Z+5\n",
       "2 feed 1 2 3 F100\n4 feed 5 5 5 F100\n"},
      // STAY moves no axis, whatever SEQ says; Q120 to Q122 are 0 in a level plane
      {"PLANE SPATIAL STAY SEQ",
       "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY SEQ+ TABLE ROT\nPLANE RESET STAY\nL A+Q120 C+Q122 "
       "FMAX\nL X+1 Y+2 Z+3 F100\n",
       "3 rapid 0 0 0\n4 feed 1 2 3 F100\n"},
      // rotary axes are at zero, where programs begin
      {"PLANE RESET TURN without a plane",
       "PLANE RESET TURN FMAX\nL A+0 FMAX\nPLANE RESET MOVE FMAX\nL X+1 F100\n",
       "2 rapid 0 0 0\n4 feed 1 0 0 F100\n"},
      {"M128", "L A+0 B+0 C+0 FMAX\nL M128\nL X+1 C+90 F100\nL C+0\nL M129\n",
       "1 rapid 0 0 0\n3 feed 1 0 0 C90 F100\n4 feed 1 0 0 F100\n"},
  };
}

}  // namespace servomill::controllers::conversational
