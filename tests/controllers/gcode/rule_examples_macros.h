/// Examples of custom macro B. Private to rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

inline std::vector<RuleExample> macro_examples() {
  const std::string vacant =
                        "Fanuc B-63944EN, undefined variables, from memory; Mitsubishi M700V, "
                        "Programming manual, 13.5 (the same table)",
                    haas365 = "Haas 96-8000, June 1999, p. 365",
                    haas374 = "Haas 96-8000, June 1999, p. 374",
                    haas376 = "Haas 96-8000, June 1999, p. 376",
                    fanuc278 = "Fanuc B-63684EN/01 p. 278",
                    memory = "Fanuc B-63944EN, custom macro, from memory";
  using enum ReaderRule;
  return {
      // a vacant variable leaves its word out, is 0 in a sum, and is not 0 for EQ
      {macro_statement, Reader::fanuc,
       "G0 Y3.\n#1=5.\n#2=#0\nX#1 Y#2\nIF[#2EQ0]GOTO10\nX[#2+7.] Y-#2\nN10 IF[#2EQ#0]GOTO20\n"
       "Y99.\nN20 M2\n",
       "R 0 3 0 | R 5 3 0 | R 7 3 0", "p.nc:2:1", vacant},
      // ... and 0 is not vacant; GE, LE, GT and LT take a vacant one for 0
      {macro_statement, Reader::any,
       "#1=0\nIF[#1EQ#0]GOTO9\nIF[#1NE#0]THEN #2=1.\nIF[#0GE0]THEN #3=2.\nIF[#0GT0]THEN #3=3.\n"
       "G0 X#2 Y#3\nN9 M2\n",
       "R 1 2 0", "p.nc:1:1", vacant},
      // arithmetic without brackets, which LinuxCNC refuses; #<a-1> is a name of LinuxCNC's
      {macro_statement, Reader::any, "#1=2.\n#2=#1+3.\nG0 X#2\nM2\n", "R 5 0 0", "p.nc:1:1",
       memory},
      {macro_statement, Reader::fanuc, "#1=7\n#2=#1 MOD 4\nG0 X#2\nM2\n", "R 3 0 0", "p.nc:1:1",
       memory},
      {macro_statement, Reader::haas,
       "#1=0\nWHILE[#1LT2]DO1\n#2=0\nWHILE [#2 LT 2] DO2\nG0 X#1 Y#2\n#2=#2+1\nEND2\n#1=#1+1\n"
       "END1\nM2\n",
       "R 0 1 0 | R 1 0 0 | R 1 1 0", "p.nc:1:1", haas376},
      // a loop that is never entered, and one that is left by GOTO
      {macro_statement, Reader::fanuc,
       "WHILE[1GT2]DO1\nG0 X99.\nEND1\n#1=0\nDO2\n#1=#1+1.\nIF[#1GE3.]GOTO5\nG0 X#1\nEND2\n"
       "N5 G0 Y#1\nM2\n",
       "R 1 0 0 | R 2 0 0 | R 2 3 0", "p.nc:1:1", memory},
      {macro_statement, Reader::any,
       "#7=2.4\nGOTO#7\nN1 G0 X1.\nN2 G0 X2.\nGOTO[#7+0.6]\nX99.\nN3 Y-[#7+.1]\nM2\n",
       "R 2 0 0 | R 2 -2.5 0", "p.nc:1:1", "haascnc.com, computed branch (GOTO rounds)"},
      // the block behind the jump is looked for first, then that from the beginning
      {macro_statement, Reader::fanuc,
       "G0\n#1=0\nN5 #1=#1+1\nIF[#1EQ1]GOTO5\nX9.\nN5 Y1.\nIF[#1EQ2]GOTO9\nGOTO 5\nN9 M2\n",
       "R 0 1 0 | R 9 1 0", "p.nc:2:1", memory},
      // indirect, and several levels of brackets
      {macro_statement, Reader::haas,
       "#19=3\nWHILE[#19GT0]DO1\n#19=#19-1\n#[101+#19]=#19*[2.+[1.-#0]]\nEND1\n"
       "G0 X#103 Y#[100+2] Z#101\nM2\n",
       "R 6 3 0", "p.nc:1:1", haas376},
      // the multiplication first; bits; towards zero and away from it
      {macro_statement, Reader::fanuc,
       "#1=1.+2.*3.-8./4.\n#2=[12AND10]+[12OR3]+[12XOR10]\n#3=FIX[-1.2]+10.*FUP[-1.2]\n"
       "G0 X#1 Y#2 Z#3\nM2\n",
       "R 5 29 -21", "p.nc:1:1", memory},
      {macro_statement, Reader::fanuc,
       "#1=SIN[30.]+COS[60.]+TAN[45.]\n#2=SQRT[ABS[-16.]]+ROUND[2.5]+LN[EXP[1.]]\n"
       "#3=ATAN[1.]/[-1.]+ASIN[1.]+ACOS[0]+POW[2.,3.]\nG0 X#1 Y#2 Z#3\nM2\n",
       "R 2 8 323", "p.nc:1:1", memory},
      // codes of variables, and a program that M98 calls has the variables of its caller
      {macro_statement, Reader::haas,
       "#1=4.\n#2=91\nM98 P100 L2\nG#2 G0 Y#1\nY#1\nM2\nO100\n#1=#1+1\nM99\n", "R 0 6 0 | R 0 12 0",
       "p.nc:1:1", haas365},
      // from left to right; what follows WHILE runs in every turn
      {several_statements, Reader::haas, "#1=1. #2=#1+2.\nG0 X#1 Y#2\nGOTO9\nN9 M2\n", "R 1 3 0",
       "p.nc:1:7", "none found"},
      {several_statements, Reader::any,
       "#1=0\n#2=-2.5\nWHILE[#1GT#2]DO1 #1=#1-1. IF[#1LT#2]THEN #1=#2\nG0 Z#1\nEND1\nM2\n",
       "R 0 0 -1 | R 0 0 -2 | R 0 0 -2.5", "p.nc:3:18", "none found"},
      {variable_increment, Reader::haas, "G20\n#1=.123456\nG0 X#1\nIF[#1GT0]GOTO9\nN9 M2\n",
       "R 3.1369 0 0", "p.nc:3:4", "haascnc.com, address substitution (.1235 inch)"},
      {variable_increment, Reader::any, "#1=.123456\nG0 X-#1\nIF[#1GT0]GOTO9\nN9 M2\n",
       "R -0.123 0 0", "p.nc:2:4", "haascnc.com, address substitution"},
      // 1.00333 twice: 2.0067, or 2.0066 of what was rounded before
      {variable_increment, Reader::haas,
       "G20\n#1=1.00333\nG0 X[#1+#1]\nX[ROUND[#1]+ROUND[#1]]\nA[#1+#1]\nA[ROUND[#1]+ROUND[#1]]\n"
       "IF[#1GT0]GOTO9\nN9 M2\n",
       "R 50.97018 0 0 | R 50.96764 0 0 | R 50.96764 0 0 a2.007 b0 c0 | R 50.96764 0 0 a2.006 b0 "
       "c0",
       "p.nc:3:4", haas374},
      // #1 #2 #4 of A B I, #7 of the second I and of D, the later of which counts; #5 is vacant
      {macro_call, Reader::fanuc,
       "G0 Y9.\nG65 A1.0 B2.0 I-3.0 I4.0 D5.0 P1000\nM2\nO1000\nX#1 Z#4\nX#7 Y#5\nX#2\nM99\n",
       "R 0 9 0 | R 1 9 -3 | R 5 9 -3 | R 2 9 -3", "p.nc:2:1", fanuc278},
      {macro_call, Reader::any,
       "G65 P10 X1. Y2. Z3.\nM2\nO10\nG65 P11 I4. J5. K6. I7. J8.\nG0 X#24 Y#25 Z#26\nM99\n"
       "O11\nG0 X#4 Y#5 Z#6\nX#7 Y#8 Z#9\nM99\n",
       "R 4 5 6 | R 7 8 6 | R 1 2 3", "p.nc:1:1", fanuc278},
      {macro_call, Reader::haas, "#1=9.\nG65 P1000 A1.\nG0 X#1\nM2\nO1000\nG0 X#1\n#1=5.\nM99\n",
       "R 1 0 0 | R 9 0 0", "p.nc:2:1", haas365},
      // the arguments are set on the first repetition only
      {macro_call, Reader::haas, "G65 P1000 L3 A0\nM2\nO1000\n#1=#1+1.\nG0 X#1\nM99\n",
       "R 1 0 0 | R 2 0 0 | R 3 0 0", "p.nc:1:1", haas365},
      {modal_macro_call, Reader::fanuc,
       "G66 P100 R-2.\nG0 X10.\nM8\nY10.\nG67\nX0.\nM2\nO100\nG91 G0 Z#18\nG90 Z0.\nM99\n",
       "R 10 0 0 | R 10 0 -2 | R 10 0 0 | C2 | R 10 10 0 | R 10 10 -2 | R 10 10 0 | R 0 10 0 | C0",
       "p.nc:1:1", "Fanuc B-63944EN, modal call, from memory"},
      // within the program of the second G66 that of the first is called
      {modal_macro_call, Reader::any,
       "G66 P100\nG90 G0 X1.\nG66 P200\nX2.\nG67\nG67\nX3.\nM2\nO100\nG91 Y1.\nG90\nM99\nO200\n"
       "G91 Z1.\nG91 Z1.\nG90\nM99\n",
       "R 1 0 0 | R 1 1 0 | R 2 1 0 | R 2 1 1 | R 2 2 1 | R 2 2 2 | R 2 3 2 | R 3 3 2", "p.nc:1:1",
       "Mitsubishi M700V, Programming manual, 13.5"},
      {macro_output, Reader::fanuc,
       "POPEN\n#3001=0\nDPRNT[X#1[53]*Y]\nPCLOS\n#1101=1\nG0 X1.\nM2\n", "R 1 0 0", "p.nc:1:1",
       "Fanuc B-63944EN, external output commands, from memory"},
  };
}

}  // namespace servomill::controllers
