// Drilling cycles. Sources as in line_examples.cpp; the sequences are those of the cycle
// programming manual of the iTNC 530.
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> cycle_examples() {
  return {
      // pecks of 7, 14 and 20 mm; back to 2 mm above the depth before
      {"cycle 200",
       "CYCL DEF 200 DRILLING ~\n  Q200=2 ;SET-UP CLEARANCE ~\n  Q201=-20 ;DEPTH ~\n"
       "  Q206=+250 ;FEED RATE FOR PLNGNG ~\n  Q202=7 ~\n  Q210=0 ~\n  Q203=+0 ~\n  Q204=50 ~\n"
       "  Q211=0.5\nL Z+50 FMAX\nL X+10 Y+10 FMAX M99\n",
       "10 rapid 0 0 50\n11 rapid 10 10 50\n11 rapid 10 10 2\n11 feed 10 10 -7 F250\n"
       "11 rapid 10 10 2\n11 rapid 10 10 -5\n11 feed 10 10 -14 F250\n11 rapid 10 10 2\n"
       "11 rapid 10 10 -12\n11 feed 10 10 -20 F250\n11 dwell 0.5\n11 rapid 10 10 2\n"
       "11 rapid 10 10 50\n"},
      // on a surface at 5, without a second clearance; CYCL CALL and M89
      {"cycle 240 and M89",
       "CYCL DEF 240 CENTERING Q200=2 Q343=0 Q201=-3 Q344=0 Q206=100 Q211=0 Q203=5 Q204=0\n"
       "L X+10 FMAX\nCYCL CALL\nL X+20 FMAX M89\nL X+30 FMAX\nL X+40 FMAX M99\nL X+50 FMAX\n",
       "2 rapid 10 0 0\n3 rapid 10 0 7\n3 feed 10 0 2 F100\n3 rapid 10 0 7\n"
       "4 rapid 20 0 7\n4 rapid 20 0 7\n4 feed 20 0 2 F100\n4 rapid 20 0 7\n"
       "5 rapid 30 0 7\n5 rapid 30 0 7\n5 feed 30 0 2 F100\n5 rapid 30 0 7\n"
       "6 rapid 40 0 7\n6 rapid 40 0 7\n6 feed 40 0 2 F100\n6 rapid 40 0 7\n7 rapid 50 0 7\n"},
      {"cycle 201",
       "CYCL DEF 201 Q200=2 Q201=-10 Q206=100 Q211=0.25 Q208=250 Q203=0 Q204=20\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 dwell 0.25\n2 feed 0 0 2 F250\n2 rapid 0 0 20\n"},
      {"cycle 202 without disengaging",
       "CYCL DEF 202 Q200=2 Q201=-10 Q206=100 Q211=0 Q208=0 Q203=0 Q204=0 Q214=0\nCYCL CALL M3\n",
       "2 spindle 1 S1000\n2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 feed 0 0 2 F100\n"},
      // two chip breaks by 0.5, then out; pecks of 6, 5, 4, 4 (the least)
      {"cycle 203",
       "CYCL DEF 203 Q200=2 Q201=-19 Q206=100 Q202=6 Q210=0 Q203=0 Q204=0 Q212=1 Q213=2 Q205=4 "
       "Q211=0 Q208=500 Q256=0.5\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 feed 0 0 -6 F100\n2 feed 0 0 -5.5 F500\n2 feed 0 0 -11 F100\n"
       "2 feed 0 0 -10.5 F500\n2 feed 0 0 -15 F100\n2 feed 0 0 2 F500\n2 rapid 0 0 -13\n"
       "2 feed 0 0 -19 F100\n2 feed 0 0 2 F500\n"},
      {"cycle 205",
       "CYCL DEF 205 Q200=2 Q201=-12 Q206=100 Q202=8 Q203=0 Q204=10 Q212=0 Q205=3 Q258=0.5 "
       "Q259=0.5 "
       "Q257=5 Q256=0.2 Q211=0 Q379=0 Q253=750\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 feed 0 0 -5 F100\n2 feed 0 0 -4.8 F100\n2 feed 0 0 -8 F100\n2 rapid 0 0 "
       "2\n"
       "2 rapid 0 0 -7.5\n2 feed 0 0 -12 F100\n2 rapid 0 0 2\n2 rapid 0 0 10\n"},
      // S1000 and a pitch of 1.25: F1250
      {"cycle 207",
       "CYCL DEF 207 RIGID TAPPING Q200=2 Q201=-10 Q239=+1.25 Q203=0 Q204=0\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 spindle 1 S1000\n2 feed 0 0 -10 F1250\n2 spindle -1 S1000\n"
       "2 feed 0 0 2 F1250\n2 spindle 0 S1000\n"},
      // steps of 4, back by half a pitch of 1: S1000 is F1000
      {"cycle 209",
       "CYCL DEF 209 TAPPING W/ CHIP BRKG Q200=2 Q201=-6 Q239=+1 Q203=0 Q204=20 Q257=4 Q256=0.5 "
       "Q336=0\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 spindle 1 S1000\n2 feed 0 0 -4 F1000\n2 spindle -1 S1000\n"
       "2 feed 0 0 -3.5 F1000\n2 spindle 1 S1000\n2 feed 0 0 -6 F1000\n2 spindle -1 S1000\n"
       "2 feed 0 0 2 F1000\n2 spindle 0 S1000\n2 rapid 0 0 20\n"},
      // Q256 = 0 leaves the hole; a left-hand thread
      {"cycle 209 that leaves the hole",
       "CYCL DEF 209 Q200=2 Q201=-6 Q239=-1 Q203=0 Q204=0 Q257=4 Q256=0 Q336=0\nCYCL CALL\n",
       "2 rapid 0 0 2\n2 spindle -1 S1000\n2 feed 0 0 -4 F1000\n2 spindle 1 S1000\n"
       "2 feed 0 0 2 F1000\n2 spindle -1 S1000\n2 feed 0 0 -6 F1000\n2 spindle 1 S1000\n"
       "2 feed 0 0 2 F1000\n2 spindle 0 S1000\n"},
      // between the holes at Z10, where the tool stands at the call; the second hole 3 mm higher
      {"PATTERN DEF POS",
       "CYCL DEF 240 Q200=2 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\n"
       "PATTERN DEF POS1 (X+5 Y+6 Z+0) ~\n POS2 (X+7 Y+8 Z+3)\nL Z+10 FMAX\nCYCL CALL PAT FMAX\n",
       "4 rapid 0 0 10\n5 rapid 5 6 10\n5 rapid 5 6 2\n5 feed 5 6 -1 F50\n5 rapid 5 6 2\n"
       "5 rapid 5 6 10\n5 rapid 7 8 10\n5 rapid 7 8 5\n5 feed 7 8 2 F50\n5 rapid 7 8 5\n"},
      // a row along Y, and two points of a circle of diameter 20 about X100
      {"PATTERN DEF ROW and CIRC",
       "CYCL DEF 240 Q200=2 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\n"
       "PATTERN DEF ROW1 (X+1 Y+0 D+10 NUM2 ROT+90 Z+0) CIRC1 (X+100 Y+0 D20 START+0 NUM2 Z+0)\n"
       "L Z+2 FMAX\nCYCL CALL PAT FMAX\n",
       "3 rapid 0 0 2\n4 rapid 1 0 2\n4 rapid 1 0 2\n4 feed 1 0 -1 F50\n4 rapid 1 0 2\n"
       "4 rapid 1 10 2\n4 rapid 1 10 2\n4 feed 1 10 -1 F50\n4 rapid 1 10 2\n"
       "4 rapid 110 0 2\n4 rapid 110 0 2\n4 feed 110 0 -1 F50\n4 rapid 110 0 2\n"
       "4 rapid 90 0 2\n4 rapid 90 0 2\n4 feed 90 0 -1 F50\n4 rapid 90 0 2\n"},
      // two by two, at the feed of the block before
      {"PATTERN DEF PAT",
       "CYCL DEF 240 Q200=2 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\nL Z+2 F500\n"
       "PATTERN DEF PAT1 (X+1 Y+0 DX+5 DY+6 NUMX2 NUMY2 ROT+0 ROTX+0 ROTY+0 Z+0)\nCYCL CALL PAT\n",
       "2 feed 0 0 2 F500\n4 feed 1 0 2 F500\n4 rapid 1 0 2\n4 feed 1 0 -1 F50\n4 rapid 1 0 2\n"
       "4 feed 6 0 2 F500\n4 rapid 6 0 2\n4 feed 6 0 -1 F50\n4 rapid 6 0 2\n"
       "4 feed 1 6 2 F500\n4 rapid 1 6 2\n4 feed 1 6 -1 F50\n4 rapid 1 6 2\n"
       "4 feed 6 6 2 F500\n4 rapid 6 6 2\n4 feed 6 6 -1 F50\n4 rapid 6 6 2\n"},
      // the last definition counts; two points of a circle from 90 degrees on
      {"PATTERN DEF FRAME and PITCHCIRC",
       "CYCL DEF 240 Q200=2 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\nL Z+2 FMAX\n"
       "PATTERN DEF FRAME1 (X+1 Y+0 DX+5 DY+0 NUMX3 NUMY1 ROT+0)\n"
       "PATTERN DEF PITCHCIRC1 (X+0 Y+0 D20 START+90 STEP+90 NUM2 Z+0)\nCYCL CALL PAT FMAX\n",
       "2 rapid 0 0 2\n5 rapid 0 10 2\n5 rapid 0 10 2\n5 feed 0 10 -1 F50\n5 rapid 0 10 2\n"
       "5 rapid -10 0 2\n5 rapid -10 0 2\n5 feed -10 0 -1 F50\n5 rapid -10 0 2\n"},
      {"cycle 206",
       "CYCL DEF 206 TAPPING NEW Q200=2 Q201=-10 Q206=800 Q211=0 Q203=0 Q204=0\nL M3\nCYCL CALL\n",
       "2 spindle 1 S1000\n3 rapid 0 0 2\n3 feed 0 0 -10 F800\n3 spindle -1 S1000\n"
       "3 feed 0 0 2 F800\n3 spindle 1 S1000\n"},
      // begins at Z2, 2 above the surface; back to 0.6 above the depth before
      {"cycle 1",
       "CYCL DEF 1.0 TIEFBOHREN\nCYCL DEF 1.1 ABST 2\nCYCL DEF 1.2 TIEFE-15\nCYCL DEF 1.3 ZUSTLG "
       "10\n"
       "CYCL DEF 1.4 V.ZEIT 1\nCYCL DEF 1.5 F80\nL Z+2 FMAX\nL X+5 FMAX M99\n",
       "7 rapid 0 0 2\n8 rapid 5 0 2\n8 feed 5 0 -10 F80\n8 rapid 5 0 2\n8 rapid 5 0 -9.4\n"
       "8 feed 5 0 -15 F80\n8 dwell 1\n8 rapid 5 0 2\n"},
      // begins at Z2, 2 above the surface; S1000
      {"cycle 2",
       "CYCL DEF 2.0 GEWINDEBOHREN\nCYCL DEF 2.1 ABST 2\nCYCL DEF 2.2 TIEFE-15\nCYCL DEF 2.3 "
       "V.ZEIT "
       "0.5\nCYCL DEF 2.4 F100\nL Z+2 FMAX M3\nL X+5 FMAX M99\n",
       "6 spindle 1 S1000\n6 rapid 0 0 2\n7 rapid 5 0 2\n7 feed 5 0 -15 F100\n"
       "7 spindle -1 S1000\n7 dwell 0.5\n7 feed 5 0 2 F100\n7 spindle 1 S1000\n"},
      // a left-hand thread of pitch 1: S1000 is F1000
      {"cycle 17",
       "CYCL DEF 17.0 GEW.-BOHREN GS\nCYCL DEF 17.1 ABST 2\nCYCL DEF 17.2 TIEFE-15\nCYCL DEF 17.3 "
       "STEIG-1\nL Z+2 FMAX\nL X+5 FMAX M99\n",
       "5 rapid 0 0 2\n6 rapid 5 0 2\n6 spindle -1 S1000\n6 feed 5 0 -15 F1000\n"
       "6 spindle 1 S1000\n6 feed 5 0 2 F1000\n6 spindle 0 S1000\n"},
      // two holes of a full circle about X10, on a surface at 5, second clearance 20 above it
      {"cycle 220",
       "CYCL DEF 240 Q200=1 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\n"
       "CYCL DEF 220 POLAR PATTERN Q216=10 Q217=0 Q244=20 Q245=0 Q246=360 Q247=0 Q241=2 Q200=2 "
       "Q203=5 Q204=20 Q301=1\n",
       "2 rapid 0 0 25\n2 rapid 20 0 25\n2 rapid 20 0 7\n2 feed 20 0 4 F50\n2 rapid 20 0 7\n"
       "2 rapid 20 0 25\n2 rapid 0 0 25\n2 rapid 0 0 7\n2 feed 0 0 4 F50\n2 rapid 0 0 7\n"
       "2 rapid 0 0 25\n"},
      // from 90 degrees to 270 in two steps, and in steps of -90
      {"cycle 220 with angles",
       "CYCL DEF 240 Q200=1 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\nL Z+1 FMAX\n"
       "CYCL DEF 220 Q216=0 Q217=0 Q244=10 Q245=90 Q246=270 Q247=0 Q241=2 Q200=1 Q203=0 Q204=0 "
       "Q301=0 Q365=0\nCYCL DEF 220 Q216=0 Q217=0 Q244=10 Q245=90 Q246=0 Q247=-90 Q241=2 Q200=1 "
       "Q203=0 Q204=0 Q301=0\n",
       "2 rapid 0 0 1\n3 rapid 0 0 1\n3 rapid 0 5 1\n3 rapid 0 5 1\n3 feed 0 5 -1 F50\n"
       "3 rapid 0 5 1\n3 rapid 0 -5 1\n3 rapid 0 -5 1\n3 feed 0 -5 -1 F50\n3 rapid 0 -5 1\n"
       "4 rapid 0 -5 1\n4 rapid 0 5 1\n4 rapid 0 5 1\n4 feed 0 5 -1 F50\n4 rapid 0 5 1\n"
       "4 rapid 5 0 1\n4 rapid 5 0 1\n4 feed 5 0 -1 F50\n4 rapid 5 0 1\n"},
      // two lines of two holes, turned by 90 degrees; the second line runs backwards
      {"cycle 221",
       "CYCL DEF 240 Q200=2 Q343=0 Q201=-1 Q206=50 Q211=0 Q203=0 Q204=0\n"
       "CYCL DEF 221 CARTESIAN PATTERN Q225=1 Q226=2 Q237=10 Q238=5 Q242=2 Q243=2 Q224=90 Q200=2 "
       "Q203=0 Q204=0 Q301=0\n",
       "2 rapid 0 0 2\n2 rapid 1 2 2\n2 rapid 1 2 2\n2 feed 1 2 -1 F50\n2 rapid 1 2 2\n"
       "2 rapid 1 12 2\n2 rapid 1 12 2\n2 feed 1 12 -1 F50\n2 rapid 1 12 2\n"
       "2 rapid -4 12 2\n2 rapid -4 12 2\n2 feed -4 12 -1 F50\n2 rapid -4 12 2\n"
       "2 rapid -4 2 2\n2 rapid -4 2 2\n2 feed -4 2 -1 F50\n2 rapid -4 2 2\n"},
      {"cycle 19 ends the tilting",
       "CYCL DEF 19.0 BEARBEITUNGSEBENE\nCYCL DEF 19.1 A+0 B+0 C+0 F2000 ABST10\nCYCL DEF 19.0\n"
       "CYCL DEF 19.1\nL X+1 FMAX (SIDE 1)\n",
       "5 rapid 1 0 0\n"},
      {"TOOL DEF7 and CYCL DEF9 .0",
       "TOOL DEF7 L+0 R+3\nCYCL DEF9 .0 VERWEILZEIT\nCYCL DEF9.1 V.ZEIT5\nL X+5 FMAX\n",
       "3 dwell 5\n4 rapid 5 0 0\n"},
      {"CYCL CALL POS and parameters behind the definition",
       "CYCL DEF 240 Q200=1\nQ343=0\nQ201=-2\nQ206=50\nQ211=0\nQ203=0\nQ204=0\n"
       "CYCL CALL POS X+3 Y+4 FMAX\n",
       "8 rapid 3 4 0\n8 rapid 3 4 1\n8 feed 3 4 -2 F50\n8 rapid 3 4 1\n"},
  };
}

}  // namespace servomill::controllers::conversational
