// Programs for other controls than LinuxCNC: what they say, and what they refuse to say.
#include "tests/sim/compensate/trial.h"

namespace servomill::sim {
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

// Without errors and header, so that a test shows the dialect alone.
std::string said(Dialect dialect, const std::string& program) {
  Trial trial(program, "plate.ngc");
  trial.request.error_file = written("none.toml", "[errors.none]\nEXX = { constant_um = 0.0 }\n");
  trial.request.dialect = dialect;
  const std::string text = trial.run().program;
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    const auto has = [&](const char* word) { return line.find(word) != std::string::npos; };
    if (!has("servomill") && !has("SERVOMILL") && !has("assumed") && !has("ASSUMED") &&
        !has("path within") && !has("PATH WITHIN")) {
      out += line + "\n";
    }
  }
  return out;
}

std::string refusal(Dialect dialect, const std::string& program) {
  try {
    said(dialect, program);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("plate.ngc"));
  }
  return "taken";
}

TEST(Dialect, HeidenhainConversational) {
  EXPECT_EQ(said(Dialect::heidenhain, kProgram),
            "0 BEGIN PGM COMPENSATE_PLATE MM\n"
            "6 ; a plate\n"
            "7 TOOL CALL 1 Z\n"
            "8 TOOL CALL S12000\n"
            "9 L M3\n"
            "10 L X+10 Y+20 Z+5 R0 FMAX\n"
            "11 L M8\n"
            "12 ; plunge\n"
            "13 L Z-1 F300\n"
            "14 L X+20.5 F1200\n"
            "15 CYCL DEF 9.0 DWELL TIME\n"
            "16 CYCL DEF 9.1 DWELL 1.5\n"
            "17 ; half done\n"
            "18 L M0\n"
            "19 L Z+0 FMAX M91\n"
            "20 L Z+5 FMAX\n"
            "21 L M9\n"
            "22 L M5\n"
            "23 L M30\n"
            "24 END PGM COMPENSATE_PLATE MM\n");
}

TEST(Dialect, Fanuc) {
  EXPECT_EQ(said(Dialect::fanuc, kProgram),
            "%\n"
            "O0001 (COMPENSATE_PLATE)\n"
            "N1 G21 G17 G40 G49 G80 G90 G94\n"
            "(A PLATE)\n"
            "N2 T1 M6\n"
            "N3 S12000\n"
            "N4 M3\n"
            "N5 G54\n"
            "N6 G43 H1 G0 X10. Y20. Z5.\n"
            "N7 M8\n"
            "(PLUNGE)\n"
            "N8 G1 Z-1. F300.\n"
            "N9 X20.5 F1200.\n"
            "N10 G4 X1.5\n"
            "(HALF DONE)\n"
            "N11 M0\n"
            "N12 G53 G0 Z0.\n"
            "N13 Z5.\n"
            "N14 M9\n"
            "N15 M5\n"
            "N16 M30\n"
            "%\n");
}

TEST(Dialect, Siemens) {
  EXPECT_EQ(said(Dialect::siemens, kProgram),
            "; COMPENSATE_PLATE\n"
            "N10 G710 G17 G40 G90 G94\n"
            "; a plate\n"
            "N20 T1\n"
            "N30 M6\n"
            "N40 S12000\n"
            "N50 M3\n"
            "N60 G54\n"
            "N70 D1 G0 X10 Y20 Z5\n"
            "N80 M8\n"
            "; plunge\n"
            "N90 G1 Z-1 F300\n"
            "N100 X20.5 F1200\n"
            "N110 G4 F1.5\n"
            "N120 MSG(\"half done\")\n"
            "N130 M0\n"
            "N140 SUPA D0 G0 Z0\n"
            "N150 D1 Z5\n"
            "N160 M9\n"
            "N170 M5\n"
            "N180 M30\n");
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
            "; COMPENSATE_PLATE\n"
            "N10 G710 G17 G40 G90 G94\n"
            "N20 G55\n"
            "N30 G0 X0 Y0 Z0\n"
            "N40 G1 X24.79792 Y5.49757 F254\n"
            "N50 X49.59584 Y10.99513\n"
            "N60 M30\n");
}

TEST(Dialect, WhatItCannotSayIsRefusedWithItsPlace) {
  const std::string start = "G21 G90\nT1 M6 G43 H1\nS1000 M3\nG0 X0 Y0 Z5\n";
  EXPECT_EQ(refusal(Dialect::heidenhain, start + "G55 G1 X1 F100\nM2\n"),
            "plate.ngc:5: error: selects a work system other than G54; presets are the control's; "
            "that cannot be said for heidenhain");
  EXPECT_EQ(refusal(Dialect::fanuc, start + "G64 P0.01 G1 X1 F100\nM2\n"),
            "plate.ngc:5: error: gives a tolerance (G64 P); that cannot be said for fanuc");
  EXPECT_EQ(refusal(Dialect::siemens, start + "G61 G1 X1 F100\nM2\n"),
            "plate.ngc:5: error: asks for G61 as LinuxCNC means it; that cannot be said for "
            "siemens");
  EXPECT_EQ(refusal(Dialect::siemens, start + "G10 L2 P1 X3\nM2\n"),
            "plate.ngc:5:1: error: G10 cannot be said for siemens");
  EXPECT_EQ(
      refusal(Dialect::heidenhain, start + "M7\nM2\n"),
      "plate.ngc:5: error: switches mist (M7), which is the machine builder's; that cannot be "
      "said for heidenhain");
  EXPECT_EQ(refusal(Dialect::fanuc, start + "M48\nM2\n"),
            "plate.ngc:5:1: error: M48 cannot be said for fanuc");
}

}  // namespace
}  // namespace servomill::sim
