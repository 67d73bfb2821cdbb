// Variables, jumps, structures, repetitions: [J].
#include "siemens_examples.h"

namespace servomill::controllers::siemens {

std::vector<Example> flow_examples() {
  return {
      {"R parameters", "R1=5 R2=R1*2+1\nG1 X=R1 Y=R2 F100\nX=-R1\nR[R1+1]=7\nX=R6\n",
       "2 feed 5 11 0 F100\n3 feed -5 11 0 F100\n5 feed 7 11 0 F100\n"},
      {"variables",
       "DEF REAL DEPTH=-2.5, LIST[3]=(1,2,3)\nDEF INT N\nN=LIST[2]*1.5\n"
       "G1 X=LIST[1] Y=N Z=DEPTH F100\n",
       "4 feed 2 5 -2.5 F100\n"},
      // [J] "Arithmetic functions": 3/4 = 0.75, 3 DIV 4 = 0; ATAN2(30.5, 80.1) = 20.8455
      {"arithmetic",
       "G1 X=3/4 Y=7 DIV 2 Z=7 MOD 4 F=100\nX=10+ATAN2(30.5,80.1) Y=SQRT(POT(3)+4*4)\n"
       "X=TRUNC(-2.7) Y=ROUND(2.5) Z=SIN(30)*MINVAL(4,8)\nX=(1+2)*-3 Y=BOUND(0,5,9)\n",
       "1 feed 0.75 3 3 F100\n2 feed 30.8455 5 3 F100\n3 feed -2 3 2 F100\n4 feed -9 5 2 F100\n"},
      {"branches",
       "R1=1\nIF R1==1\nG1 X1 F100\nELSE\nG1 X2 F100\nENDIF\nIF (R1>1) OR (R1<0)\nX3\n"
       "ENDIF\nIF NOT (R1==1)\nX4\nELSE\nX5\nENDIF\n",
       "3 feed 1 0 0 F100\n13 feed 5 0 0 F100\n"},
      {"FOR", "DEF INT I\nFOR I=1 TO 3\nG1 X=I*10 F100\nENDFOR\nFOR I=2 TO 1\nX0\nENDFOR\n",
       "3 feed 10 0 0 F100\n3 feed 20 0 0 F100\n3 feed 30 0 0 F100\n"},
      {"a counter of FOR assigned behind it", "FOR R1=1 TO 2\nENDFOR\nR1=7\nG1 X=R1 F100\n",
       "4 feed 7 0 0 F100\n"},
      {"WHILE and REPEAT UNTIL",
       "R1=0\nWHILE R1<2\nR1=R1+1\nG1 X=R1 F100\nENDWHILE\nREPEAT\nR1=R1-1\nY=R1\nUNTIL R1==0\n",
       "4 feed 1 0 0 F100\n4 feed 2 0 0 F100\n8 feed 2 1 0 F100\n8 feed 2 0 0 F100\n"},
      {"LOOP", "R1=0\nLOOP\nR1=R1+1\nIF R1>2 GOTOF OUT\nG1 X=R1 F100\nENDLOOP\nOUT:\nY1\n",
       "5 feed 1 0 0 F100\n5 feed 2 0 0 F100\n8 feed 2 1 0 F100\n"},
      {"jumps",
       "R1=0\nAGAIN: R1=R1+1\nG1 X=R1 F100\nIF R1<3 GOTOB AGAIN\nGOTOF N80\nN70 X9\nN80 Y1\n"
       "GOTO LAST\nX8\nLAST: Y2\nGOTOC NOWHERE\nY3\n",
       "3 feed 1 0 0 F100\n3 feed 2 0 0 F100\n3 feed 3 0 0 F100\n7 feed 3 1 0 F100\n"
       "10 feed 3 2 0 F100\n12 feed 3 3 0 F100\n"},
      // [J] "Program jumps to jump markers": more than one condition in a block
      {"several conditions in a block",
       "R1=2\nIF R1==1 GOTOF ONE IF R1==2 GOTOF TWO\nONE: G1 X1 F100\nTWO: G1 X2 F100\n",
       "4 feed 2 0 0 F100\n"},
      {"CASE",
       "R1=2\nAGAIN: CASE R1 OF 1 GOTOF ONE 2 GOTOF TWO DEFAULT GOTOF LAST\nONE: G1 X1 F100\n"
       "GOTOF LAST\nTWO: G1 X2 F100\nR1=1\nGOTOB AGAIN\nLAST: Y1\n",
       "5 feed 2 0 0 F100\n3 feed 1 0 0 F100\n8 feed 1 1 0 F100\n"},
      // [J] "Repeat program section": once, and twice more
      {"repetition of a part", "PART: G1 X=IC(1) F100\nY=IC(1)\nREPEAT PART P=2\nX0\n",
       "1 feed 1 0 0 F100\n2 feed 1 1 0 F100\n1 feed 2 1 0 F100\n2 feed 2 2 0 F100\n"
       "1 feed 3 2 0 F100\n2 feed 3 3 0 F100\n4 feed 0 3 0 F100\n"},
      {"repetition up to ENDLABEL", "PART: G1 X=IC(1) F100\nENDLABEL:\nY=IC(1)\nREPEAT PART\n",
       "1 feed 1 0 0 F100\n3 feed 1 1 0 F100\n1 feed 2 1 0 F100\n"},
      {"ENDLABEL of a part further on", "PART: G1 X=IC(1) F100\nREPEAT PART P=2\nX0\nENDLABEL:\n",
       "1 feed 1 0 0 F100\n1 feed 2 0 0 F100\n1 feed 3 0 0 F100\n3 feed 0 0 0 F100\n"},
      {"repetition of a part behind it", "REPEAT PART\nG0 Z5\nPART: G1 X=IC(1) F100\nENDLABEL:\n",
       "3 feed 1 0 0 F100\n2 rapid 1 0 5\n3 feed 2 0 5 F100\n"},
      {"repetition of a block and between labels",
       "ONE: G1 X=IC(1) F100\nTWO: Y=IC(1)\nREPEATB ONE P=2\nREPEAT ONE TWO P1\nX0\n",
       "1 feed 1 0 0 F100\n2 feed 1 1 0 F100\n1 feed 2 1 0 F100\n1 feed 3 1 0 F100\n"
       "1 feed 4 1 0 F100\n2 feed 4 2 0 F100\n5 feed 0 2 0 F100\n"},
  };
}

}  // namespace servomill::controllers::siemens
