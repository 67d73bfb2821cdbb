// Labels, jumps, Q parameters. Sources as in line_examples.cpp.
#include "moves_text.h"

namespace servomill::controllers::conversational {

std::vector<Example> flow_examples() {
  return {
      {"subprogram", "L F100\nCALL LBL 1\nL X+1\nCALL LBL 1\nL M30\nLBL 1\nL IY+2\nLBL 0\n",
       "7 feed 0 2 0 F100\n3 feed 1 2 0 F100\n7 feed 1 4 0 F100\n"},
      {"a repeat requires a number calls once",
       "LBL 1\nL IX+1 F100\nLBL 0\nCALL LBL 1 REP\nL IY+1\n",
       "2 feed 1 0 0 F100\n2 feed 2 0 0 F100\n5 feed 2 1 0 F100\n"},
      // the section runs once, and twice more
      {"program section repeat", "LBL 5\nL IX+10 F100\nCALL LBL 5 REP 2/2\nL Y+1\n",
       "2 feed 10 0 0 F100\n2 feed 20 0 0 F100\n2 feed 30 0 0 F100\n4 feed 30 1 0 F100\n"},
      {"repeats in each other",
       "L F100\nLBL 1\nLBL 2\nL IX+1\nCALL LBL 2 REP1\nL IY+1\nCALL LBL 1 REP1\n",
       "4 feed 1 0 0 F100\n4 feed 2 0 0 F100\n6 feed 2 1 0 F100\n"
       "4 feed 3 1 0 F100\n4 feed 4 1 0 F100\n6 feed 4 2 0 F100\n"},
      {"names of labels", "CALL LBL \"UP CAN\"\nL M2\nLBL \"UP CAN\"\nL X+3 F50\nLBL 0\n",
       "4 feed 3 0 0 F50\n"},
      {"FN 0 to FN 5",
       "FN 0: Q1 = +10\nFN 1: Q2 = +Q1 + -5\nFN 2: Q3 = +10 - +5\nFN 3: Q4 = +3 * +3\n"
       "FN 4: Q5 = +8 DIV +Q2\nFN 5: Q6 = SQRT 16\nL X+Q2 Y+Q3 Z+Q4 F100\nL X+Q5 Y-Q6\n",
       "7 feed 5 5 9 F100\n8 feed 1.6 -4 9 F100\n"},
      {"FN 6 to FN 8 and FN 13",
       "FN6: Q1 = SIN+30\nFN7: Q2 = COS+60\nFN 8: Q3 = +3 LEN +4\nFN 13: Q4 = +10 ANG -10\n"
       "L X+Q1 Y+Q2 Z+Q3 FQ4\n",
       "5 feed 0.5 0.5 5 F135\n"},
      {"FN without a blank behind its colon", "FN 0:Q1=7\nFN1:Q2=+Q1 + +1\nL X+Q1 Y+Q2 FMAX\n",
       "3 rapid 7 8 0\n"},
      // multiplication before addition: 5 * 3 + 2 * 10 = 35. iTNC 530 ISO (60642x-04) p. 305
      {"order of operations", "Q1 = 5 * 3 + 2 * 10\nQ2 = SQ 10 - 3^3\nL X+Q1 Y+Q2 F100\n",
       "3 feed 35 73 0 F100\n"},
      {"functions of formulas",
       "Q1 = ( 2 + SQRT 9 ) * INT 2.7\nQ2 = NEG ABS -4 + FRAC 1.25\nQ3 = 400 % 360\n"
       "Q4 = ATAN 1 / 45\nQ5 = ASIN 0.5 + ACOS 0.5\nL X+Q1 Y+Q2 Z+Q3 F100\nL X+Q4 Y+Q5\n",
       "6 feed 10 -3.75 40 F100\n7 feed 1 90 40 F100\n"},
      {"jumps",
       "Q1 = 0\nLBL 1\nQ1 = Q1 + 1\nL X+Q1 F100\nFN 12: IF +Q1 LT +3 GOTO LBL 1\n"
       "FN 9: IF +0 EQU +0 GOTO LBL \"OUT\"\nL X+99\nLBL \"OUT\"\nFN 10: IF +Q1 NE +3 GOTO LBL 1\n"
       "FN 11: IF +Q1 GT +3 GOTO LBL 1\nL Y+1\n",
       "4 feed 1 0 0 F100\n4 feed 2 0 0 F100\n4 feed 3 0 0 F100\n11 feed 3 1 0 F100\n"},
      {"radius and length of the tool", "L X+Q108 Y-Q108 Z+Q114 FMAX\n", "1 rapid 5 -5 100\n"},
      // PI with all digits: 3.1415926...
      {"pi", "Q1 = PI * 10\nL X+Q1 FMAX\n", "2 rapid 31.4159 0 0\n"},
  };
}

}  // namespace servomill::controllers::conversational
