// Frames: [F] "Coordinate transformations (frames)".
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> frame_examples() {
  return {
      {"shift", "TRANS X10 Y5\nG1 X0 Y0 F100\nATRANS X1\nX0\nTRANS\nX0\n",
       "2 feed 10 5 0 F100\n4 feed 11 5 0 F100\n6 feed 0 5 0 F100\n"},
      {"rotation in the plane", "ROT RPL=90\nG1 X10 Y0 F100\nG2 X20 Y0 CR=5\nROT\nG1 X1 Y1\n",
       "2 feed 0 10 0 F100\n3 arc 0 20 0 about 0 15 turns -1 F100\n5 feed 1 1 0 F100\n"},
      // Y stays in the program's coordinates, so both axes of the work system move
      {"one axis under a rotation", "G1 X10 Y0 F100\nROT Z45\nX14.142135624\n",
       "1 feed 10 0 0 F100\n3 feed 15 5 0 F100\n"},
      {"mirror image", "MIRROR X0\nG1 X10 Y0 F100\nG3 X20 Y10 I0 J10\n",
       "2 feed -10 0 0 F100\n3 arc -20 10 0 about -10 10 turns -1 F100\n"},
      {"scale", "SCALE X2 Y2\nG1 X5 F100\nG3 X15 Y10 CR=10\n",
       "2 feed 10 0 0 F100\n3 arc 30 20 0 about 10 20 turns 1 F100\n"},
      {"shift before rotation", "TRANS X10\nAROT Z90\nG1 X5 Y0 F100\n", "3 feed 10 5 0 F100\n"},
      {"rotation before shift", "ROT Z90\nATRANS X10\nG1 X5 Y0 F100\n", "3 feed 0 15 0 F100\n"},
      // Y of the program is Z of the machine, Z of the program is -Y
      {"rotation in space", "ROT X90\nG1 X1 Y2 Z3 F100\n", "2 feed 1 -3 2 F100\n"},
      {"increments", "ROT Z90\nG91 G1 X10 F100\nY5\n", "2 feed 0 10 0 F100\n3 feed -5 10 0 F100\n"},
      // a shift of Y leaves increments of X as they are
      {"increments behind a shift of another axis", "TRANS Y10\nG91 G1 X5 F100\nG90 Y1\nG91 Y1\n",
       "2 feed 5 0 0 F100\n3 feed 5 11 0 F100\n4 feed 5 12 0 F100\n"},
      {"rotary axes", "TRANS C30\nAMIRROR C0\nG0 C10\n", "3 rapid 0 0 0 C20\n"},
      // ATRANS adds in the mirrored coordinates: -(30 + 10)
      {"rotary axes, mirrored before the shift", "MIRROR C0\nATRANS C30\nG0 C10\n",
       "3 rapid 0 0 0 C-40\n"},
      {"work offsets", "G505\nG0 X1\nG500\nX2 Z3\nG54\nX3\n",
       "2 rapid 1 0 0\n4 rapid 2 0 3\n6 rapid 3 0 3\n"},
  };
}

}  // namespace servomill::controllers::siemens
