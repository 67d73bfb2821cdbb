// Drilling cycles: [C] "Drilling". The tool is at X0 Y0 Z0, the spindle speed is S1000.
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> cycle_examples() {
  return {
      // RTP 5, RFP 0, SDIS 2, DP -10
      {"drilling once", "F100\nCYCLE81(5,0,2,-10)\n",
       "2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 rapid 0 0 5\n"},
      // DPR counts from RFP, without its sign; 500 revolutions at 1000 rev/min
      {"a depth from the reference plane, a dwell in revolutions",
       "F100\nCYCLE82(5,-1,2,,9,-500)\n",
       "2 rapid 0 0 1\n2 feed 0 0 -10 F100\n2 dwell 30\n2 rapid 0 0 5\n"},
      {"a hole upwards", "F100 G0 Z-20\nCYCLE81(-20,-10,2,0)\n",
       "1 rapid 0 0 -20\n2 rapid 0 0 -12\n2 feed 0 0 0 F100\n2 rapid 0 0 -20\n"},
      {"modal, on blocks that move",
       "G0 Z5 F100\nMCALL CYCLE81(5,0,2,-3)\nX10\nM8\nX20\nMCALL\nX30\n",
       "1 rapid 0 0 5\n3 rapid 10 0 5\n3 rapid 10 0 2\n3 feed 10 0 -3 F100\n3 rapid 10 0 5\n"
       "4 coolant 2\n5 rapid 20 0 5\n5 rapid 20 0 2\n5 feed 20 0 -3 F100\n5 rapid 20 0 5\n"
       "7 rapid 30 0 5\n"},
      // strokes 10 and 6, then DAM: 4, and the last two, 3 and 3
      {"deep holes with removal", "F100\nCYCLE83(5,0,2,-26,,-10,,4,0,0,0.5,1)\n",
       "2 rapid 0 0 2\n2 feed 0 0 -10 F50\n2 rapid 0 0 2\n2 rapid 0 0 -9.4\n"
       "2 feed 0 0 -16 F100\n2 rapid 0 0 2\n2 rapid 0 0 -15.4\n2 feed 0 0 -20 F100\n"
       "2 rapid 0 0 2\n2 rapid 0 0 -19.4\n2 feed 0 0 -23 F100\n2 rapid 0 0 2\n"
       "2 rapid 0 0 -22.4\n2 feed 0 0 -26 F100\n2 rapid 0 0 5\n"},
      // equal strokes of 5, back by 0.5 at F, a dwell of 1 s at each and of 2 s at the last
      {"deep holes with chip breaking", "F100\nCYCLE83(5,0,2,-12,,,5,0,1,,1,0,,,0.5,2)\n",
       "2 rapid 0 0 2\n2 feed 0 0 -5 F100\n2 dwell 1\n2 feed 0 0 -4.5 F100\n2 feed 0 0 -10 F100\n"
       "2 dwell 1\n2 feed 0 0 -9.5 F100\n2 feed 0 0 -12 F100\n2 dwell 2\n2 rapid 0 0 5\n"},
      // M8: pitch 1.25, in at 400 rev/min, out at 800
      {"rigid tapping", "CYCLE84(5,0,3,-10,,0.5,3,8,,0,400,800)\n",
       "1 rapid 0 0 3\n1 spindle 0 S400\n1 spindle 1 S400\n1 feed 0 0 -10 F500\n1 dwell 0.5\n"
       "1 spindle 1 S800\n1 spindle -1 S800\n1 feed 0 0 3 F1000\n1 spindle 1 S800\n"
       "1 spindle 1 S1000\n1 rapid 0 0 5\n"},
      {"tapping with a compensating chuck", "M3\nCYCLE840(5,0,3,-10,,,0,3,0,,1.5)\n",
       "1 spindle 1 S1000\n2 rapid 0 0 3\n2 feed 0 0 -10 F1500\n2 spindle -1 S1000\n"
       "2 feed 0 0 3 F1500\n2 spindle 1 S1000\n2 rapid 0 0 5\n"},
      {"reaming", "F100\nCYCLE85(5,0,2,-10,,1,80,200)\n",
       "2 rapid 0 0 2\n2 feed 0 0 -10 F80\n2 dwell 1\n2 feed 0 0 2 F200\n2 rapid 0 0 5\n"},
      {"boring with an oriented stop", "F100 M3\nCYCLE86(5,0,2,-10,,1,3,0.5,0,0.2,45)\n",
       "1 spindle 1 S1000\n2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 dwell 1\n2 spindle 0 S1000\n"
       "2 rapid 0.5 0 -9.8\n2 rapid 0.5 0 2\n2 rapid 0.5 0 5\n2 rapid 0 0 5\n"
       "2 spindle 1 S1000\n"},
      {"boring with a stop", "F100 M3\nCYCLE88(5,0,2,-10,,1,3)\nCYCLE87(5,0,2,-10,,4)\n",
       "1 spindle 1 S1000\n2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 dwell 1\n2 spindle 0 S1000\n"
       "2 stop 0\n2 rapid 0 0 5\n3 spindle -1 S1000\n3 rapid 0 0 2\n3 feed 0 0 -10 F100\n"
       "3 spindle 0 S1000\n3 stop 0\n3 rapid 0 0 5\n"},
      {"boring at the feed", "F100\nCYCLE89(5,0,2,-10,,1)\n",
       "2 rapid 0 0 2\n2 feed 0 0 -10 F100\n2 dwell 1\n2 feed 0 0 2 F100\n2 rapid 0 0 5\n"},
      // from (10, 20) at 90 degrees: holes at 25, 30 and 35; the tool comes from above
      {"a row of holes from its nearer end",
       "G0 X10 Y100 Z5 F100\nMCALL CYCLE81(5,0,2,-1)\nHOLES1(10,20,90,5,5,3)\nMCALL\n",
       "1 rapid 10 100 5\n3 rapid 10 35 5\n3 rapid 10 35 2\n3 feed 10 35 -1 F100\n"
       "3 rapid 10 35 5\n3 rapid 10 30 5\n3 rapid 10 30 2\n3 feed 10 30 -1 F100\n"
       "3 rapid 10 30 5\n3 rapid 10 25 5\n3 rapid 10 25 2\n3 feed 10 25 -1 F100\n"
       "3 rapid 10 25 5\n"},
      {"a circle of holes, all around and in steps",
       "G0 Z5\nHOLES2(10,0,5,90,0,2)\nHOLES2(0,0,5,0,90,2)\n",
       "1 rapid 0 0 5\n2 rapid 10 5 5\n2 rapid 10 -5 5\n3 rapid 5 0 5\n3 rapid 0 5 5\n"},
      {"under a rotation", "ROT Z90\nF100\nG0 X10 Y0 Z5\nCYCLE81(5,0,2,-1)\n",
       "3 rapid 0 10 5\n4 rapid 0 10 2\n4 feed 0 10 -1 F100\n4 rapid 0 10 5\n"},
  };
}

}  // namespace servomill::controllers::siemens
