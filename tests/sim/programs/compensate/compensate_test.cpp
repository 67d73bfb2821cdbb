// Corrected programs: what stays, what changes, and where the tool then goes.
#include "sim/programs/compensate/compensate.h"

#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim::programs::compensate_test {
namespace {

const std::string kNoErrors = "[errors.none]\nEXX = { constant_um = 0.0 }\n";

TEST(Compensate, WithoutErrorsNothingChanges) {
  const std::string program =
      "%\n"
      "(a plate)\n"
      "\n"
      "N10 G21 G90 G17 g40 (modes)\n"
      "T1 M6 G43 H1\n"
      "S12000 M3 ; on\n"
      "G0  X10. Y20.500 Z5\n"
      "G01 Z-2 F300\n"
      "\tX60 F1200 (first side) M8\n"
      "G2 X50 Y30.5 I-10 J0\n"
      "G3 X30 Y50.5 R20\n"
      "G91\n"
      "G1 X-3.25 Y1\n"
      "G90 (MSG, half done) G4 P0.5\n"
      "G20\n"
      "X1.5 Y1.25\n"
      "G93 G1 X1 F20\n"
      "G94 F10\n"
      "G92 X0\n"
      "G1 X.5\n"
      "G92.1\n"
      "G55\n"
      "G21 G64 P0.01 Q0.01\n"
      "G0 X0 Y0\n"
      "G53 G0 Z0\n"
      "M5 M9\n"
      "M30\n"
      "%\n";
  Trial trial(program);
  trial.request.error_file = written("none.toml", kNoErrors);
  const Compensated done = trial.run();
  EXPECT_EQ(without_header(done.program), program);
  EXPECT_EQ(done.summary.points_added, 0u);
  EXPECT_EQ(done.report[2], "nothing to correct");
}

TEST(Compensate, WritesAMacroAsTheBlocksThatRan) {
  const std::string start = "G21 G90 G54\nT1 M6 G43 H1\nG0 X10. Y20. Z5.\n";
  const Trial macro(start +
                    "#1=0\nWHILE[#1GT-2.]DO1\n#1=#1-1.\nG1 Z#1 F200.\nX[40.+#1]\n"
                    "G65 P10 Y30. K#1\nEND1\nM2\nO10\nY#25\nY20. X-#6\nM99\n");
  const Trial plain(start +
                    "G1 Z-1. F200.\nX39.\nY30.\nY20. X1.\nG1 Z-2. F200.\nX38.\nY30.\nY20. X2.\n"
                    "M2\n");
  EXPECT_EQ(without_header(macro.run().program), without_header(plain.run().program));
}

TEST(Compensate, KeepsEverythingThatIsNotMotion) {
  Trial trial(
      "G21 G90 G54\n"
      "T2 M6 G43 H2 (8 mm)\n"
      "\n"
      "S9000 M3\n"
      "G0 X10 Y20 Z5 M8 (to the begin)\n"
      "N40 G1 Z-1 F200 ; plunge\n"
      "(a comment between)\n"
      "G4 P1.\n"
      "M5\n"
      "M2\n");
  EXPECT_EQ(without_header(trial.run().program),
            "G21 G90 G54\n"
            "T2 M6 G43 H2 (8 mm)\n"
            "\n"
            "S9000 M3\n"
            "G0 X10.00777 Y19.95198 Z4.96186 M8 (to the begin)\n"
            "N40 G1 Z-1.03814 X10.00801 Y19.95232 F200 ; plunge\n"
            "(a comment between)\n"
            "G4 P1.\n"
            "M5\n"
            "M2\n");
}

Compensated with_errors(const std::string& program, const std::string& errors) {
  Trial trial(program);
  trial.request.error_file = written("errors.toml", "[errors.of_test]\n" + errors);
  return trial.run();
}

const std::string kStart = "G21 G90 G17\nT1 M6 G43 H1\nG0 X0 Y0 Z5\n";

TEST(Compensate, LinesUnderSkewStayLines) {
  const Compensated done =
      with_errors(kStart + "G1 X300 Y200 F1000\nX0\nM2\n",
                  "EC0Y = { um_per_m = 200.0 }\nEXX = { polynomial_um = [0.0, 0.3] }\n");
  EXPECT_EQ(done.summary.points_added, 0u);
  EXPECT_EQ(done.summary.blocks_after, 3u);
}

// d = a x^2 leaves a L^2 / 4 in the middle of a chord over L.
TEST(Compensate, ParabolasTakeAsFewPointsAsTheToleranceAllows) {
  const Compensated done =
      with_errors(kStart + "G1 X500 F1000\nM2\n", "EYX = { polynomial_um = [0.0, 0.0, 0.004] }\n");
  const double longest = 2.0 * std::sqrt(1.0 / 0.004);  // mm, for the whole tolerance of 1 um
  const double fewest = 500.0 / longest;
  EXPECT_GE(static_cast<double>(done.summary.points_added + 1), fewest);
  EXPECT_LE(static_cast<double>(done.summary.points_added + 1), 1.15 * fewest + 1.0);
}

TEST(Compensate, MaxBlockHoldsOnlyWhereTheCorrectionVaries) {
  Trial trial(kStart + "G1 X100 F1000\nY10\nM2\n");
  trial.request.error_file =
      written("errors.toml", "[errors.of_test]\nEYX = { polynomial_um = [0.0, 1.0] }\n");
  trial.request.max_block = 5.0 * mm;
  EXPECT_EQ(trial.run().summary.points_added, 19u);  // of X; along Y nothing varies
}

TEST(Compensate, ArcsStayArcsWhereTheErrorIsConstant) {
  const std::string arcs =
      "G2 X20 Y0 I10 J0 F500\nG3 X20 Y0 I0 J15\nG18 G2 X30 Z5 I5 K0\nG17 G3 X40 Y10 R10 Z2\n";
  const Compensated done = with_errors(
      kStart + arcs + "M2\n", "EXX = { constant_um = 30.0 }\nEZY = { constant_um = -20.0 }\n");
  EXPECT_EQ(done.summary.arcs_kept, 4u);
  EXPECT_EQ(done.summary.points_added, 0u);
}

TEST(Compensate, ACircleUnderSkewBecomesAFewArcs) {
  const Compensated done =
      with_errors(kStart + "G2 X0 Y0 I40 J0 F500\nM2\n", "EC0Y = { um_per_m = 500.0 }\n");
  EXPECT_EQ(done.summary.arcs_split, 1u);
  EXPECT_LE(done.summary.points_added, 16u);  // lines of 1 um would be some 280
}

TEST(Compensate, ExpressionsBecomeNumbersAndItSaysSo) {
  const Compensated done =
      with_errors("#100=3 #<deep>=[#100+1] (values)\n" + kStart + "G1 Z-#100 F[#100*100]\nM2\n",
                  "EXX = { constant_um = 0.0 }\n");
  EXPECT_NE(done.program.find("(expressions are replaced by numbers)"), std::string::npos);
  EXPECT_NE(done.program.find("#100=3 #<deep>=1 (values)\n"), std::string::npos);
  EXPECT_NE(done.program.find("\nG1 Z-3 F300\n"), std::string::npos) << done.program;
}

// G92 stands where the machine now is: 30 um beside where the program thinks.
TEST(Compensate, ShiftsOfThePositionAreToldWhereItStands) {
  const Compensated done = with_errors(kStart + "G92 X100\nG1 X110 F100\nG53 G0 Z0\nM2\n",
                                       "EXX = { constant_um = 30.0 }\n");
  EXPECT_EQ(without_header(done.program),
            "G21 G90 G17\nT1 M6 G43 H1\nG0 X-0.03 Y0 Z5\nG92 X99.97\nG1 X109.97 F100\nG53 G0 Z0\n"
            "M2\n");
}

TEST(Compensate, LoopsSubroutinesAndPolarWordsBecomeTheirMoves) {
  const Compensated done =
      with_errors(kStart +
                      "o<row> sub\no1 repeat [#1]\nG91 G1 X[10 * 2] F100 (step)\nG90\no1 "
                      "endrepeat\no<row> endsub\n"
                      "o<row> call [2]\no2 if [0]\nG1 X999\no2 endif\nG1 @50 ^90\nM2\n",
                  "EXX = { constant_um = 30.0 }\n");
  EXPECT_EQ(without_header(done.program),
            "G21 G90 G17\nT1 M6 G43 H1\nG0 X-0.03 Y0 Z5\nG91 G1 X20 F100 (step)\nG90\n"
            "G91 G1 X20 F100 (step)\nG90\nG1 X-0.03 Y50\nM2\n");
  EXPECT_TRUE(done.summary.unrolled);
}

TEST(Compensate, InverseTimeIsSharedAmongTheBlocks) {
  const Compensated done = with_errors(kStart + "G93 G1 X200 F2\nG94\nM2\n",
                                       "EYX = { polynomial_um = [0.0, 0.0, 0.01] }\n");
  double minutes = 0.0;
  int blocks = 0;
  for (const Move& move : moves_of(done.program, Trial("M2\n").request)) {
    if (move.kind != MoveKind::feed) continue;
    minutes += (move.s_end - move.s_begin) / move.feed / 60.0;
    ++blocks;
  }
  EXPECT_GT(blocks, 5);
  EXPECT_NEAR(minutes, 0.5, 1e-6);  // of the length that correcting adds: some 1e-8
}

TEST(Compensate, RotaryAxesAloneKeepTheirTime) {
  Trial trial("G21 G90\nT1 M6 G43 H1\nG0 X50 Y0 Z5 B0 C0\nG1 C90 F1800\nX60\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  trial.request.inputs.parameter_file.clear();
  trial.request.work_offsets = {"X=0,Y=0,Z=0,B=0,C=0"};
  trial.request.error_file =
      written("errors.toml", "[errors.of_test]\nEX0C = { constant_um = 20.0 }\n");
  const Compensated done = trial.run();
  controllers::ProgramSetup setup = program_setup(trial.request.inputs, trial.request.program_file);
  double minutes = 0.0;
  AxisWords at = AxisWords::Zero();
  for (const Move& move : controllers::interpret(done.program, "text", setup)) {
    if (!is_motion(move.kind)) continue;
    const double length = move.s_end - move.s_begin;
    const bool turns = move.end_machine[5] != at[5];
    const double way = length > 0.0 ? length : (move.end_machine - at).tail<3>().norm();
    if (move.kind == MoveKind::feed && turns) minutes += way / move.feed / 60.0;
    if (move.kind == MoveKind::feed && !turns) {
      EXPECT_NEAR(move.feed / mm_per_min, 1800.0, 1e-9);
    }
    at = move.end_machine;
  }
  EXPECT_NEAR(minutes, 90.0 / 1800.0, 1e-6);
}

TEST(Compensate, WarnsOfWhatItTakesForGranted) {
  Trial trial("(servomill compensate: part.ngc)\nG21 G90\nG0 X0 Y0 Z0\nM2\n");
  const Compensated done = trial.run();
  ASSERT_GE(done.warnings.size(), 1U);
  EXPECT_EQ(done.warnings[0].message,
            "this program was corrected before and is now corrected again");
}

Trial for_linuxcnc(const std::string& program) {
  Trial trial(program);
  trial.request.inputs.reader = "linuxcnc";
  return trial;
}

TEST(Compensate, RefusesWhatUnrollingOrCorrectingWouldChange) {
  EXPECT_EQ(refusal(Trial("o1 sub\nM73\nG91\no1 endsub\no1 call\nM2\n")),
            "part.ngc:2:1: error: M73 in a subroutine: the saved state belongs to the call, and "
            "subroutines are unrolled");
  EXPECT_EQ(refusal(for_linuxcnc("G0 X0 Y0 Z0\nG28.1\nM2\n")),
            "part.ngc:2:1: error: G28.1 would store the corrected position as a machine position");
  EXPECT_EQ(refusal(for_linuxcnc("G0 X0 Y0 Z0\nG10 L20 P2 X0\nM2\n")),
            "part.ngc:2:1: error: G10 L20 P2 of an inactive work offset cannot be corrected");
  EXPECT_EQ(refusal(for_linuxcnc("%\nG0 X0 Y0 Z0\n%\nG0 X1\nM2\n%\n")),
            "part.ngc:3:1: error: the program ends at this '%', but blocks follow it; remove the "
            "'%', or end the program with M30 before it");
}

TEST(Compensate, RefusesToFeedFromNobodyKnowsWhere) {
  Trial trial("G21 G90\nG0 X0 Z5\nG1 Z-1 F100\nM2\n");
  EXPECT_EQ(refusal(trial),
            "part.ngc:3: error: feeds while the position of Y is unknown, so the errors are "
            "unknown: no earlier block programs it; set the start position with --start Y=...");
  trial.request.start = "Y=10";
  EXPECT_EQ(refusal(trial), "taken");
}

TEST(Compensate, RefusesWorkSystemsThatNobodySaidThePlaceOf) {
  Trial trial("G21 G90\nG53 G0 Z0\nG0 X0 Y0 Z0\nG55 G1 X1 F100\nM2\n");
  trial.request.inputs.parameter_file.clear();
  const auto message = [](const std::string& name, const std::string& where,
                          const std::string& words) {
    return ": error: the work offset " + name + " is unknown" + where +
           ", so the errors are unknown; set it with --work-offset " + name + ":" + words +
           " or --parameter-file (0 is allowed, but not assumed)";
  };
  EXPECT_EQ(refusal(trial), "part.ngc:3" + message("G54", "", "X=...,Y=...,Z=..."));
  trial.request.work_offsets = {"X=0,Y=0,Z=0"};
  EXPECT_EQ(refusal(trial), "part.ngc:4:1" + message("G55", "", "X=...,Y=...,Z=..."));
  trial.request.work_offsets = {"X=0,Y=0,Z=0", "G55:X=200"};
  EXPECT_EQ(refusal(trial), "part.ngc:4:1" + message("G55", " on Y, Z", "Y=...,Z=..."));
  trial.request.work_offsets = {"X=200,Y=200,Z=0", "G55:X=200,Y=300,Z=0,R=10"};
  EXPECT_EQ(refusal(trial), "taken");
}

TEST(Compensate, NeedsNoPlaceOfTheWorkWhereErrorsAreTheSameEverywhere) {
  Trial trial("G21 G90\nG0 X0 Y0 Z0\nG1 X1 F100\nM2\n");
  trial.request.inputs.parameter_file.clear();
  trial.request.error_file = written("same.toml", "[errors.e]\nEXX = { constant_um = 5.0 }\n");
  EXPECT_EQ(refusal(trial), "taken");
  trial.request.error_file = written("other.toml", "[errors.e]\nEXX = { um_per_m = 5.0 }\n");
  EXPECT_NE(refusal(trial), "taken");
}

TEST(Compensate, AddsWorkOffsetsOfOneSystemUpAndRefusesContradictions) {
  const std::string program = "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F100\nM2\n";
  const auto corrected = [&](std::vector<std::string> offsets) {
    Trial trial(program);
    trial.request.inputs.parameter_file.clear();
    trial.request.work_offsets = std::move(offsets);
    return without_header(trial.run().program);
  };
  const std::string whole = corrected({"X=200,Y=250,Z=-100"});
  EXPECT_EQ(corrected({"Y=250,Z=-100", "X=200"}), whole);
  EXPECT_NE(corrected({"X=200,Y=0,Z=0"}), whole);
  Trial trial(program);
  trial.request.work_offsets = {"X=200,Y=250,Z=-100", "X=3"};
  try {
    trial.run();
    ADD_FAILURE() << "taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--work-offset X=3: error: X of G54 is 3 here, but was 200 before");
  }
}

TEST(Compensate, TakesToolLengthsWithoutATable) {
  const std::string program = "G21 G90\nT1 M6\nG43 H1\nG0 X0 Y0 Z0\nG1 X90 F100\nM2\n";
  Trial trial(program);
  const std::string with_table = without_header(trial.run().program);  // 40 mm
  trial.request.inputs.tool_table.clear();
  EXPECT_EQ(refusal(trial),
            "part.ngc:3:5: error: H1: length and diameter of tool 1 are unknown; pass a tool table "
            "with --tools");
  trial.request.tool_lengths = {"1=40"};
  EXPECT_EQ(without_header(trial.run().program), with_table);
  trial.request.tool_lengths = {"1=90"};
  EXPECT_NE(without_header(trial.run().program), with_table);
}

// Axes that the original does not move stay: the correction of X by Y waits for the next feed.
TEST(Compensate, RapidsMoveNoAxisThatTheOriginalDoesNotMove) {
  Trial trial("G21 G90\nG0 X0 Y0 Z0\nG0 Y300\nG1 X1 F100\nM2\n");
  trial.request.error_file = written("skew.toml", "[errors.e]\nEC0Y = \"100 um/m\"\n");
  EXPECT_EQ(without_header(trial.run().program),
            "G21 G90\n"
            "G0 X0.025 Y0 Z0\n"
            "G0 Y300\n"
            "G1 X0.055 F100\n"
            "X1.055\n"
            "M2\n");
}

// The error is 5 um on either side of the mean: each way gets its own correction, and each change
// of direction a step of 10 um.
TEST(Compensate, ReversalIsCompensatedForTheDirectionOfTravel) {
  Trial trial("G21 G90\nG0 X0 Y0 Z0\nG1 X10 F100\nX20\nX0\nY5\nM2\n");
  trial.request.error_file =
      written("play.toml", "[errors.e]\nEXX.reversal = { width_um = 10.0, distance_mm = 0.02 }\n");
  const Compensated done = trial.run();
  EXPECT_EQ(without_header(done.program),
            "G21 G90\n"
            "G0 X0 Y0 Z0\n"
            "G1 X-0.005 F100\n"
            "X9.995\n"
            "X19.995\n"
            "X20.005\n"
            "X0.005\n"
            "Y5\n"
            "M2\n");
  EXPECT_EQ(
      done.report[2],
      "2 reversals compensated; while each develops, over 0.02 mm at most, up to 10.0 um remain");
}

TEST(Compensate, ReversalOnAnArcIsCompensatedWhereTheAxisTurns) {
  Trial trial("G21 G90 G17\nG0 X0 Y0 Z0\nG0 X10\nX20\nG3 X10 Y10 I-10 J0 F100\nM2\n");
  trial.request.error_file =
      written("play.toml", "[errors.e]\nEXX.reversal = { width_um = 10.0, distance_mm = 0.02 }\n");
  EXPECT_EQ(without_header(trial.run().program),
            "G21 G90 G17\n"
            "G0 X0 Y0 Z0\n"
            "G0 X9.995\n"
            "X19.995\n"
            "G1 X20.005 Y0 F100\n"
            "G3 X10.005 Y10 I-10 J0\n"
            "M2\n");
  Trial whole("G21 G90 G17\nG0 X0 Y0 Z0\nG0 X10\nX20\nG3 X20 Y0 I-10 J0 F100\nM2\n");
  whole.request.error_file = trial.request.error_file;
  EXPECT_EQ(without_header(whole.run().program),
            "G21 G90 G17\n"
            "G0 X0 Y0 Z0\n"
            "G0 X9.995\n"
            "X19.995\n"
            "G1 X20.005 Y0 F100\n"
            "G3 X0.005 I-10 J0\n"
            "G1 X-0.005\n"
            "G3 X19.995 I10 J0\n"
            "M2\n");
}

TEST(Compensate, ReversalBeforeAnAxisHasMovedIsReported) {
  Trial trial("G21 G90\nG0 X0 Y0 Z0\nG1 Y10 F100\nM2\n");
  trial.request.error_file =
      written("play.toml", "[errors.e]\nEXX.reversal = { width_um = 10.0, distance_mm = 0.02 }\n");
  const Compensated done = trial.run();
  EXPECT_EQ(done.report[2],
            "the direction of travel is not known from line 3 on until each axis has moved: the "
            "mean of both is used there, up to 5.0 um remain");
}

// The machine is known, turned or not: what is missing are positions of its axes.
TEST(Compensate, RefusesMovesOfTheTip) {
  const std::string program =
      "G21 G90 G17 G54\nT1 M6\nS1000 M3\nG0 X10 Y10 A10 C0\nG43.4 H1 Z20\nG1 Z5 F300\nM2\n";
  const std::string remedy = "have the CAM system, or servomill post, output axis positions";
  Trial trial(program);
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
  trial.request.error_file = written("none.toml", kNoErrors);
  trial.request.inputs.parameter_file.clear();
  trial.request.work_offsets = {"X=0,Y=0,Z=-90,A=0,C=0"};
  trial.request.retract_Z = 0.0;
  trial.request.program_number = 7;
  EXPECT_EQ(refusal(trial),
            "part.ngc:5: error: moves under TCP control or in a tilted work plane cannot be "
            "compensated; " +
                remedy);
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens, Dialect::heidenhain}) {
    trial.request.dialect = dialect;
    EXPECT_EQ(refusal(trial),
              fmt::format("part.ngc:5:1: error: G43.4 cannot be expressed in {}; {}",
                          kDialects[static_cast<std::size_t>(dialect)], remedy));
  }
}

}  // namespace
}  // namespace servomill::sim::programs::compensate_test
