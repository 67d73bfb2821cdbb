// Programs for other controls than LinuxCNC: what they say, and what they refuse to say.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::dialect_test {
namespace {

const std::string kProgram =
    "(a plate)\n"
    "G21 G90 G54 G17\n"
    "T1 M6\n"
    "S12000 M3\n"
    "G43 H1\n"
    "G0 X10 Y20 Z5\n"
    "M8\n"
    "G1 Z-1 F300 (plunge)\n"
    "G91 X10.5 F1200\n"
    "G90 G4 P1.5\n"
    "(MSG, half done)\n"
    "M0\n"
    "G53 G0 Z0\n"
    "G0 Z5\n"
    "M9\n"
    "M30\n";

TEST(Dialect, HeidenhainConversational) {
  EXPECT_EQ(said(Dialect::heidenhain, kProgram),
            "0 BEGIN PGM PLATE MM\n"
            "11 CYCL DEF 7.0 DATUM SHIFT\n"
            "12 CYCL DEF 7.1 X+0\n"
            "13 CYCL DEF 7.2 Y+0\n"
            "14 CYCL DEF 7.3 Z+0\n"
            "15 CYCL DEF 8.0 MIRROR IMAGE\n"
            "16 CYCL DEF 8.1\n"
            "17 CYCL DEF 10.0 ROTATION\n"
            "18 CYCL DEF 10.1 ROT+0\n"
            "19 CYCL DEF 11.0 SCALING\n"
            "20 CYCL DEF 11.1 SCL 1\n"
            "21 CYCL DEF 26.0 AXIS-SPECIFIC SCALING\n"
            "22 CYCL DEF 26.1 X 1 Y 1 Z 1\n"
            "23 CYCL DEF 32.0 TOLERANCE\n"
            "24 CYCL DEF 32.1\n"
            "25 M137\n"
            "26 L Z-2 R0 FMAX M91\n"
            "27 ; a plate\n"
            "28 TOOL CALL 1 Z\n"
            "29 TOOL CALL S12000\n"
            "30 L M3\n"
            "31 L X+10 Y+20 R0 FMAX\n"
            "32 L Z+5 FMAX\n"
            "33 L M8\n"
            "34 ; plunge\n"
            "35 L Z-1 F300\n"
            "36 L X+20.5 F1200\n"
            "37 CYCL DEF 9.0 DWELL TIME\n"
            "38 CYCL DEF 9.1 DWELL 1.5\n"
            "39 ; half done\n"
            "40 L M0\n"
            "41 L M3\n"
            "42 L M8\n"
            "43 L Z+0 FMAX M91\n"
            "44 L X+20.5 Y+20 FMAX\n"
            "45 L Z+5 FMAX\n"
            "46 L M9\n"
            "47 L Z-2 R0 FMAX M91\n"
            "48 L M5\n"
            "49 L M30\n"
            "50 END PGM PLATE MM\n");
}

TEST(Dialect, Fanuc) {
  EXPECT_EQ(said(Dialect::fanuc, kProgram),
            "%\n"
            "O1234 (PLATE)\n"
            "N1 G21\n"
            "N2 G17 G40 G64 G80 G90 G94\n"
            "N3 G97\n"
            "N4 G69\n"
            "N5 G15\n"
            "N6 G50\n"
            "N7 G50.1 X0. Y0. Z0.\n"
            "N8 G52 X0. Y0. Z0.\n"
            "N9 G92.1 X0. Y0. Z0.\n"
            "N10 G90 G49 G53 G0 Z-2.\n"
            "(A PLATE)\n"
            "N11 T1 M6\n"
            "N12 G90 G54 G17 G94 G40 G80 G64\n"
            "N13 S12000 M3\n"
            "N14 G0 X10. Y20.\n"
            "N15 G43 H1 Z5.\n"
            "N16 M8\n"
            "(PLUNGE)\n"
            "N17 G1 Z-1. F300.\n"
            "N18 X20.5 F1200.\n"
            "N19 G4 X1.5\n"
            "(HALF DONE)\n"
            "N20 M0\n"
            "N21 M3\n"
            "N22 M8\n"
            "N23 G90 G49 G53 G0 Z0.\n"
            "N24 X20.5 Y20.\n"
            "N25 G43 H1 Z5.\n"
            "N26 M9\n"
            "N27 G90 G49 G53 G0 Z-2.\n"
            "N28 M5\n"
            "N29 M30\n"
            "%\n");
}

TEST(Dialect, Siemens) {
  EXPECT_EQ(said(Dialect::siemens, kProgram),
            "; PLATE\n"
            "N10 G17 G40 G64 G90 G94 G710 COMPOF\n"
            "N20 TRANS\n"
            "N30 SUPA G0 Z-2 D0\n"
            "; a plate\n"
            "N40 T1\n"
            "N50 M6\n"
            "N60 G17 G40 G64 G90 G94 G710 G54\n"
            "N70 TRANS\n"
            "N80 S12000 M3\n"
            "N90 G0 X10 Y20\n"
            "N100 D1 Z5\n"
            "N110 M8\n"
            "; plunge\n"
            "N120 G1 Z-1 F300\n"
            "N130 X20.5 F1200\n"
            "N140 G4 F1.5\n"
            "N150 MSG(\"half done\")\n"
            "N160 M0\n"
            "N170 M3\n"
            "N180 M8\n"
            "N190 SUPA G0 Z0 D0\n"
            "N200 X20.5 Y20\n"
            "N210 D1 Z5\n"
            "N220 M9\n"
            "N230 SUPA G0 Z-2 D0\n"
            "N240 M5\n"
            "N250 M30\n");
}

// G55 of the trial is turned by 12.5 deg: 1 inch along X is 24.798 mm and 5.498 mm.
TEST(Dialect, ShiftsRotationsInchesAndIncrementsAreInTheNumbers) {
  const std::string text = said(Dialect::siemens,
                                "G20 G90 G55 G0 X0 Y0 Z0\n"
                                "G92 X5\n"
                                "G1 X6 F10\n"
                                "G91 X1\n"
                                "M2\n");
  EXPECT_EQ(text,
            "; PLATE\n"
            "N10 G17 G40 G64 G90 G94 G710 COMPOF\n"
            "N20 TRANS\n"
            "N30 SUPA G0 Z-2 D0\n"
            "N40 G55\n"
            "N50 G0 X0 Y0\n"
            "N60 Z0\n"
            "N70 G1 X24.79792 Y5.49757 F254\n"
            "N80 X49.59584 Y10.99513\n"
            "N90 SUPA G0 Z-2 D0\n"
            "N100 M5\n"
            "N110 M30\n");
}

TEST(Dialect, WhatItCannotExpressIsRefusedWithItsPlace) {
  const std::string start = "G21 G90\nT1 M6 G43 H1\nS1000 M3\nG0 X0 Y0 Z5\n";
  EXPECT_EQ(refusal(Dialect::heidenhain, start + "G55 G1 X1 F100\nM2\n"),
            "plate.ngc:5: error: selects a work offset other than G54; write one program per "
            "offset, with its --preset; it cannot be expressed in heidenhain");
  EXPECT_EQ(refusal(Dialect::siemens, start + "G61 G1 X1 F100\nM2\n"),
            "plate.ngc:5: error: needs the exact path of LinuxCNC's G61; use G61.1 (exact stop) or "
            "G64; it cannot be expressed in siemens");
  EXPECT_EQ(
      refusal(Dialect::siemens, start + "G10 L1 P1 Z3\nM2\n"),
      "plate.ngc:5:1: error: G10 cannot be expressed in siemens; enter tools and their lengths at "
      "the control");
  EXPECT_EQ(refusal(Dialect::heidenhain, start + "M7\nM2\n"),
            "plate.ngc:5: error: switches mist (M7), which is defined by the machine builder; use "
            "M8, or remove it; it cannot be expressed in heidenhain");
  EXPECT_EQ(refusal(linuxcnc_trial(Dialect::fanuc, start + "M52 P1\nM2\n")),
            "plate.ngc:5:1: error: M52 cannot be expressed in fanuc; adaptive feed and feed stop "
            "are inputs of LinuxCNC; remove it");
}

}  // namespace
}  // namespace servomill::sim::programs::dialect_test
