// Things that programs for other controls may never do, whatever is in force: one test for
// each way in which a written program once did what the original does not.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::dialect_rules_test {
namespace {

const std::string kStart = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\n";

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
  EXPECT_EQ(body(Dialect::fanuc, kStart + "G0 X1 Y1 Z5\nG53 G0 Z0\nM5\nT2 M6\nM2\n"),
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
  const std::string home = kStart + "G0 X1 Y1 Z5\nG28 G91 Z0\nG90 G0 X2\nZ5\nM2\n";
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
  EXPECT_EQ(refusal(Dialect::fanuc, kStart + "G28\nM2\n"),
            "plate.ngc:5: error: G28 of other axes than Z goes to places that LinuxCNC has stored; "
            "write G53 G0 X... Y... "
            "with the places of this machine; that cannot be expressed for fanuc");
}

TEST(DialectRules, PolarMovesAreWrittenWhileZIsUnknown) {
  EXPECT_EQ(body(Dialect::fanuc, "G21 G90\nG0 X1 Y1\nG91 @1\nM2\n"),
            "G54\n"
            "G0 X1. Y1.\n"
            "X1.707 Y1.707\n");
}

// Macros of builders move axes and leave modes behind.
TEST(DialectRules, NothingSurvivesAToolChange) {
  EXPECT_EQ(
      body(Dialect::fanuc, kStart + "G0 X10 Y20 Z5\nM8\nG1 Z-1 F100\nX20\nG0 Z50\nT2 M6\nG43 H2\n"
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

// Axes may run at their own rates: up before across, across before down.
TEST(DialectRules, RapidsInZAndOtherAxesAreTwo) {
  EXPECT_EQ(body(Dialect::siemens, kStart + "G0 X1 Y1 Z5\nX20 Z10\nX30 Z2\nX40 Z2\nM2\n"),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "S1000 M3\n"
            "G0 X1 Y1\n"
            "D1 Z5\n"
            "Z10\n"
            "X20\n"
            "X30\n"
            "Z2\n"
            "X40\n");
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
      refusal(Dialect::fanuc, kStart + "G0 X1 Y1 Z5\nG1 Z-1 F100\nG49\nG1 X2 Z-2\nM2\n"),
      "plate.ngc:8: error: moves Z without the tool length that was in force (G49 after G43), "
      "which "
      "the control cancels safely on a retract only; write G53 G0 Z... before G49; that cannot be "
      "expressed for fanuc");
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
  const std::string program = kStart + "G0 X1 Y1 Z5\nG95 G1 X2 F0.05\nG94 X3 F100\nM2\n";
  const auto has = [&](Dialect dialect, const std::string& text) {
    return body(dialect, program).find(text) != std::string::npos;
  };
  EXPECT_TRUE(has(Dialect::fanuc, "G95 G1 X2. F0.05\nG94 X3. F100.\n"));
  EXPECT_TRUE(has(Dialect::siemens, "G95 G1 X2 F0.05\nG94 X3 F100\n"));
  EXPECT_TRUE(has(Dialect::heidenhain, "L X+2 FU0.05\nL X+3 F100\n"));
}

TEST(DialectRules, ToleranceOfG64IsLeftOutForFanucWithOneWarning) {
  const Trial trial = dialect_trial(
      Dialect::fanuc, kStart + "G0 X1 Y1 Z5\nG64 P0.01\nG1 X2 F100\nG64 P0.02\nX3\nM2\n");
  EXPECT_NE(body(trial).find("G64\nG1 X2. F100.\nG64\nX3.\n"), std::string::npos) << body(trial);
  std::size_t warned = 0;
  for (const Fault& fault : trial.run().warnings) {
    warned += fault.message.starts_with("G64 P: the tolerance is left out") ? 1 : 0;
  }
  EXPECT_EQ(warned, 1U);
}

TEST(DialectRules, ArcsStayArcs) {
  const std::string program = kStart +
                              "G0 X10 Y0 Z5\nG1 Z0 F100\nG2 X0 Y-10 I-10 J0\nG3 X0 Y-10 I0 J10\n"
                              "G3 X10 Y0 Z-1 I0 J10\nG18 G2 X0 Z-11 I-10 K0\nM2\n";
  const auto from = [&](Dialect dialect, const std::string& first) {
    const std::string text = body(dialect, program);
    const std::size_t begin = text.find(first);
    return begin == std::string::npos ? text : text.substr(begin, 100);
  };
  EXPECT_TRUE(from(Dialect::fanuc, "G2 ")
                  .starts_with("G2 X0. Y-10. I-10. J0.\n"
                               "G3 X0. Y-10. I0. J10.\n"
                               "X10. Y0. Z-1. I0. J10. F99.798\n"
                               "G1 X"));
  EXPECT_TRUE(from(Dialect::siemens, "G2 ")
                  .starts_with("G2 X0 Y-10 I-10 J0\n"
                               "G3 X0 Y-10 I0 J10\n"
                               "X10 Y0 Z-1 I0 J10\n"
                               "CIP X-7.07107 Z6.07107 "));
  EXPECT_TRUE(from(Dialect::heidenhain, "CC ")
                  .starts_with("CC X+0 Y+0\n"
                               "C X+0 Y-10 DR-\n"
                               "CC X+0 Y+0\n"
                               "C X+0 Y-10 DR+\n"
                               "CC X+0 Y+0\n"
                               "CP IPA+90 Z-1 DR+\n"
                               "L X"));
}

std::vector<std::string> warnings_about_arcs(const Trial& trial) {
  std::vector<std::string> out;
  for (const Fault& fault : trial.run().warnings) {
    if (fault.message.starts_with("arcs in G18")) out.push_back(fault.message);
  }
  return out;
}

const std::string kArcsInAllPlanes = kStart +
                                     "G0 X10 Y0 Z5\nG1 Z0 F100\nG18 G3 X0 Z10 I-10 K0\n"
                                     "G19 G2 Y10 Z0 J0 K-10\nG2 Y10 Z0 J-10 K0\n"
                                     "G18 G2 X10 Y11 Z10 I10 K0\nM2\n";

// G18 and G19 exchange the components of the tool length where SD42940 is 0. CIP needs no plane
// (6FC5398-2EP40-0BA0 p. 750, p. 198); a circle has its end where it begins and becomes two.
TEST(DialectRules, ArcsOfSiemensInOtherPlanesGoThroughAPoint) {
  const Trial trial = dialect_trial(Dialect::siemens, kArcsInAllPlanes);
  const std::string text = body(trial);
  const std::size_t begin = text.find("CIP");
  ASSERT_NE(begin, std::string::npos) << text;
  EXPECT_TRUE(
      text.substr(begin).starts_with("CIP X-7.07107 Z-7.07107 I1=AC(3.82683) J1=AC(0) "
                                     "K1=AC(-9.2388)\n"
                                     "X0 Z10 I1=AC(-9.2388) J1=AC(0) K1=AC(3.82683)\n"
                                     "Y10 Z0 I1=AC(0) J1=AC(7.07107) K1=AC(7.07107)\n"
                                     "Y-10 Z0 I1=AC(0) J1=AC(0) K1=AC(-10)\n"
                                     "Y10 Z0 I1=AC(0) J1=AC(0) K1=AC(10)\n"
                                     "G1 X"))
      << text.substr(begin, 400);
  EXPECT_EQ(text.find("G18"), std::string::npos);
  EXPECT_EQ(text.find("G19"), std::string::npos);
  EXPECT_EQ(warnings_about_arcs(trial),
            std::vector<std::string>{"arcs in G18 and G19 written as lines: 1; G18 may give the "
                                     "tool length to another axis (SD42940), and CIP makes no "
                                     "helix"});
}

TEST(DialectRules, ArcsInOtherPlanesAreLinesWhereTheLengthMayFollow) {
  EXPECT_EQ(warnings_about_arcs(dialect_trial(Dialect::fanuc, kArcsInAllPlanes)),
            std::vector<std::string>{"arcs in G18 and G19 written as lines: 4; the tool length may "
                                     "follow a change of the plane (No. 5001#1, TLB, may be 1; "
                                     "--without length-b)"});
  EXPECT_EQ(warnings_about_arcs(dialect_trial(Dialect::heidenhain, kArcsInAllPlanes)),
            std::vector<std::string>{"arcs in G18 and G19 written as lines: 4; circles lie in the "
                                     "plane that the tool axis determines (TNC 407 manual p. "
                                     "5-20)"});
  EXPECT_TRUE(
      warnings_about_arcs(dialect_trial(Dialect::fanuc, kStart + "G0 X1 Y1 Z5\nM2\n")).empty());
}

// The errors of the router move the third axis, too: a circle through a point may be tilted by 1
// um.
TEST(DialectRules, CorrectedArcsInOtherPlanesAreVerified) {
  Trial trial = dialect_trial(Dialect::siemens, kArcsInAllPlanes);
  trial.request.error_file.clear();
  EXPECT_EQ(warnings_about_arcs(trial).size(), 1U);
}

// Its digits would make a full circle of it, or nothing.
TEST(DialectRules, ArcsShorterThanTheDigitsAreLines) {
  const std::string text =
      body(Dialect::fanuc,
           kStart + "G0 X10 Y0 Z5\nG1 Z0 F100\nG3 X10 Y0.0004 I-10 J0.0002\nG1 X0 Y5\nM2\n");
  EXPECT_EQ(text.find("G3 "), std::string::npos) << text;
}

TEST(DialectRules, NumbersStayWithinTheFormatsOfTheControl) {
  EXPECT_EQ(refusal(Dialect::heidenhain, kStart + "G4 P4000.\nM2\n"),
            "plate.ngc:5: error: dwells for 4000 s, more than 3600 s; that cannot be expressed for "
            "heidenhain");
  EXPECT_EQ(refusal(Dialect::heidenhain, kStart + "G0 X200000 Y0\nM2\n"),
            "plate.ngc:5: error: goes to X200000; at most 99999.9999 is allowed; that cannot be "
            "expressed for heidenhain");
  EXPECT_EQ(refusal(Dialect::fanuc, "G21 G90\nG53 G0 Z-1.0005\nM2\n"),
            "plate.ngc:2: error: goes to Z-1.0005 of the machine, which has more digits than the "
            "resolution of 1 um (--resolution); that cannot be expressed for fanuc");
}

TEST(DialectRules, LongProgramsNumberEveryThousandthBlock) {
  std::string program = kStart + "G0 X0 Y0 Z5\nG1 Z0 F100\n";
  for (int i = 1; i <= 10000; ++i) program += "X" + std::to_string(i % 2) + "\n";
  const std::string text = said(Dialect::fanuc, program + "M2\n");
  EXPECT_NE(text.find("\nN11 "), std::string::npos);
  EXPECT_EQ(text.find("\nN12 "), std::string::npos);
}

TEST(DialectRules, WhatTheOperatorHasToMakeSureOfIsWrittenAndWarnedOf) {
  const Trial trial = dialect_trial(Dialect::fanuc, kStart + "G53 G0 Z0\nG0 X1 Y1\nZ5\nM2\n");
  const Compensated done = trial.run();
  const auto warned = [&](const std::string& message) {
    return std::any_of(done.warnings.begin(), done.warnings.end(),
                       [&](const Fault& fault) { return fault.message == message; });
  };
  EXPECT_TRUE(warned("assumes that T and M6 in one block change the tool, T first"));
  EXPECT_TRUE(warned("assumes that H1 holds the length of tool 1"));
  EXPECT_TRUE(
      warned("assumes that machine coordinates count from the same zero as in the original"));
  EXPECT_NE(done.program.find("(ASSUMED: H1 HOLDS THE LENGTH OF TOOL 1)\n"), std::string::npos);
  Trial heidenhain = dialect_trial(Dialect::heidenhain, kStart + "G0 X1 Y1\nM2\n");
  EXPECT_NE(heidenhain.run().program.find(
                "; assumed: the active preset is G54\n"
                "6 ; assumed: CYCL DEF 7, 8 and 10 end shift, mirror image and rotation\n"),
            std::string::npos)
      << heidenhain.run().program;
  heidenhain.request.preset = 3;
  const std::string text = heidenhain.run().program;
  EXPECT_EQ(text.find("active preset"), std::string::npos);
  EXPECT_NE(text.find("CYCL DEF 247 DATUM SETTING ~\n    Q339=+3 ; DATUM NUMBER\n"),
            std::string::npos)
      << text;
}

TEST(DialectRules, RotaryAxesBesideLinearOnesFeedByTime) {
  Trial trial =
      dialect_trial(Dialect::heidenhain, kStart + "G0 X0 Y0 B0 C0\nZ5\nG1 X10 C90 F600\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  const std::string text = body(trial);
  EXPECT_NE(text.find("L X+10 C+90 FT1\n"), std::string::npos) << text;
  EXPECT_NE(trial.run().program.find("PLANE RESET STAY"), std::string::npos);
}

TEST(DialectRules, SmoothingHoldsForFeedsOnly) {
  const auto smoothed = [](Dialect dialect) {
    Trial trial = dialect_trial(dialect, kStart +
                                             "G0 X1 Y1\nZ5\nG1 Z-1 F100\nX2\nG0 Z40\nG53 G0 Z0\n"
                                             "G0 X5\nZ5\nG1 X9\nM2\n");
    trial.request.smoothing = 10e-6;
    const Compensated done = trial.run();
    EXPECT_TRUE(done.report[2].starts_with(
        "smoothing: the control may leave the corrected path by 10 um at corners of short blocks; "
        "simulated: by "))
        << done.report[2];
    const std::string text = body(trial);
    return text.substr(text.find("G54") == std::string::npos ? 0 : text.find("Z5"));
  };
  EXPECT_EQ(smoothed(Dialect::fanuc),
            "Z5.\n"
            "G5.1 Q1\n"
            "G1 Z-1. F100.\n"
            "X2.\n"
            "G0 Z40.\n"
            "G5.1 Q0\n"
            "G90 G49 G53 G0 Z0.\n"
            "X5.\n"
            "G43 H1 Z5.\n"
            "G5.1 Q1\n"
            "G1 X9.\n"
            "G5.1 Q0\n");
  EXPECT_EQ(smoothed(Dialect::siemens),
            "Z5\n"
            "CYCLE832(0.01,1,1)\n"
            "G1 Z-1 F100\n"
            "X2\n"
            "G0 Z40\n"
            "CYCLE832(0,0,1)\n"
            "SUPA G0 Z0 D0\n"
            "X5\n"
            "D1 Z5\n"
            "CYCLE832(0.01,1,1)\n"
            "G1 X9\n"
            "CYCLE832(0,0,1)\n");
  EXPECT_NE(smoothed(Dialect::heidenhain)
                .find("CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.01\nL Z-1 F100\n"),
            std::string::npos);
}

// Axes without ends may be modulo axes: a plain angle leaves the way to the builder, and one
// outside 0 ... 360 is another angle. B of this machine has ends, C has none.
TEST(DialectRules, EndlessAxesOfSiemensSayTheirWay) {
  Trial trial = dialect_trial(Dialect::siemens,
                              "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B-30 C350\nC10\nC-40\nC400\nC20\n"
                              "G55 C30\nM0\nC-10\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_EQ(body(trial),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "TRAFOOF\n"
            "G0 X1 Y1 B-30 C=AC(350)\n"
            "C=AC(10)\n"
            "C=IC(-50)\n"
            "C=IC(440)\n"
            "C=IC(-380)\n"
            "G55\n"
            "C=AC(30)\n"
            "M0\n"
            "C-10\n");
}

// Below half a turn a control whose axes roll over and one whose axes count go the same way.
TEST(DialectRules, EndlessAxesOfFanucTurnByLessThanHalfATurn) {
  const std::string start = "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B0 C350\n";
  Trial trial = dialect_trial(Dialect::fanuc, start + "C500\nM0\nC10\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_NE(body(trial).find("C350.\nC500.\nM0\nC10.\n"), std::string::npos) << body(trial);
  trial.request.program_file = written("plate.ngc", start + "C100\nM2\n");
  EXPECT_EQ(refusal(trial),
            "plate.ngc:4: error: rotates C by 250 deg in one block, for which a control whose axes "
            "roll over (No. 1008#0, ROA, is 1) takes the shorter way; divide it, or give --without "
            "rollover if ROA is 0; that cannot be expressed for fanuc");
  trial.request.without = {"rollover"};
  EXPECT_NE(body(trial).find("C350.\nC100.\n"), std::string::npos) << body(trial);
}

// G18 and G19 are in force for arcs only.
TEST(DialectRules, ArcsOfFanucInOtherPlanesAreOnTheUsersWord) {
  Trial trial = dialect_trial(Dialect::fanuc, kArcsInAllPlanes);
  trial.request.without = {"length-b"};
  const std::string text = body(trial);
  EXPECT_TRUE(text.substr(std::min(text.find("G18"), text.size()))
                  .starts_with("G18 G3 X0. Z10. I-10. K0.\n"
                               "G19 G2 Y10. Z0. J0. K-10.\n"
                               "Y10. Z0. J-10. K0.\n"
                               "G18 X10. Y11. Z10. I10. K0. F99.977\n"))
      << text;
  EXPECT_TRUE(warnings_about_arcs(trial).empty());
  const std::string all = trial.run().program;
  EXPECT_NE(all.find("(ASSUMED: THE TOOL LENGTH ACTS ALONG Z IN EVERY PLANE [NO. 5001#1, TLB, IS "
                     "0])\n"),
            std::string::npos)
      << all;
  trial.request.program_file =
      written("plate.ngc", kStart + "G0 X10 Y0 Z5\nG1 Z0 F100\nG18 G3 X0 Z10 I-10 K0\nG1 X5\nM2\n");
  EXPECT_NE(body(trial).find("K0.\nG17 G1 X5.\n"), std::string::npos) << body(trial);
}

TEST(DialectRules, CodesThatTheControlDoesNotHaveAreLeftOut) {
  Trial trial = dialect_trial(Dialect::fanuc, kStart + "G0 X1 Y1 Z5\nM2\n");
  trial.request.without = {"polar", "scaling", "mirror", "surface-speed", "preset"};
  const std::string text = said(trial);
  EXPECT_NE(text.find("N1 G21\nN2 G17 G40 G64 G80 G90 G94\nN3 G69\nN4 G52 X0. Y0. Z0.\nN5 G90 G49 "
                      "G53 G0 Z-2.\n"),
            std::string::npos)
      << text;
  EXPECT_NE(trial.run().program.find("(ASSUMED: NO G92 HAS SHIFTED THE WORK SYSTEMS, SO THAT G92.1 "
                                     "IS LEFT OUT)\n"),
            std::string::npos);
  trial.request.dialect = Dialect::siemens;
  EXPECT_THROW(trial.run(), InputError);
}

// Any row of the preset table, verified.
TEST(DialectRules, PresetsOfAnyNumberAreVerified) {
  for (const int preset : {0, 1, 10, 9999}) {
    Trial trial = dialect_trial(Dialect::heidenhain, kStart + "G0 X1 Y1 Z5\nM2\n");
    trial.request.preset = preset;
    EXPECT_NE(said(trial).find(fmt::format("Q339=+{} ;", preset)), std::string::npos);
  }
}

// M60 is the builder's: the operator exchanges the pallets, from a height that nobody knows.
TEST(DialectRules, PalletsAreExchangedByTheOperator) {
  const Trial trial = dialect_trial(Dialect::siemens,
                                    kStart + "G0 X1 Y1 Z5\nG0 Z50\nM60\nG0 Z5\nG1 Z-1 F100\nM2\n");
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
      linuxcnc_trial(Dialect::fanuc, kStart + "M49\nG0 X1 Y1 Z5\nM48\nM50 P0\nM2\n");
  EXPECT_TRUE(body(trial).ends_with("G0 X1. Y1.\nG43 H1 Z5.\n")) << body(trial);
  EXPECT_NE(
      trial.run().program.find("(WARNING: M48 ... M51 ARE LEFT OUT: THE OVERRIDE SWITCHES STAY "
                               "THE OPERATOR'S)\n"),
      std::string::npos);
}

// G10 L2 of the program and #5221 are the same.
TEST(DialectRules, WorkSystemsThatTheProgramMovesAreInTheNumbers) {
  const std::string moved = body(linuxcnc_trial(
      Dialect::fanuc,
      kStart + "G0 X1 Y1\nZ5\nG10 L2 P1 X210 Y250 Z-90\nX0\nG10 L20 P1 X0\nX1\nM2\n"));
  EXPECT_TRUE(moved.ends_with("G43 H1 Z5.\nX10.\nX11.\n")) << moved;
  EXPECT_EQ(
      refusal(Dialect::fanuc, kStart + "G10 L1 P1 Z50\nM2\n"),
      "plate.ngc:5:1: error: G10 cannot be expressed for fanuc; enter tools and their lengths "
      "at the control");
}

TEST(DialectRules, G49BehindAMoveWithALengthIsRefusedInItsOwnWords) {
  EXPECT_EQ(
      refusal(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\nG49\nG0 Z60\nM2\n"),
      "plate.ngc:8: error: moves Z without the tool length that was in force (G49 after G43), "
      "which the control cancels safely on a retract only; write G53 G0 Z... before G49; that "
      "cannot be expressed for fanuc");
  EXPECT_EQ(refusal(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\nG53 G0 Z-2\nG49\nG0 Z60\nM2\n"),
            "taken");
}

// A circle of short lines: smoothed by more it takes less time, and leaves the path by as much.
TEST(DialectRules, SmoothingIsSimulated) {
  std::string program = kStart + "G0 X20 Y0\nZ5\nG1 Z-1 F3000\n";
  for (int i = 1; i <= 60; ++i) {
    program += fmt::format("X{:.4f} Y{:.4f}\n", 20.0 * std::cos(i * 6.0 * deg),
                           20.0 * std::sin(i * 6.0 * deg));
  }
  Trial trial = dialect_trial(Dialect::fanuc, program + "M2\n");
  const auto numbers = [&](double smoothing) {
    trial.request.smoothing = smoothing;
    const std::string line = trial.run().report[2];
    std::smatch match;
    EXPECT_TRUE(std::regex_search(
        line, match,
        std::regex("simulated: by ([0-9.]+) um, ([0-9.]+) s at feed; held to 1 um: ([0-9.]+) s$")))
        << line;
    return std::array<double, 3>{std::stod(match[1]), std::stod(match[2]), std::stod(match[3])};
  };
  const auto [by_10, time_10, held_10] = numbers(10e-6);
  const auto [by_50, time_50, held_50] = numbers(50e-6);
  EXPECT_GT(by_10, 1.0);
  EXPECT_LE(by_10, 10.0);
  EXPECT_LE(by_50, 50.0);
  EXPECT_GE(by_50, by_10);
  EXPECT_LT(time_10, held_10);
  EXPECT_LE(time_50, time_10);
  EXPECT_EQ(held_10, held_50);
  trial.request.machine_file = written("ten.toml", "structure = \"[w b X Y Z (C1) t]\"\n");
  EXPECT_NE(
      trial.run().report[2].find("(not simulated: the machine file gives no v_max, a_max, j_max)"),
      std::string::npos);
}

TEST(DialectRules, BlocksThatChangeTheToolLengthAreLines) {
  const std::string program = kStart + "G0 X10 Y0\nZ5\nG53 G0 Z0\nG3 X0 Y10 Z20 I-10 J0 F100\nM2\n";
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens}) {
    const std::string text = body(dialect, program);
    EXPECT_EQ(text.find("G3 "), std::string::npos) << text;
  }
}

// G54 and tool 1 have Z48 at the machine's Z-2.
TEST(DialectRules, RetractsFromTheirOwnHeightAreWrittenAndVerified) {
  EXPECT_EQ(refusal(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\nZ48\nM2\n"), "taken");
}

// The control has the offset that the operator entered; what the program makes of it is in the
// numbers.
TEST(DialectRules, OffsetsThatTheProgramChangesAreInTheNumbers) {
  EXPECT_EQ(body(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\n#5221=210\nG56 X0\nG54 X2\nM2\n"),
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
  EXPECT_EQ(refusal(Dialect::fanuc, kStart + "G0 X1 Y1\nG98 G81 Z-1 R1 F100\nM2\n"),
            "plate.ngc:6:5: error: a canned cycle from a Z that is not known, to which it goes "
            "back; name Z in a rapid before");
}

TEST(DialectRules, HeidenhainMovesWithAToolOnly) {
  EXPECT_EQ(
      refusal(Dialect::heidenhain, "G21 G90\nG0 X1 Y1\nM2\n"),
      "plate.ngc:2: error: moves before a tool is called; the control takes axis and length of "
      "the tool called: write T... M6 before; that cannot be expressed for heidenhain");
}

TEST(DialectRules, DwellsBeforeTheFirstMoveAreVerified) {
  EXPECT_EQ(refusal(Dialect::fanuc, "G21 G90\nG4 P1.5\nG0 X1\nM2\n"), "taken");
}

// A start given for LinuxCNC holds there; for other controls Z retracts first.
TEST(DialectRules, TheStartOfZIsUnknownBehindTheRetract) {
  Trial trial = dialect_trial(Dialect::fanuc, "G21 G90\nG1 X1 F100\nM2\n");
  trial.request.start = "X=0,Y=0,Z=0";
  EXPECT_EQ(refusal(trial),
            "plate.ngc:2: error: feeds while the position of Z is not known: no block since the "
            "start, the last tool change or the last stop names it; name it in a rapid");
  trial.request.dialect = Dialect::linuxcnc;
  EXPECT_EQ(refusal(trial), "taken");
}

// The errors of a trial for which the place matters.
Trial with_errors(Dialect dialect, const std::string& program) {
  Trial trial = dialect_trial(dialect, program);
  trial.request.error_file = written("scale.toml", "[errors.scale]\nEXX = { um_per_m = 100.0 }\n");
  return trial;
}

TEST(DialectRules, RetractsOutsideTheTravelAreRefused) {
  Trial trial = with_errors(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\nM2\n");
  trial.request.retract_Z = 50 * mm;
  try {
    trial.run();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--retract Z=50: error: is outside the travel of Z, -150 ... 0 mm");
  }
}

// G54 and tool 1 have Z48 at the machine's Z-2.
TEST(DialectRules, RetractsThatGoDownAreRefused) {
  const std::string program = kStart + "G0 X1 Y1\nZ45\nZ5\nM2\n";
  EXPECT_EQ(refusal(with_errors(Dialect::fanuc, program)), "taken");
  Trial trial = with_errors(Dialect::siemens, program);
  trial.request.retract_Z = -60 * mm;
  EXPECT_EQ(refusal(trial),
            "plate.ngc:6: error: goes to Z-5.000 of the machine, above the height "
            "to retract to, Z-60; give a higher --retract, or check --work-offset "
            "and the tool length");
}

// Verification takes a rapid across whether its axes arrive together or not: what is beside its
// line is the user's word. Siemens moves along it where G64 is in force ([P] p. 181).
TEST(DialectRules, RapidsThatMayLeaveTheirLineAreTheUsersWord) {
  const auto is_assumed = [](Dialect dialect, const std::string& moves) {
    const std::string written = dialect_trial(dialect, kStart + moves + "M2\n").run().program;
    std::string text;
    for (const char c : written) text += static_cast<char>(std::tolower(c));
    return text.find("rapids of several axes meet nothing, also off their line") !=
           std::string::npos;
  };
  for (const Dialect dialect : {Dialect::fanuc, Dialect::heidenhain}) {
    EXPECT_TRUE(is_assumed(dialect, "G0 X1 Y1\nZ5\n"));
    EXPECT_FALSE(is_assumed(dialect, "G0 X1\nY1\nZ5\nG1 X2 Y2 F100\n"));
  }
  EXPECT_FALSE(is_assumed(Dialect::siemens, "G0 X1 Y1\nZ5\n"));
  EXPECT_TRUE(is_assumed(Dialect::siemens, "G61.1\nG0 X1 Y1\nZ5\n"));
}

TEST(DialectRules, WhatNoBlockCanExpressIsAssumedInTheFile) {
  const std::string text =
      dialect_trial(Dialect::fanuc, kStart + "G0 X1 Y1\nZ5\nG30 Z5\nM2\n").run().program;
  EXPECT_NE(text.find("RAPIDS OF SEVERAL AXES MEET NOTHING"), std::string::npos) << text;
  EXPECT_NE(text.find("THE SECOND REFERENCE POSITION"), std::string::npos) << text;
}

}  // namespace
}  // namespace servomill::sim::dialect_rules_test
