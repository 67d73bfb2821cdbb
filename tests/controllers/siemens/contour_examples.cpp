// Corners of contours and the radius of the tool (5 mm).
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> contour_examples() {
  return {
      {"rounding", "G1 X10 F100 RND=2\nY10\n",
       "1 feed 8 0 0 F100\n1 arc 10 2 0 about 8 2 turns 1 F100\n2 feed 10 10 0 F100\n"},
      // bit 0 of MD20201 = 1: the corner belongs to the block before it
      {"functions behind a rounding", "G1 X10 F100 RND=2\nM8\nM0\nY10 M3 F50\n",
       "1 feed 8 0 0 F100\n1 arc 10 2 0 about 8 2 turns 1 F100\n2 coolant 2\n3 stop 0\n"
       "4 spindle 1 S1000\n4 feed 10 10 0 F50\n"},
      // FRC is in mm per revolution, too: 0.05 mm at 1000 rev/min
      {"rounding with a feed of its own per revolution", "G95 G1 X10 F0.1 RND=2 FRC=0.05\nY10\n",
       "1 feed 8 0 0 F100\n1 arc 10 2 0 about 8 2 turns 1 F50\n2 feed 10 10 0 F100\n"},
      // CHR along each side, CHF the length of the chamfer
      {"chamfers", "G1 X10 F100 CHR=2\nY10 CHF=2.828427125 FRC=50\nX0\n",
       "1 feed 8 0 0 F100\n1 feed 10 2 0 F100\n2 feed 10 8 0 F100\n2 feed 8 10 0 F50\n"
       "3 feed 0 10 0 F100\n"},
      // [F] "Tool radius compensation": perpendicular to the contour at its start, an arc about the
      // corner (G450)
      {"outside corner", "G41 G1 X10 Y10 F100\nY20\nX20\nG40 X30 Y30\n",
       "1 feed 5 10 0 F100\n2 feed 5 20 0 F100\n3 arc 10 25 0 about 10 20 turns -1 F100\n"
       "3 feed 20 25 0 F100\n4 feed 30 30 0 F100\n"},
      {"inside corner", "G42 G1 X10 Y0 F100\nY20\nX30\nG40 Y40\n",
       "1 feed 15 0 0 F100\n2 feed 15 15 0 F100\n3 feed 30 15 0 F100\n4 feed 30 40 0 F100\n"},
      // [F] "Feedrate optimization": CFC, half of the radius, half of F
      {"feed of the contour", "G41 G1 X10 Y0 F100\nX20\nG3 X30 Y10 I0 J10\nG40 G1 X40 Y10\n",
       "1 feed 10 5 0 F100\n2 feed 20 5 0 F100\n3 arc 25 10 0 about 20 10 turns 1 F50\n"
       "4 feed 40 10 0 F100\n"},
      {"feed of the tool centre",
       "CFTCP G41 G1 X10 Y0 F100\nX20\nG3 X30 Y10 I0 J10\nG40 G1 X40 Y10\n",
       "1 feed 10 5 0 F100\n2 feed 20 5 0 F100\n3 arc 25 10 0 about 20 10 turns 1 F100\n"
       "4 feed 40 10 0 F100\n"},
      // the first move in the plane behind G40 returns to the contour in both axes
      {"G40 in a block of its own", "G41 G1 X10 Y0 F100\nX20\nG40\nG0 Z5\nX30\n",
       "1 feed 10 5 0 F100\n2 feed 20 5 0 F100\n4 rapid 20 5 5\n5 rapid 30 0 5\n"},
      {"mirrored", "MIRROR X0\nG41 G1 X10 Y10 F100\nY20\nX20\nG40 X30 Y30\n",
       "2 feed -5 10 0 F100\n3 feed -5 20 0 F100\n4 arc -10 25 0 about -10 20 turns 1 F100\n"
       "4 feed -20 25 0 F100\n5 feed -30 30 0 F100\n"},
  };
}

}  // namespace servomill::controllers::siemens
