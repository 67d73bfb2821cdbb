// Arcs and polar coordinates.
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> arc_examples() {
  return {
      {"centre from the start", "G1 X10 F100\nG3 X0 Y10 I-10 J0\n",
       "1 feed 10 0 0 F100\n2 arc 0 10 0 about 0 0 turns 1 F100\n"},
      {"centre from the origin", "G1 X10 F100\nG2 X0 Y-10 I=AC(0) J=AC(0)\nX-10 Y0 J=AC(0)\n",
       "1 feed 10 0 0 F100\n2 arc 0 -10 0 about 0 0 turns -1 F100\n"
       "3 arc -10 0 0 about 0 0 turns -1 F100\n"},
      // to the left of the chord for up to a semicircle counter-clockwise
      {"radius", "G3 X10 Y10 CR=10 F100\nG0 X0 Y0\nG3 X10 Y10 CR=-10\n",
       "1 arc 10 10 0 about 0 10 turns 1 F100\n2 rapid 0 0 0\n"
       "3 arc 10 10 0 about 10 0 turns 1 F100\n"},
      {"a semicircle whose radius is rounded", "G2 X20.001 Y0 CR=10 F100\n",
       "1 arc 20.001 0 0 about 10.0005 0 turns -1 F100\n"},
      {"full circle", "G2 I10 J0 F100\n", "1 arc 0 0 0 about 10 0 turns -1 F100\n"},
      {"angle of the arc", "G2 I10 J0 AR=90 F100\nG0 X0 Y0\nG3 X0 Y20 AR=180\n",
       "1 arc 10 10 0 about 10 0 turns -1 F100\n2 rapid 0 0 0\n"
       "3 arc 0 20 0 about 0 10 turns 1 F100\n"},
      // up over (10, 10): clockwise
      {"through a point", "CIP X20 Y0 I1=10 J1=10 F100\n",
       "1 arc 20 0 0 about 10 0 turns -1 F100\n"},
      // in the plane ZX, whose first axis is Z
      {"through a point in another plane", "CIP X20 Z0 I1=10 K1=10 F100\n",
       "1 arc 20 0 0 about 10 0 turns 1 F100\n"},
      {"through a point by increments", "G91 CIP X20 Y0 I1=10 J1=10 F100\n",
       "1 arc 20 0 0 about 10 0 turns -1 F100\n"},
      {"tangential to a line and to an arc", "G1 X10 F100\nCT X20 Y10\nX10 Y20\n",
       "1 feed 10 0 0 F100\n2 arc 20 10 0 about 10 10 turns 1 F100\n"
       "3 arc 10 20 0 about 10 10 turns 1 F100\n"},
      // a full circle and two more
      {"helix", "G3 X0 Y0 Z-10 I10 J0 TURN=2 F100\n", "1 arc 0 0 -10 about 10 0 turns 3 F100\n"},
      {"other planes", "G18 G2 X20 Z0 I10 K0 F100\nG19 G3 Y10 Z10 CR=10\nG17\n",
       "1 arc 20 0 0 about 10 0 turns -1 F100\n2 arc 20 10 10 about 0 10 turns 1 F100\n"},
      // [F] "Travel commands with polar coordinates"
      {"polar coordinates", "G111 X10 Y10\nG1 RP=5 AP=0 F100\nAP=90\nG3 AP=180\nG0 AP=IC(90)\n",
       "2 feed 15 10 0 F100\n3 feed 10 15 0 F100\n4 arc 5 10 0 about 10 10 turns 1 F100\n"
       "5 rapid 10 5 0\n"},
      // NC programming 12/2019 (6FC5398-2EP40-0BA0) p. 175: from the angle programmed last
      {"arcs by increments of the angle",
       "G111 X0 Y0\nG1 RP=10 AP=0 F100\nG3 AP=IC(90)\nAP=IC(90)\n",
       "2 feed 10 0 0 F100\n3 arc 0 10 0 about 0 0 turns 1 F100\n"
       "4 arc -10 0 0 about 0 0 turns 1 F100\n"},
      {"poles from the position and from the last pole",
       "G110 X5\nG1 RP=3 AP=90 F100\nG112 Y10\nAP=0\nG110 RP=2 AP=180\nAP=90 RP=1\n",
       "2 feed 5 3 0 F100\n4 feed 8 10 0 F100\n6 feed 6 11 0 F100\n"},
  };
}

}  // namespace servomill::controllers::siemens
