// Circles and helices. Datum X200 Y250 Z-100; Z counts from -50 with tool 1.
#include "heidenhain_examples.h"

namespace servomill::controllers {

std::vector<HeidenhainExample> heidenhain_circle_examples() {
  std::vector<HeidenhainExample> all = {
      // DR+ is counter-clockwise. [410] p. 79
      {"quarter of a circle", "L X+45 Y+25 F200\nCC X+25 Y+25\nC X+25 Y+45 DR+\n",
       "1 feed X245 Y275 (Z?) F200\n3 arc X225 Y295 (Z?) about X225 Y275 turns 1 F200\n"},
      {"three quarters of a circle", "L X+45 Y+25 F200\nCC X+25 Y+25\nC X+25 Y+45 DR- F100\n",
       "1 feed X245 Y275 (Z?) F200\n3 arc X225 Y295 (Z?) about X225 Y275 turns -1 F100\n"},
      // Example of [410] p. 79: equal ends make a full circle
      {"full circle", "CC X+25 Y+25\nL X+45 Y+25 F200\nC X+45 Y+25 DR+\n",
       "2 feed X245 Y275 (Z?) F200\n3 arc X245 Y275 (Z?) about X225 Y275 turns 1 F200\n"},
      // A coordinate left out keeps its value: half a circle
      {"one coordinate", "CC X+10 Y+0\nC X+20 DR- F100\n",
       "2 arc X220 Y250 (Z?) about X210 Y250 turns -1 F100\n"},
      // The increment of CC counts from the last position, not from the pole before. [PIL] p. 8
      {"incremental pole", "CC X+100 Y+100\nL X+10 Y+0 F100\nCC IX-10 IY+0\nC X+0 Y+10 DR+\n",
       "2 feed X210 Y250 (Z?) F100\n4 arc X200 Y260 (Z?) about X200 Y250 turns 1 F100\n"},
      // CC alone takes the last position as the pole
      {"pole at the position", "CC X+100 Y+100\nL X+5 Y+0 F100\nCC\nL X+15\nC X+5 Y+10 DR+\n",
       "2 feed X205 Y250 (Z?) F100\n4 feed X215 (Y250) (Z?) F100\n"
       "5 arc X205 Y260 (Z?) about X205 Y250 turns 1 F100\n"},
      // The axes of CC choose the plane: from the lowest point of a circle in ZX to its right. DR+
      // turns from Z to X, seen against Y, so that it takes three quarters
      {"circle in ZX", "L X+0 Z+0 FMAX\nCC X+0 Z+10\nC X+10 Z+10 DR- F100\nC X+0 Z+0 DR+\n",
       "1 rapid X200 (Y250) Z-50\n3 arc X210 (Y250) Z-40 about X200 Z-40 turns -1 F100\n"
       "4 arc X200 (Y250) Z-50 about X200 Z-40 turns 1 F100\n"},
      // Total angle of a helix with the number of revolutions. [430] p. 153
      {"helix", "L X+10 Y+0 FMAX\nL Z+0 F50\nCC X+0 Y+0\nCP IPA-1800 IZ-5 DR- F100\n",
       "1 rapid X210 Y250 (Z?)\n2 feed (X210) (Y250) Z-50 F50\n"
       "4 arc X210 Y250 Z-55 about X200 Y250 turns -5 F100\n"},
      {"helix to a height", "L X+10 Y+0 Z+0 FMAX\nCC X+0 Y+0\nCP IPA+450 Z+3 DR+ F100\n",
       "1 rapid X210 Y250 Z-50\n3 arc X200 Y260 Z-47 about X200 Y250 turns 2 F100\n"},
      // Polar angles count from X in XY, from Y in YZ, from Z in ZX. [PIL] p. 8
      {"polar angle in XY", "L X+10 Y+0 FMAX\nCC X+0 Y+0\nCP PA+90 DR- F100\n",
       "1 rapid X210 Y250 (Z?)\n3 arc X200 Y260 (Z?) about X200 Y250 turns -1 F100\n"},
      {"polar angle in YZ", "L Y+10 Z+0 FMAX\nCC Y+0 Z+0\nCP PA+90 DR+ F100\n",
       "1 rapid (X200) Y260 Z-50\n3 arc (X200) Y250 Z-40 about Y250 Z-50 turns 1 F100\n"},
      {"polar angle in ZX", "L X+0 Z+10 FMAX\nCC X+0 Z+0\nCP PA+90 DR+ F100\n",
       "1 rapid X200 (Y250) Z-40\n3 arc X210 (Y250) Z-50 about X200 Z-50 turns 1 F100\n"},
      // From the lowest point of a circle in ZX a quarter towards -X: from Z- by DR+ to X-
      {"incremental angle in ZX", "L X+0 Z+0 FMAX\nCC X+0 Z+10\nCP IPA+90 DR+ F100\n",
       "1 rapid X200 (Y250) Z-50\n3 arc X190 (Y250) Z-40 about X200 Z-40 turns 1 F100\n"},
      // M3 before the arc, M9 after it
      {"M functions on a circle", "CC X+10 Y+0\nC X+20 Y+0 DR+ F100 M3\nC X+0 Y+0 DR+ M9\n",
       "2 spindle 1 S1000\n2 arc X220 Y250 (Z?) about X210 Y250 turns 1 F100\n"
       "3 arc X200 Y250 (Z?) about X210 Y250 turns 1 F100\n3 coolant 0\n"},
  };
  for (auto& example : all) example.setup = heidenhain_example_setup();
  return all;
}

}  // namespace servomill::controllers
