// RND and CHF, radius compensation, APPR and DEP. Sources as in line_examples.cpp. Tool 1 has
// radius 5.
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> contour_examples() {
  return {
      // From X0 along X, then up Y: the arc of R4 about (16, 4)
      {"RND between lines", "L X+20 F200\nRND R4 F100\nL Y+30\n",
       "1 feed 16 0 0 F200\n2 arc 20 4 0 about 16 4 turns 1 F100\n3 feed 20 30 0 F200\n"},
      // RND belongs to the element before it
      {"functions behind RND", "L X+20 F200\nRND R4\nM8\nL Y+30 M3\n",
       "1 feed 16 0 0 F200\n2 arc 20 4 0 about 16 4 turns 1 F200\n3 coolant 2\n"
       "4 spindle 1 S1000\n4 feed 20 30 0 F200\n"},
      // [530] p. 221 (example of RND), 10 25 5 ... : corner (40, 25) between the directions (30,
      // -15) and
      // (-30, -20), normalised (2, -1) / sqrt 5 and (-3, -2) / sqrt 13. Bisector and half angle:
      // the
      // interior angle b has cos b = (-2, 1).(-3, -2) / sqrt 65 = 4 / sqrt 65, tan(b / 2) =
      // sqrt((1 - cos b) / (1 + cos b)) = 0.580322, length cut off R / tan(b / 2) = 8.61590, so
      // (40, 25) - 8.61590 (2, -1) / sqrt 5 = (32.2937, 28.8531) and (40, 25) + 8.61590 (-3, -2) /
      // sqrt 13 = (32.8311, 20.2208); the centre is 5 to the right of the first line
      {"RND of the manual", "L X+10 Y+40 R0 F300 M3\nL X+40 Y+25\nRND R5 F100\nL X+10 Y+5\n",
       "1 spindle 1 S1000\n1 feed 10 40 0 F300\n2 feed 32.2937 28.8531 0 F300\n"
       "3 arc 32.8311 20.2208 0 about 30.0576 24.381 turns -1 F100\n4 feed 10 5 0 F300\n"},
      {"CHF", "L X+20 F200\nCHF 3\nL Y+30\nCHF2 F50\nL X+0\n",
       "1 feed 17 0 0 F200\n2 feed 20 3 0 F200\n3 feed 20 28 0 F200\n4 feed 18 30 0 F50\n"
       "5 feed 0 30 0 F200\n"},
      // the arc about (30, 0) begins upwards; a centre 2 above the line and 12 from (30, 0) is at
      // x = 30 - sqrt(144 - 4), its foot on the arc 10/12 of the way to it
      {"RND between a line and an arc", "L X+20 F100\nRND R2\nCC X+30 Y+0\nC X+30 Y+10 DR-\n",
       "1 feed 18.1678 0 0 F100\n2 arc 20.1399 1.6667 0 about 18.1678 2 turns 1 F100\n"
       "4 arc 30 10 0 about 30 0 turns -1 F100\n"},
      // left of the path: outside corners with an arc about the corner
      {"RL around a square",
       "L X-20 Y-20 FMAX\nL X+0 Y+0 RL F100\nL Y+30\nL X+30\nL Y+0\nL X+0\nL X-20 Y-20 R0 FMAX\n",
       "1 rapid -20 -20 0\n2 feed -5 0 0 F100\n3 feed -5 30 0 F100\n"
       "4 arc 0 35 0 about 0 30 turns -1 F100\n4 feed 30 35 0 F100\n"
       "5 arc 35 30 0 about 30 30 turns -1 F100\n5 feed 35 0 0 F100\n"
       "6 arc 30 -5 0 about 30 0 turns -1 F100\n6 feed 0 -5 0 F100\n7 rapid -20 -20 0\n"},
      // inside corners: the intersection of the parallels
      {"RL inside a square",
       "L X+15 Y+15 FMAX\nL X+15 Y+0 RL F100\nL X+30\nL Y+30\nL X+0\nL Y+0\nL X+15\nL Y+15 X+15 "
       "R0\n",
       "1 rapid 15 15 0\n2 feed 15 5 0 F100\n3 feed 25 5 0 F100\n4 feed 25 25 0 F100\n"
       "5 feed 5 25 0 F100\n6 feed 5 5 0 F100\n7 feed 15 5 0 F100\n8 feed 15 15 0 F100\n"},
      {"RL along a circle",
       "L X-20 Y+0 FMAX\nL X+0 Y+0 RL F100\nCC X+20 Y+0\nC X+0 Y+0 DR-\nL X-20 Y+0 R0\n",
       "1 rapid -20 0 0\n2 feed -5 0 0 F100\n4 arc -5 0 0 about 20 0 turns -1 F100\n5 feed -20 0 0 "
       "F100\n"},
      // M functions and Z between elements stay between them
      {"depth between elements",
       "L X-10 Y+0 FMAX\nL X+0 Y+0 RL F100\nL Z-5\nL Y+20 M8\nL X+20\nL X+40 Y+20 R0\n",
       "1 rapid -10 0 0\n2 feed -5 0 0 F100\n3 feed -5 0 -5 F100\n4 coolant 2\n4 feed -5 20 -5 "
       "F100\n"
       "5 arc 0 25 -5 about 0 20 turns -1 F100\n5 feed 20 25 -5 F100\n6 feed 40 20 -5 F100\n"},
      {"oversize of the radius",
       "TOOL CALL 1 Z S1000 DR+1\nL X-20 Y+0 Z+0 FMAX\nL X+0 Y+0 RL F100\nL Y+10\nL X-20 Y+10 R0\n",
       "1 spindle 0 S1000\n2 rapid -20 0 0\n3 feed -6 0 0 F100\n4 feed -6 10 0 F100\n5 feed -20 10 "
       "0 F100\n"},
      // corner of RL with a rounding: the arc of R8 inside becomes one of R3
      {"RND with RL",
       "L X+15 Y+15 FMAX\nL X+10 Y+0 RL F100\nL X+30\nRND R8\nL Y+30\nL X+15 Y+30 R0\n",
       "1 rapid 15 15 0\n2 feed 10 5 0 F100\n3 feed 22 5 0 F100\n4 arc 25 8 0 about 22 8 turns 1 "
       "F100\n"
       "5 feed 25 30 0 F100\n6 feed 15 30 0 F100\n"},
      // [407] p. 5-6: along the extension of the first element, here up Y
      {"APPR LT and DEP LT",
       "L X+50 Y-30 FMAX\nAPPR LT X+30 Y+0 Z-10 LEN15 RR F100\nL Y+20\nDEP LT LEN12 F300\nL Z+10 "
       "FMAX\n",
       "1 rapid 50 -30 0\n2 rapid 35 -15 0\n2 rapid 35 -15 -10\n2 feed 35 0 -10 F100\n3 feed 35 20 "
       "-10 F100\n"
       "4 feed 35 32 -10 F300\n5 rapid 35 32 10\n"},
      {"APPR LN and DEP LN",
       "L X-50 Y+0 F500\nAPPR LN X+0 Y+0 LEN15 RL F100\nL Y+20\nDEP LN LEN+10\n",
       "1 feed -50 0 0 F500\n2 feed -20 0 0 F500\n2 feed -5 0 0 F100\n3 feed -5 20 0 F100\n4 feed "
       "-15 20 0 F100\n"},
      // half a circle of R10 about (-15, 0): RL turns counter-clockwise, coming from (-25, 0)
      {"APPR CT and DEP CT",
       "L X-50 Y+0 FMAX\nAPPR CT X+0 Y+0 CCA180 R+10 RL F100\nL Y+20\nDEP CT CCA90 R+8\n",
       "1 rapid -50 0 0\n2 rapid -25 0 0\n2 arc -5 0 0 about -15 0 turns 1 F100\n3 feed -5 20 0 "
       "F100\n"
       "4 arc -13 28 0 about -13 20 turns 1 F100\n"},
      // the line from (-25, -10) touches the circle about (-15, 0) at (-15, -10)
      {"APPR LCT and DEP LCT",
       "L X-25 Y-10 FMAX\nAPPR LCT X+0 Y+0 R10 RL F100\nL Y+20\nDEP LCT X-25 Y+30 R10\n",
       "1 rapid -25 -10 0\n2 rapid -15 -10 0\n2 arc -5 0 0 about -15 0 turns 1 F100\n3 feed -5 20 "
       "0 F100\n"
       "4 arc -15 30 0 about -15 20 turns 1 F100\n4 feed -25 30 0 F100\n"},
      // the manual's example: R5 with a tool of radius 10 (TOOL CALL 2)
      {"approach with a radius below that of the tool",
       "TOOL CALL 2 Z S4000\nL X-40 Y+50 Z+0 FMAX\nAPPR LCT X+0 Y+50 R5 RL F300\nCC X+50 Y+50\nC "
       "X+0 DR-\n"
       "DEP LCT X-40 Y+50 R5 F1000\n",
       "1 tool 2\n1 spindle 0 S4000\n2 rapid -40 50 0\n3 rapid -16 45.101 0\n"
       "3 arc -10 50 0 about -15 50 turns 1 F300\n5 arc -10 50 0 about 50 50 turns -1 F300\n"
       "6 arc -16 54.899 0 about -15 50 turns 1 F1000\n6 feed -40 50 0 F1000\n"},
      {"APPR PLT",
       "L X+40 Y-40 FMAX\nCC X+0 Y+0\nAPPR PLT PR+20 PA+0 LEN10 RR F100\nL Y+20\nDEP PLCT PR+50 "
       "PA+45 R3\n",
       "1 rapid 40 -40 0\n3 rapid 25 -10 0\n3 feed 25 0 0 F100\n4 feed 25 20 0 F100\n"
       "5 arc 25.5651 21.7525 0 about 28 20 turns -1 F100\n5 feed 35.3553 35.3553 0 F100\n"},
  };
}

}  // namespace servomill::controllers::conversational
