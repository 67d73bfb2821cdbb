// Things that programs for other controls may never do, whatever is in force: one test for
// each way in which a written program once did what the original does not.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::dialect_rules_test {
namespace {

// G43 H1 comes in a block of its own: no height of the tip before the length is in force.
TEST(DialectRules, HeightsOfTheTipWaitForTheToolLength) {
  Trial trial = dialect_trial(Dialect::fanuc,
                              "G21 G90 G17 G54\nG53 G0 Z-5\nT1 M6\nG43 H1\nS1000 M3\n"
                              "G0 X10 Y10\nG0 Z5\nG1 Z-1 F200\nG1 X50\nM30\n");
  trial.request.error_file.clear();  // those of the router
  trial.request.inputs.parameter_file.clear();
  trial.request.inputs.tool_table = written("long.tbl", "T1 P1 Z+50 D6\n");
  trial.request.work_offsets = {"X=200,Y=250,Z=-100"};
  EXPECT_EQ(body(trial),
            "G90 G49 G53 G0 Z-5.\n"
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X10. Y10.\n"
            "G43 H1 Z4.962\n"
            "G1 X10.007 Y9.953 F200.\n"
            "Y9.954 Z-1.038\n"
            "X49.999 Y9.949 Z-1.04\n");
  trial.request.dialect = Dialect::siemens;
  const std::string siemens = body(trial);
  EXPECT_NE(siemens.find("G0 X10 Y10\nD1 Z4.96239\n"), std::string::npos) << siemens;
}

// A position that nothing has named is unknown, not 0.
TEST(DialectRules, MovesToWhereAMachineMightBeAreWritten) {
  const std::string home = "G21 G90 G54\nG53 G0 Z0\nT1 M6\nG43 H1\nG0 X0 Y0\nZ5\nM2\n";
  EXPECT_EQ(body(Dialect::fanuc, home),
            "G90 G49 G53 G0 Z0.\n"
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "G0 X0. Y0.\n"
            "G43 H1 Z5.\n");
  EXPECT_EQ(body(Dialect::siemens, home),
            "SUPA G0 Z0 D0\n"
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "G0 X0 Y0\n"
            "D1 Z5\n");
  EXPECT_EQ(body(Dialect::heidenhain, home),
            "L Z+0 FMAX M91\n"
            "TOOL CALL 1 Z\n"
            "L X+0 Y+0 R0 FMAX\n"
            "L Z+5 FMAX\n");
}

TEST(DialectRules, MovesToZeroAreWrittenWhereZeroIsAPositionOfTheMachine) {
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens}) {
    Trial trial = dialect_trial(dialect, "G0 X0 Y0\nM2\n");
    trial.request.inputs.parameter_file.clear();
    trial.request.work_offsets = {"X=0,Y=0,Z=0"};
    const bool has_points = dialect == Dialect::fanuc;
    EXPECT_EQ(body(trial), has_points ? "G54\nG0 X0. Y0.\n" : "G54\nG0 X0 Y0\n");
  }
}

TEST(DialectRules, SpindlesStopBeforeTheToolChangeThatStopsThem) {
  EXPECT_EQ(body(Dialect::fanuc, kDialectStart + "G0 X1 Y1 Z5\nG53 G0 Z0\nM5\nT2 M6\nM2\n"),
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X1. Y1.\n"
            "G43 H1 Z5.\n"
            "G90 G49 G53 G0 Z0.\n"
            "M5\n"
            "T2 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n");
}

// #5161 is a place of LinuxCNC's machine: up is all that it can mean on another one.
TEST(DialectRules, ReturnsToTheReferenceBecomeTheControlsOwnOrTheRetractedHeight) {
  const std::string home = kDialectStart + "G0 X1 Y1 Z5\nG28 G91 Z0\nG90 G0 X2\nZ5\nM2\n";
  EXPECT_EQ(body(Dialect::fanuc, home),
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X1. Y1.\n"
            "G43 H1 Z5.\n"
            "G91 G28 Z0.\n"
            "G90\n"
            "X2.\n"
            "G43 H1 Z5.\n");
  EXPECT_EQ(body(Dialect::siemens, home),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "S1000 M3\n"
            "G0 X1 Y1\n"
            "D1 Z5\n"
            "SUPA G0 Z-2 D0\n"
            "X2\n"
            "D1 Z5\n");
  EXPECT_EQ(
      refusal(Dialect::fanuc, kDialectStart + "G28\nM2\n"),
      "plate.ngc:5: error: G28 of axes other than Z moves to positions stored in LinuxCNC; program "
      "G53 G0 X... Y... with the positions of this machine; it cannot be expressed in fanuc");
}

// Macros of builders move axes and leave modes behind.
TEST(DialectRules, NothingSurvivesAToolChange) {
  EXPECT_EQ(body(Dialect::fanuc, kDialectStart +
                                     "G0 X10 Y20 Z5\nM8\nG1 Z-1 F100\nX20\nG0 Z50\nT2 M6\nG43 H2\n"
                                     "S1000 M3\nG0 X20 Y20 Z5\nM8\nG1 Z-1\nM30\n"),
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X10. Y20.\n"
            "G43 H1 Z5.\n"
            "M8\n"
            "G1 Z-1. F100.\n"
            "X20.\n"
            "G0 Z50.\n"
            "M5\n"
            "T2 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "M8\n"
            "G0 X20. Y20.\n"
            "G43 H2 Z5.\n"
            "M8\n"
            "G1 Z-1. F100.\n"
            "M9\n");
}

// G49 alone moves Z on some machines.
TEST(DialectRules, FanucCancelsTheLengthWithG53Only) {
  const std::string text = said(Dialect::fanuc, "G21 G90 G54\nT1 M6\nG0 X1 Y1\nZ60\nM2\n");
  for (const std::string& line : lines_of(text)) {
    if (line.find("G49") == std::string::npos) continue;
    EXPECT_NE(line.find("G90 G49 G53 G0 Z-2."), std::string::npos) << line;
  }
  EXPECT_NE(text.find("G0 X1. Y1.\nN14 G90 G49 G53 G0 Z-2.\nN15 Z60.\n"), std::string::npos)
      << text;
  EXPECT_EQ(
      refusal(Dialect::fanuc, kDialectStart + "G0 X1 Y1 Z5\nG1 Z-1 F100\nG49\nG1 X2 Z-2\nM2\n"),
      "plate.ngc:8: error: moves Z after the tool length was cancelled (G49 after G43), which is "
      "safe on the control only after a retract; program G53 G0 Z... before G49; it cannot be "
      "expressed in fanuc");
}

// G20 and G21 change origin offsets: the unit of the program stays.
TEST(DialectRules, FanucProgramsInInchesStayInInches) {
  const Trial trial = dialect_trial(
      Dialect::fanuc, "G20 G90 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X1 Y.5\nZ.2\nG1 Z-.1 F4\nM2\n");
  EXPECT_NE(trial.run().program.find("\nN1 G20\n"), std::string::npos);
  EXPECT_NE(trial.run().program.find("POSITIONS ROUNDED TO 0.0001 INCH)\n"), std::string::npos);
  EXPECT_EQ(body(trial),
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X1. Y0.5\n"
            "G43 H1 Z0.2\n"
            "G1 Z-0.1 F4.\n");
}

TEST(DialectRules, SpeedsOfFanucAreWhole) {
  const std::string text = body(Dialect::fanuc, "G21 G90\nS4774.648 M3\nM2\n");
  EXPECT_EQ(text, "S4775 M3\n");
}

TEST(DialectRules, FeedsPerRevolutionStay) {
  const std::string program = kDialectStart + "G0 X1 Y1 Z5\nG95 G1 X2 F0.05\nG94 X3 F100\nM2\n";
  const auto has = [&](Dialect dialect, const std::string& text) {
    return body(dialect, program).find(text) != std::string::npos;
  };
  EXPECT_TRUE(has(Dialect::fanuc, "G95 G1 X2. F0.05\nG94 X3. F100.\n"));
  EXPECT_TRUE(has(Dialect::siemens, "G95 G1 X2 F0.05\nG94 X3 F100\n"));
  EXPECT_TRUE(has(Dialect::heidenhain, "L X+2 FU0.05\nL X+3 F100\n"));
}

TEST(DialectRules, ToleranceOfG64IsLeftOutForFanucWithOneWarning) {
  const Trial trial = dialect_trial(
      Dialect::fanuc, kDialectStart + "G0 X1 Y1 Z5\nG64 P0.01\nG1 X2 F100\nG64 P0.02\nX3\nM2\n");
  EXPECT_NE(body(trial).find("G64\nG1 X2. F100.\nG64\nX3.\n"), std::string::npos) << body(trial);
  std::size_t warned = 0;
  for (const Fault& fault : trial.run().warnings) {
    warned += fault.message.starts_with("G64 P: the tolerance is omitted") ? 1 : 0;
  }
  EXPECT_EQ(warned, 1U);
}

TEST(DialectRules, NumbersStayWithinTheFormatsOfTheControl) {
  EXPECT_EQ(refusal(Dialect::heidenhain, kDialectStart + "G4 P4000.\nM2\n"),
            "plate.ngc:5: error: dwells for 4000 s, more than 3600 s; it cannot be expressed in "
            "heidenhain");
  EXPECT_EQ(refusal(Dialect::heidenhain, kDialectStart + "G0 X200000 Y0\nM2\n"),
            "plate.ngc:5: error: moves to X200000; at most 99999.9999 is allowed; it cannot be "
            "expressed in heidenhain");
  EXPECT_EQ(refusal(Dialect::fanuc, "G21 G90\nG53 G0 Z-1.0005\nM2\n"),
            "plate.ngc:2: error: moves to Z-1.0005 in machine coordinates, which has more digits "
            "than the resolution of 1 um (--resolution); it cannot be expressed in fanuc");
}

TEST(DialectRules, LongProgramsNumberEveryThousandthBlock) {
  std::string program = kDialectStart + "G0 X0 Y0 Z5\nG1 Z0 F100\n";
  for (int i = 1; i <= 10000; ++i) program += "X" + std::to_string(i % 2) + "\n";
  const std::string text = said(Dialect::fanuc, program + "M2\n");
  EXPECT_NE(text.find("\nN11 "), std::string::npos);
  EXPECT_EQ(text.find("\nN12 "), std::string::npos);
}

TEST(DialectRules, WhatTheOperatorHasToMakeSureOfIsWrittenAndWarnedOf) {
  const Trial trial =
      dialect_trial(Dialect::fanuc, kDialectStart + "G53 G0 Z0\nG0 X1 Y1\nZ5\nM2\n");
  const Compensated done = trial.run();
  const auto warned = [&](const std::string& message) {
    return std::any_of(done.warnings.begin(), done.warnings.end(),
                       [&](const Fault& fault) { return fault.message == message; });
  };
  EXPECT_TRUE(warned("assumes that T and M6 in one block change the tool, T first"));
  EXPECT_TRUE(warned("assumes that H1 contains the length of tool 1"));
  EXPECT_TRUE(warned("assumes that machine coordinates have the same zero as in the original"));
  EXPECT_NE(done.program.find("(ASSUMED: H1 CONTAINS THE LENGTH OF TOOL 1)\n"), std::string::npos);
  Trial heidenhain = dialect_trial(Dialect::heidenhain, kDialectStart + "G0 X1 Y1\nM2\n");
  EXPECT_NE(heidenhain.run().program.find(
                "; assumed: the active preset is G54\n"
                "6 ; assumed: CYCL DEF 7, 8 and 10 cancel shift, mirror image and rotation\n"),
            std::string::npos)
      << heidenhain.run().program;
  heidenhain.request.preset = 3;
  const std::string text = heidenhain.run().program;
  EXPECT_EQ(text.find("active preset"), std::string::npos);
  EXPECT_NE(text.find("CYCL DEF 247 DATUM SETTING ~\n    Q339=+3 ; DATUM NUMBER\n"),
            std::string::npos)
      << text;
}

// M60 is the builder's: the operator exchanges the pallets, from a height that nobody knows.
TEST(DialectRules, PalletsAreExchangedByTheOperator) {
  const Trial trial = dialect_trial(
      Dialect::siemens, kDialectStart + "G0 X1 Y1 Z5\nG0 Z50\nM60\nG0 Z5\nG1 Z-1 F100\nM2\n");
  const std::string text = body(trial);
  EXPECT_TRUE(
      text.ends_with("Z50\n"
                     "MSG(\"exchange the pallets [M60]\")\n"
                     "M0\n"
                     "SUPA G0 Z-2 D0\n"
                     "M3\n"
                     "X1 Y1\n"
                     "D1 Z5\n"
                     "G1 Z-1 F100\n"))
      << text;
}

TEST(DialectRules, OverridesStayTheOperators) {
  const Trial trial =
      linuxcnc_trial(Dialect::fanuc, kDialectStart + "M49\nG0 X1 Y1 Z5\nM48\nM50 P0\nM2\n");
  EXPECT_TRUE(body(trial).ends_with("G0 X1. Y1.\nG43 H1 Z5.\n")) << body(trial);
  EXPECT_NE(trial.run().program.find("(WARNING: M48 ... M51 ARE OMITTED: THE OVERRIDE SWITCHES "
                                     "REMAIN ACTIVE)\n"),
            std::string::npos);
}

// G10 L2 of the program and #5221 are the same.
TEST(DialectRules, WorkSystemsThatTheProgramMovesAreInTheNumbers) {
  const std::string moved = body(linuxcnc_trial(
      Dialect::fanuc,
      kDialectStart + "G0 X1 Y1\nZ5\nG10 L2 P1 X210 Y250 Z-90\nX0\nG10 L20 P1 X0\nX1\nM2\n"));
  EXPECT_TRUE(moved.ends_with("G43 H1 Z5.\nX10.\nX11.\n")) << moved;
  EXPECT_EQ(refusal(Dialect::fanuc, kDialectStart + "G10 L1 P1 Z50\nM2\n"),
            "plate.ngc:5:1: error: G10 cannot be expressed in fanuc; enter tools and their lengths "
            "at the control");
}

TEST(DialectRules, G49BehindAMoveWithALengthIsRefusedInItsOwnWords) {
  EXPECT_EQ(refusal(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\nG49\nG0 Z60\nM2\n"),
            "plate.ngc:8: error: moves Z after the tool length was cancelled (G49 after G43), "
            "which is safe on the control only after a retract; program G53 G0 Z... before G49; it "
            "cannot be expressed in fanuc");
  EXPECT_EQ(refusal(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\nG53 G0 Z-2\nG49\nG0 Z60\nM2\n"),
            "taken");
}

// The control has the offset that the operator entered; what the program makes of it is in the
// numbers.
TEST(DialectRules, OffsetsThatTheProgramChangesAreInTheNumbers) {
  EXPECT_EQ(body(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\n#5221=210\nG56 X0\nG54 X2\nM2\n"),
            "T1 M6\n"
            "G90 G54 G17 G94 G40 G80 G64\n"
            "S1000 M3\n"
            "G0 X1. Y1.\n"
            "G43 H1 Z5.\n"
            "G56\n"
            "X0.\n"
            "G54\n"
            "X12.\n");
}

TEST(DialectRules, CyclesFromAnUnknownHeightAreRefused) {
  EXPECT_EQ(refusal(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nG98 G81 Z-1 R1 F100\nM2\n"),
            "plate.ngc:6:5: error: a canned cycle returns to an unknown initial Z; program Z in a "
            "rapid first");
}

TEST(DialectRules, HeidenhainMovesWithAToolOnly) {
  EXPECT_EQ(refusal(Dialect::heidenhain, "G21 G90\nG0 X1 Y1\nM2\n"),
            "plate.ngc:2: error: moves before a tool call; the control takes tool axis and length "
            "from the tool call: program T... M6 first; it cannot be expressed in heidenhain");
}

TEST(DialectRules, DwellsBeforeTheFirstMoveAreVerified) {
  EXPECT_EQ(refusal(Dialect::fanuc, "G21 G90\nG4 P1.5\nG0 X1\nM2\n"), "taken");
}

TEST(DialectRules, WhatNoBlockCanExpressIsAssumedInTheFile) {
  const std::string text =
      dialect_trial(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\nG30 Z5\nM2\n").run().program;
  EXPECT_NE(text.find("RAPIDS OF SEVERAL AXES ARE COLLISION-FREE"), std::string::npos) << text;
  EXPECT_NE(text.find("THE SECOND REFERENCE POSITION"), std::string::npos) << text;
}

}  // namespace
}  // namespace servomill::sim::programs::dialect_rules_test
