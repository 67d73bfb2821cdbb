// Positions that tool changes and stops leave unknown, in programs for other controls.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::lost_positions_test {
namespace {

const std::string kStart = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\n";

// Nobody may have jogged at a stop: a rapid from there goes up before it goes across.
TEST(LostPositions, RapidsBehindAStopGoUpFirstAsIfNobodyHadJogged) {
  const std::string work = kStart + "G0 X10 Y10 Z5\nG1 Z-5 F200\nX60\n";
  EXPECT_TRUE(body(Dialect::fanuc, work + "M1\nG0 X10 Y60 Z20\nM2\n")
                  .ends_with("M1\nM3\nG0 Z20.\nX10. Y60.\n"));
  EXPECT_TRUE(body(Dialect::siemens, work + "M0\nG0 X10 Y60 Z20\nM2\n")
                  .ends_with("M0\nM3\nG0 Z20\nX10 Y60\n"));
  EXPECT_TRUE(body(Dialect::heidenhain, work + "M0\nG0 X10 Y60 Z20\nM2\n")
                  .ends_with("L M0\nL M3\nL Z+20 FMAX\nL X+10 Y+60 FMAX\n"));
  // LinuxCNC, too, stops the spindle before the motion of its block
  EXPECT_TRUE(body(Dialect::fanuc, work + "X20 M0\nG0 X30 Y30 Z5 M5\nM2\n")
                  .ends_with("M0\nM5\nG0 Z5.\nX30. Y30.\n"));
}

TEST(LostPositions, RapidsBehindAStopGoAcrossBeforeTheyGoDown) {
  EXPECT_TRUE(body(Dialect::fanuc, kStart + "G0 X10 Y10 Z5\nM0\nG0 X30 Y30 Z-4\nM2\n")
                  .ends_with("M0\nM3\nX30. Y30.\nZ-4.\n"));
}

// Somebody may have jogged: Z goes down where the program has X and Y, and up where it is.
TEST(LostPositions, AxesAreRestatedBeforeZGoesDownBehindAStop) {
  const std::string up = kStart + "G0 X10 Y10\nZ50\nM0\n";
  EXPECT_TRUE(body(Dialect::fanuc, up + "G0 X20\nZ5\nM2\n").ends_with("M0\nM3\nX20.\nY10.\nZ5.\n"));
  EXPECT_TRUE(body(Dialect::siemens, up + "G0 Z5\nG1 Z-1 F100\nM2\n")
                  .ends_with("M0\nM3\nX10 Y10\nZ5\nG1 Z-1 F100\n"));
  EXPECT_TRUE(body(Dialect::heidenhain, up + "G0 Z50\nM2\n")
                  .ends_with("L M0\nL M3\nL X+10 Y+10 FMAX\nL Z+50 FMAX\n"));
  EXPECT_TRUE(body(Dialect::fanuc, kStart + "G0 X10 Y10\nZ5\nG1 Z-5 F100\nM0\nG0 Z50\nX0\nZ5\nM2\n")
                  .ends_with("M0\nM3\nG0 Z50.\nX0.\nY10.\nZ5.\n"));
}

// After a tool change the control does not know where X and Y are: Z waits for them.
TEST(LostPositions, AxesAreRestatedBeforeZGoesDownBehindAToolChange) {
  const std::string change = kStart + "G0 X10 Y10 Z5\nX20 Z20\nT2 M6\nG43 H2\nS800 M3\n";
  EXPECT_TRUE(body(Dialect::fanuc, change + "G0 Z-4\nX20 Y15\nM2\n")
                  .ends_with("S800 M3\nG0 X20. Y10.\nG43 H2 Z-4.\nY15.\n"));
  EXPECT_TRUE(body(Dialect::siemens, change + "G0 Z-4\nX20 Y15\nM2\n")
                  .ends_with("S800 M3\nG0 X20 Y10\nD1 Z-4\nY15\n"));
  EXPECT_TRUE(body(Dialect::heidenhain, change + "G0 Z-4\nX20 Y15\nM2\n")
                  .ends_with("L M3\nL X+20 Y+10 R0 FMAX\nL Z-4 FMAX\nL Y+15 FMAX\n"));
  EXPECT_TRUE(body(Dialect::fanuc, change + "G0 X30 Z5\nG1 X40 F100\nM2\n")
                  .ends_with("S800 M3\nG0 Y10.\nX30.\nG43 H2 Z5.\nG1 X40. F100.\n"));
  EXPECT_TRUE(body(Dialect::fanuc, change + "M0\nG53 G0 Z-3\nG99 G81 X15 Z-1 R3 F100\nM2\n")
                  .ends_with("X15.\nY10.\nG43 H2 Z3.\nG1 Z-1. F100.\nG0 Z3.\n"));
}

// After a move in machine coordinates no work offset may come in.
TEST(LostPositions, AxesAreRestatedInTheCoordinatesThatTheyWereWrittenIn) {
  EXPECT_TRUE(body(Dialect::fanuc, kStart + "G0 X10 Y10 Z5\nG53 G0 X5\nT2 M6\nG43 H2\nS800 M3\n"
                                            "G55\nG0 Z5\nM2\n")
                  .ends_with("S800 M3\nG53 G0 X5.\nY10.\nG55\nG43 H2 Z5.\n"));
}

TEST(LostPositions, RotaryAxesAreRestatedFirst) {
  Trial trial = dialect_trial(Dialect::fanuc,
                              "G21 G90 G17 G54\nT1 M6\nG43 H1\nG0 A20 C30\nX1 Y2\nZ20\nT2 M6\n"
                              "G43 H2 G0 Z20\nA0 C0\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
  EXPECT_TRUE(body(trial).ends_with(
      "T2 M6\nG90 G54 G17 G94 G40 G80 G64\nG0 A20. C30.\nX1. Y2.\nG43 H2 Z20.\n"
      "A0. C0.\n"))
      << body(trial);
}

TEST(LostPositions, ZBehindAToolChangeNeedsAxesThatAreNamed) {
  const std::string home = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X1\n";
  EXPECT_EQ(refusal(Dialect::fanuc, home + "Z5\nM2\n"),
            "plate.ngc:6: error: moves Z while the position of Y is unknown: the tool change or "
            "stop may have moved it, and no block programs it; program Y in a rapid between it and "
            "this line, or set the start position with --start");
  EXPECT_EQ(refusal(Dialect::fanuc, home + "G53 G0 Z-3\nM2\n"), "taken");
  Trial trial = dialect_trial(Dialect::fanuc, home + "Z5\nM2\n");
  trial.request.start = "X=0,Y=7";
  EXPECT_TRUE(body(trial).ends_with("X1.\nG53 G0 Y7.\nG43 H1 Z5.\n")) << body(trial);
}

// After G28 the position of Z is unknown, and with it the errors: X and Y stay at their corrected
// positions. The path through Z20 does not change because Z is at its corrected position either.
TEST(LostPositions, LeaveTheOtherAxesWhereTheyAreBehindG28) {
  for (const Dialect dialect :
       {Dialect::linuxcnc, Dialect::fanuc, Dialect::siemens, Dialect::heidenhain}) {
    Trial trial = dialect_trial(dialect,
                                "G21 G90 G17 G54\nT1 M6\nS1000 M3\nG0 X40 Y20\nG43 H1 Z20\n"
                                "G28 Z20\nG0 X40 Y20\nG0 Z20\nM2\n");
    trial.request.error_file.clear();  // those of the machine file
    EXPECT_EQ(refusal(trial), "taken");
  }
}

// Whatever the reader, nothing of a program is left out: not after a '%' that none precedes, and
// not a block between two comments.
TEST(LostPositions, RefusesBlocksAfterThePercentThatEndsTheProgram) {
  for (const char* reader : {"fanuc", "haas"}) {
    Trial trial("G21 G17 G90 G94 G54\nG0 X0 Y0 Z0\nG1 X1. F600.\n%\nG1 Y1.\nM30\n");
    trial.request.inputs.reader = reader;
    EXPECT_NE(refusal(trial).find("but blocks follow it"), std::string::npos) << refusal(trial);
  }
  EXPECT_NE(refusal(Trial("%\nG21 G90\nG0 X0 Y0 Z0\n%\n(a) G1 Y1. F100 (b)\nM30\n"))
                .find("blocks follow it"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::programs::lost_positions_test
