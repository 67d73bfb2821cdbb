// Positions, feeds, tools, M functions.
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> line_examples() {
  return {
      // [F] "Absolute dimension", "Incremental dimension": AC and IC act in their word
      {"absolute and incremental", "G1 X10 Y=20 F200\nG91 X5 Y-5\nG90 Z=IC(-3)\nX=AC(0) Y=IC(2)\n",
       "1 feed 10 20 0 F200\n2 feed 15 15 0 F200\n3 feed 15 15 -3 F200\n4 feed 0 17 -3 F200\n"},
      {"words without blanks, small letters", "N10G1X10Y20F100\nn20g0z5\n/N30 X=3.5 F = 50\n",
       "1 feed 10 20 0 F100\n2 rapid 10 20 5\n3 rapid 3.5 20 5\n"},
      {"comments and messages", "; G1 X5\nMSG(\"G1; X5\")\n\nG1 X1 F100 ; last\nMSG (\"\")\n",
       "4 feed 1 0 0 F100\n"},
      {"exponents and constants", "G1 X=1.5EX1 Y='HF' Z='B101' F=2EX2\n", "1 feed 15 15 5 F200\n"},
      // [F] "Inch or metric dimensions": G700 counts F in inches, too
      {"inches", "G700 G1 X1 F10\nG71 X0 F100\n", "1 feed 25.4 0 0 F254\n2 feed 0 0 0 F100\n"},
      // 0.1 mm at 1000 and 2000 rev/min
      {"feed per revolution", "G95 G1 X10 F0.1\nS2000 X0\n",
       "1 feed 10 0 0 F100\n2 spindle 0 S2000\n2 feed 0 0 0 F200\n"},
      // [F] "Constant cutting rate": G97 has the feed of G95, G971 that of G94
      {"G97 and G971", "G97 S2000 G1 X10 F0.1\nG971 X0 F100\n",
       "1 spindle 0 S2000\n1 feed 10 0 0 F200\n2 feed 0 0 0 F100\n"},
      {"feed per revolution through a speed of 0", "G95 G1 X10 F0.1\nS0\nS2000\nX0\n",
       "1 feed 10 0 0 F100\n2 spindle 0 S0\n3 spindle 0 S2000\n4 feed 0 0 0 F200\n"},
      // half of F200 and F100; 10 mm in 30 s at 150 %; G63 without the override
      {"override", "G1 X10 F200 OVR=50\nX0 F100\nOVR=150 G93 X10 F2\nG94 G63 Z-5 F80\nZ0\n",
       "1 feed 10 0 0 F100\n2 feed 0 0 0 F50\n3 feed 10 0 0 F30\n4 feed 10 0 -5 F80\n"
       "5 feed 10 0 0 F120\n"},
      {"an oriented stop of the spindle", "M3\nSPOS=90\nM4\nSPOS[1]=0\nM3\nM19\n",
       "1 spindle 1 S1000\n2 spindle 0 S1000\n3 spindle -1 S1000\n4 spindle 0 S1000\n"
       "5 spindle 1 S1000\n6 spindle 0 S1000\n"},
      // 20 mm in 2 minutes; then in every block
      {"inverse time", "G93 G1 X20 F0.5\nX0\nG94 X10 F100\n",
       "1 feed 20 0 0 F10\n2 feed 0 0 0 F10\n3 feed 10 0 0 F100\n"},
      {"M functions around a motion", "M3 G1 X10 F100 M8\nX0 M5 M9\nM1=4\n",
       "1 spindle 1 S1000\n1 coolant 2\n1 feed 10 0 0 F100\n2 feed 0 0 0 F100\n"
       "2 spindle 0 S1000\n2 coolant 0\n3 spindle -1 S1000\n"},
      // 500 revolutions at 1000 rev/min
      {"dwell in seconds and in revolutions", "G4 F1.5\nG4 S500\nG1 X1 F100\n",
       "1 dwell 1.5\n2 dwell 30\n3 feed 1 0 0 F100\n"},
      {"stops", "M0\nM1\n", "1 stop 0\n2 stop 1\n"},
      {"functions without effect",
       "SOFT FFWON G601 COMPOF DYNNORM STOPRE\nSETMS(1) G1 X1 F100 H5=3\n", "2 feed 1 0 0 F100\n"},
      {"names of CYCLE832",
       "CYCLE832(0.05,_ORI_FINISH,1)\nCOMPCAD G642\nCYCLE832(0,_OFF)\nG1 X1 F100\n",
       "4 feed 1 0 0 F100\n"},
      {"tool length", "T2 M6\nG0 Z5 D1\nD0 Z50\nD1\nZ7\n",
       "1 tool 2\n2 rapid 0 0 5\n3 rapid 0 0 50\n5 rapid 0 0 7\n"},
      {"a tool by the number in its name", "T=\"2\" M6\nT1=1\nM6\n", "1 tool 2\n3 tool 1\n"},
      // [F] "Deselection of frames": without D the machine's position is that of the spindle
      {"machine coordinates", "SUPA G0 Z200 D0\nX50\nG0 G53 X10 Y20\n",
       "1 rapid 0 0 200\n2 rapid 50 0 200\n3 rapid 10 20 200\n"},
      // [F] "Absolute dimension for rotary axes": 350 to 10 by 20 forward; from 20 to 300 backward
      {"rotary axes", "G0 C350\nC=DC(10)\nC20\nC=ACN(300)\nC=ACP(290)\nC=IC(5)\n",
       "1 rapid 0 0 0 C350\n2 rapid 0 0 0 C370\n3 rapid 0 0 0 C380\n4 rapid 0 0 0 C300\n"
       "5 rapid 0 0 0 C650\n6 rapid 0 0 0 C655\n"},
      // [F] "Tapping without compensating chuck": 1.5 mm at 500 rev/min
      {"tapping by G331 and G332", "G331 Z-20 K1.5 S500\nG332 Z5 K1.5\n",
       "1 spindle 0 S500\n1 spindle 1 S500\n1 feed 0 0 -20 F750\n2 spindle -1 S500\n"
       "2 feed 0 0 5 F750\n2 spindle 0 S500\n"},
      {"tapping with a compensating chuck", "G0 Z2 M3\nG63 Z-10 F1000\nM4\nG63 Z2\nX5\n",
       "1 spindle 1 S1000\n1 rapid 0 0 2\n2 feed 0 0 -10 F1000\n3 spindle -1 S1000\n"
       "4 feed 0 0 2 F1000\n5 rapid 5 0 2\n"},
  };
}

}  // namespace servomill::controllers::siemens
