// Siemens programs against moves worked out by hand.
#include <gtest/gtest.h>

#include "controllers/gcode/called_subroutines.h"
#include "controllers/siemens/siemens.h"
#include "siemens_examples.h"

namespace servomill::controllers::siemens::siemens_test {
namespace {

void expect_all(const std::vector<Example>& examples) {
  for (const Example& example : examples) {
    SCOPED_TRACE(example.name);
    try {
      EXPECT_EQ(framed_moves(example.program), example.moves);
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

TEST(Siemens, Lines) { expect_all(line_examples()); }
TEST(Siemens, Arcs) { expect_all(arc_examples()); }
TEST(Siemens, Contours) { expect_all(contour_examples()); }
TEST(Siemens, Frames) { expect_all(frame_examples()); }
TEST(Siemens, VariablesAndFlow) { expect_all(flow_examples()); }
TEST(Siemens, Cycles) { expect_all(cycle_examples()); }

const char* const kArchive =
    "%_N_PLATE_MPF\n;$PATH=/_N_WKS_DIR/_N_PLATE_WPD\nG17 G71 G90 G54\nT1 M6 D1\nG0 X0 Y0 Z0 F100\n"
    "R1=4\nHOLE(2,,R1)\nG1 X=R1\nL10 P2\nG1 Y=0\nM30\n"
    "%_N_HOLE_SPF\nPROC HOLE(REAL A, INT B=3, VAR REAL C) SAVE\nG91 G1 X=A Y=B\nC=C+5\nM17\n"
    "%_N_L10_SPF\nG1 Z=IC(-1)\nRET\n";

// [J] "Subprogram technique": SAVE brings G90 back, VAR gives its value back, P2 runs it twice
TEST(Siemens, SubprogramsInTheSameFile) {
  EXPECT_EQ(all_moves(kArchive),
            "4 tool 1\n5 rapid 0 0 0\n14 feed 2 3 0 F100\n8 feed 9 3 0 F100\n"
            "18 feed 9 3 -1 F100\n18 feed 9 3 -2 F100\n10 feed 9 0 -2 F100\n11 end\n");
}

// A pole counts in the frame in which it was set
TEST(Siemens, APoleEndsWithTheFrameThatSaveTakesBack) {
  try {
    all_moves(
        "%_N_A_MPF\nG17 G71 G90 G54 G0 X0 Y0 Z0 F100\nL1\nG1 AP=0 RP=5\nM30\n"
        "%_N_L1_SPF\nPROC L1 SAVE\nTRANS X10\nG111 X0 Y0\nM17\n");
    FAIL() << "no fault";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "t.mpf:4:1: error: AP and RP require a pole in the same frame; program G111 first");
  }
}

TEST(Siemens, SubprogramsInFilesOfTheirOwn) {
  ProgramSetup setup = example_setup();
  setup.subroutine_file = [](const std::string& name) -> std::optional<ProgramText> {
    if (name == "POCKET") return ProgramText::of_text("G1 X=IC(1)\nM17\n", "POCKET.SPF");
    if (name == "CYCLE81") return ProgramText::of_text("G1 Y=IC(1)\nM17\n", "CYCLE81.SPF");
    return std::nullopt;
  };
  const std::string program = with_frame(
      "F100\nPOCKET\npocket P2\nEXTCALL(\"POCKET.SPF\")\nMCALL POCKET\nX20\n"
      "MCALL\nCYCLE81\n");
  EXPECT_EQ(all_moves(program, setup),
            "2 tool 1\n2 spindle 0 S1000\n3 rapid 0 0 0\n1 feed 1 0 0 F100\n1 feed 2 0 0 F100\n"
            "1 feed 3 0 0 F100\n1 feed 4 0 0 F100\n9 feed 20 0 0 F100\n1 feed 21 0 0 F100\n"
            "1 feed 21 1 0 F100\n12 end\n");
  EXPECT_EQ(called_subroutines(ProgramText::of_text(program, "t.mpf")),
            (std::set<std::string>{"CYCLE81", "POCKET"}));
}

TEST(Siemens, SettingsOfTheMachineChoose) {
  ProgramSetup setup = example_setup();
  const std::string inch = "G17 G90 G54 G70\nT1 M6\nG0 X0 Y0 Z0\nG1 X1 F10\nM30\n";
  const std::string before = "2 tool 1\n3 rapid 0 0 0\n", behind = "5 end\n";
  setup.parameters["$MN_SCALING_SYSTEM_IS_METRIC"] = 1.0;
  EXPECT_EQ(all_moves(inch, setup), before + "4 feed 25.4 0 0 F10\n" + behind);
  setup.parameters["$MN_SCALING_SYSTEM_IS_METRIC"] = 0.0;
  EXPECT_EQ(all_moves(inch, setup), before + "4 feed 25.4 0 0 F254\n" + behind);
  // G71 says nothing of F, G710 does
  EXPECT_EQ(framed_moves("G1 X10 F10\nG710 X0 F10\n", setup),
            "1 feed 10 0 0 F254\n2 feed 0 0 0 F10\n");
  // machine Z of 50 is tip Z of -50 with a tool of 100 mm, or the tip itself
  const std::string supa = "SUPA G0 Z50\nX1\n";
  setup = example_setup();
  EXPECT_EQ(framed_moves(supa, setup), "1 rapid 0 0 50\n2 rapid 1 0 50\n");
  setup.parameters["$MN_G53_TOOLCORR"] = 1.0;
  EXPECT_EQ(framed_moves(supa, setup), "1 rapid 0 0 -50\n2 rapid 1 0 -50\n");
  setup.parameters["R7"] = 3.0;
  setup.parameters["$P_UIFR[1,X,TR]"] = 4.0;
  EXPECT_EQ(framed_moves("G0 X=$p_uifr[1, x, tr]\n", setup), "1 rapid 4 0 0\n");
  EXPECT_EQ(framed_moves("G0 X=R7\n", setup), "1 rapid 3 0 0\n");
}

TEST(Siemens, ReadingsAreWarnedOf) {
  EXPECT_EQ(
      warnings_of("T1\nG0 X1\nM84\nRTLIOF\nG9\n"),
      "t.mpf:1:1: T is treated as a tool change: the program has no M6 (MD22550 = 0)\nt.mpf:2:1: a "
      "motion block precedes G17, G90, G71, G94, G64, G54: assumed active at the start\nt.mpf:3:1: "
      "M84 is ignored: machine-builder function; no effect on motion\nt.mpf:4:1: RTLIOF: treated "
      "as RTLION, rapid moves in a straight line\nt.mpf:5:1: G9: non-modal exact stop is ignored; "
      "use G60\nt.mpf:5: the program ends without M30: treated as if M30 followed\n");
}

TEST(Siemens, WordsThatArePassedOverAreWarnedOf) {
  EXPECT_EQ(
      warnings_of(with_frame("ACC[X]=50 OVRRAP=50\nG26 X100 S2000\nH5=3\nORIWKS\nSPOS=0\n"
                             "G641 ADIS=0.5\nG97\nG1 X1 F0.1 RND=0.1\nM8\nY1\n")),
      "t.mpf:4:1: ACC: ignored: the acceleration limit of the machine applies\nt.mpf:4:1: OVRRAP: "
      "ignored: rapid moves use the rapid velocity of the machine\nt.mpf:5:1: G25 and G26: limits "
      "of the working area are ignored\nt.mpf:6:1: H: ignored: a PLC function without effect on "
      "motion\nt.mpf:7:1: ORIWKS: treated as ORIAXES, linear interpolation of the rotary axes; the "
      "tool leaves the plane of its start and end orientation\nt.mpf:8:1: SPOS and M19: the "
      "spindle stops; its orientation is not simulated\nt.mpf:9:1: G641: treated as G64: the "
      "smoothing tolerance is not evaluated; set it with CYCLE832\nt.mpf:9:1: ADIS: ignored: the "
      "smoothing distance is not evaluated; set a tolerance with CYCLE832\nt.mpf:10:1: G97: F is "
      "in mm/rev, as with G95\nt.mpf:12:1: F or an M function in the block of RND, CHF or CHR: "
      "treated as effective after the corner, as with MD20201 bit 0 = 1; FRC sets the feed rate of "
      "the corner\n");
}

// G60 is exact stop; CYCLE832 gives a tolerance, which G64 and G642 keep; SAVE restores the mode
TEST(Siemens, ExactStopAndTolerance) {
  ProgramSetup setup = example_setup();
  ProgramText text =
      as_gcode(ProgramText::of_text("%_N_A_MPF\nG60\nCYCLE832(0.05,1)\nG642\nL1\nM30\n"
                                    "%_N_L1_SPF\nPROC L1 SAVE\nG60\nM17\n",
                                    "t.mpf"),
               setup);
  std::string modes;
  for (std::string_view line; text.next(line);) {
    if (line.starts_with("G6")) modes.append(line).append("\n");
  }
  EXPECT_EQ(modes, "G61.1\nG64 P0.05\nG64 P0.05\nG61.1\nG64 P0.05\n");
}

// MD22550: T waits for an M6 only in a program that has one; a thread M6 is none
TEST(Siemens, ToolsChangeByTWithoutM6) {
  const std::string begin = "%_N_A_MPF\nG17 G71 G90 G54\n", moves = "T1\nG0 Z1\nT2\nZ2\nM30\n";
  for (const char* const other :
       {"MSG(\"TAP M6\")\n", "; M6\n", "DEF INT TAP_M6\n", "R1=5 ; M6\n", "M65\n"}) {
    EXPECT_EQ(all_moves(begin + other + moves),
              "4 tool 1\n5 rapid 0 0 1\n6 tool 2\n7 rapid 0 0 2\n8 end\n")
        << other;
  }
  EXPECT_EQ(all_moves(begin + "T2M6\n" + moves), "3 tool 2\n5 rapid 0 0 1\n7 rapid 0 0 2\n8 end\n");
}

// [J] "Subprogram call": zeros in front distinguish names
TEST(Siemens, NumberedSubprogramsKeepTheirZeros) {
  EXPECT_EQ(all_moves("%_N_A_MPF\nG17 G71 G90 G54 G0 X0 Y0 Z0 F100\nL010\nL10\nM30\n"
                      "%_N_L10_SPF\nG1 X10\nM17\n%_N_L010_SPF\nG1 Y5\nM17\n"),
            "2 rapid 0 0 0\n10 feed 0 5 0 F100\n7 feed 10 5 0 F100\n5 end\n");
}

TEST(Siemens, IsRecognisedByItsNameAndItsWords) {
  const auto is_one = [](const std::string& file, const std::string& text, Reader reader) {
    ProgramText program = ProgramText::of_text(text, file);
    return is_siemens(program, reader);
  };
  for (const char* const file : {"SHAFT.MPF", "shaft.mpf", "hole.SPF"}) {
    EXPECT_TRUE(is_one(file, "G0 X1\nM30\n", Reader::any)) << file;
    EXPECT_FALSE(is_one(file, "G0 X1\nM30\n", Reader::fanuc)) << file;
  }
  EXPECT_TRUE(is_one("p.nc", "%_N_SHAFT_MPF\nG0 X1\n", Reader::any));
  EXPECT_TRUE(is_one("p.nc", "G0 X1\nN20 MCALL CYCLE81(5,0,2,-3)\n", Reader::any));
  EXPECT_TRUE(is_one("p.nc", "G0 X1\n", Reader::siemens));
  EXPECT_FALSE(is_one("p.nc", "G0 X1\n(MSG, DONE)\nM30\n", Reader::any));
  EXPECT_FALSE(is_one("mpf", "G0 X1\n", Reader::any));
}

// The control generates the moves of a pocket: positions after it are unknown until programmed.
TEST(Siemens, ASurveyGoesOnBehindCyclesOfTheControl) {
  ProgramSetup setup = example_setup();
  setup.accepts_unknown_positions = true;
  const std::string program = with_frame("POCKET3(5,0,2,-10,50,30,5)\nG0 X1 Y2 Z3\nX=IC(1)\n");
  EXPECT_EQ(warnings_of(program, setup),
            "t.mpf:4:1: POCKET3: the path is internal to the control; have the CAM system output "
            "the moves; extent and cycle time exclude its moves\n");
}

TEST(Siemens, BlocksWithASlashAreLeftOutOnRequest) {
  ProgramSetup setup = example_setup();
  setup.block_delete = true;
  EXPECT_EQ(framed_moves("/G0 X1\n/3 N5 G0 X2\nG0 X3\n", setup), "3 rapid 3 0 0\n");
}

TEST(Siemens, EndlessProgramsAreStopped) {
  ProgramSetup setup = example_setup();
  setup.most_jumps = 10;
  const char* const message =
      ": error: 10 jumps: the program appears to loop endlessly; raise --max-jumps if intended";
  EXPECT_EQ(fault_of("AGAIN: R1=1\nGOTOB AGAIN\n", setup), std::string("t.mpf:5:1") + message);
  EXPECT_EQ(fault_of("LOOP\nENDLOOP\n", setup), std::string("t.mpf:5:1") + message);
}

}  // namespace
}  // namespace servomill::controllers::siemens::siemens_test
