// Circles, polar coordinates. Sources as in line_examples.cpp; [410] is the TNC 410 user's manual,
// [430] that of the TNC 426/430.
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> circle_examples() {
  return {
      // [410] p. 79
      {"quarter and full circle",
       "L X+45 Y+25 FMAX\nCC X+25 Y+25\nC X+25 Y+45 DR+ F200\nC X+25 Y+45 DR-\n",
       "1 rapid 45 25 0\n3 arc 25 45 0 about 25 25 turns 1 F200\n"
       "4 arc 25 45 0 about 25 25 turns -1 F200\n"},
      {"pole at the position and by increments",
       "L X+5 FMAX\nCC\nL X+15 FMAX\nC X+5 Y+10 DR+ F100\nCC IX-10 IY+0\nC X-15 Y+10 DR+\n",
       "1 rapid 5 0 0\n3 rapid 15 0 0\n4 arc 5 10 0 about 5 0 turns 1 F100\n"
       "6 arc -15 10 0 about -5 10 turns 1 F100\n"},
      {"incremental end", "CC X+10 Y+0\nC IX+20 IY+0 DR- F100\n",
       "2 arc 20 0 0 about 10 0 turns -1 F100\n"},
      // lowest point of a circle in ZX to its right
      {"circle in ZX", "CC X+0 Z+10\nC X+10 Z+10 DR- F100\n",
       "2 arc 10 0 10 about 0 10 turns -1 F100\n"},
      // [430] p. 153: total angle with the revolutions
      {"helix", "L X+10 FMAX\nCC X+0 Y+0\nCP IPA-1800 IZ-5 DR- F100\nCP IPA+450 IZ+5 DR+\n",
       "1 rapid 10 0 0\n3 arc 10 0 -5 about 0 0 turns -5 F100\n"
       "4 arc 0 10 0 about 0 0 turns 2 F100\n"},
      {"CP to an angle", "L X+10 FMAX\nCC X+0 Y+0\nCP PA+90 DR- F100\n",
       "1 rapid 10 0 0\n3 arc 0 10 0 about 0 0 turns -1 F100\n"},
      // [530] p. 229: a hexagon side about the pole, from memory of the form
      {"LP", "CC X+45 Y+25\nLP PR+30 PA+0 R0 F300\nLP PA+60\nLP IPA+60\nLP PA+180\n",
       "2 feed 75 25 0 F300\n3 feed 60 50.9808 0 F300\n4 feed 30 50.9808 0 F300\n5 feed 15 25 0 "
       "F300\n"},
      // [530] p. 223: the sign of R chooses the arc. From X40 Y40 to X70 Y40 with R20: half chord
      // 15,
      // height sqrt(400 - 225) = 13.2288
      {"CR, the small arc", "L X+40 Y+40 FMAX\nCR X+70 Y+40 R+20 DR- F200\n",
       "1 rapid 40 40 0\n2 arc 70 40 0 about 55 26.7712 turns -1 F200\n"},
      {"CR, the large arc", "L X+40 Y+40 FMAX\nCR X+70 Y+40 R-20 DR- F200\nCR X+40 Y+40 R-20 DR+\n",
       "1 rapid 40 40 0\n2 arc 70 40 0 about 55 53.2288 turns -1 F200\n"
       "3 arc 40 40 0 about 55 53.2288 turns 1 F200\n"},
      {"CR, half a circle", "CR X+20 R+10 DR+ F100\n", "1 arc 20 0 0 about 10 0 turns 1 F100\n"},
      // [530] p. 225: from X25 Y30 along (25, 5) to X45 Y20. Chord c = (20, -10), left of the
      // direction
      // n = (-5, 25) / sqrt(650); c.n = -350 / sqrt(650), so the centre is the begin + 500 / (2
      // c.n) n
      // = (25, 30) - 500 * 650 / 700 * (-5, 25) / 650 = (28.5714, 12.1429)
      {"CT of the manual", "L X+0 Y+25 R0 F300 M3\nL X+25 Y+30\nCT X+45 Y+20\nL Y+0\n",
       "1 spindle 1 S1000\n1 feed 0 25 0 F300\n2 feed 25 30 0 F300\n"
       "3 arc 45 20 0 about 28.5714 12.1429 turns -1 F300\n4 feed 45 0 0 F300\n"},
      {"CT behind a circle and straight ahead",
       "CC X+0 Y+10\nC X+10 Y+10 DR+ F100\nCT X+10 Y+20\nCT X+0 Y+20\n",
       "2 arc 10 10 0 about 0 10 turns 1 F100\n3 feed 10 20 0 F100\n"
       "4 arc 0 20 0 about 5 20 turns 1 F100\n"},
      // [530] (60642x) p. 249: CTP PR+30 PA+30 about CC X+40 Y+35 behind LP PR+25 PA+120. Points:
      // (27.5, 56.6506) from (0, 35), and (65.9808, 50): direction d = (27.5, 21.6506)
      {"CTP of the manual",
       "CC X+40 Y+35\nL X+0 Y+35 R0 F250 M3\nLP PR+25 PA+120\nCTP PR+30 PA+30\nL Y+0\n",
       "2 spindle 1 S1000\n2 feed 0 35 0 F250\n3 feed 27.5 56.6506 0 F250\n"
       "4 arc 65.9808 50 0 about 43.7482 36.0126 turns -1 F250\n5 feed 65.9808 0 0 F250\n"},
  };
}

}  // namespace servomill::controllers::conversational
