// Modes and positions of written programs that the control takes from blocks before: path modes of
// canned cycles, ends of helices, turns of endless axes.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::written_paths_test {
namespace {

const std::string kStart = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X10 Y10 Z20\n";

// Behind the lines of kStart.
std::string for_linuxcnc(const std::string& program) {
  Trial trial(kStart + program, "plate.ngc");
  trial.request.error_file = written("none.toml", "[errors.none]\nEXX = { constant_um = 0.0 }\n");
  const std::string text = without_header(trial.run().program);
  return text.substr(kStart.size());
}

// interp_cycles.cc, convert_cycle: the rapid to the height of R runs in the mode of the program,
// everything else under CANON_EXACT_PATH.
TEST(WrittenPathMode, OfACycleIsExactPath) {
  EXPECT_EQ(for_linuxcnc("G61.1\nG1 X20 F300\nG99 G81 X30 Z-2 R2 F200\nX40\nG80\nG0 Z20\nM2\n"),
            "G61.1\n"
            "G1 X20 F300\n"
            "G61\n"
            "G99 G0 X30 F200\n"
            "Z2\n"
            "G1 Z-2\n"
            "G0 Z2\n"
            "X40\n"
            "G1 Z-2\n"
            "G0 Z2\n"
            "G61.1\n"
            "G80\n"
            "G0 Z20\n"
            "M2\n");
}

TEST(WrittenPathMode, BehindACycleIsThatOfTheProgram) {
  const std::string G64 = for_linuxcnc("G20\nG64 P0.001 Q0.002\nG99 G81 X3 Z-.1 R.1 F8\nG80\nM2\n");
  EXPECT_NE(G64.find("G64 P0.001 Q0.002\nG80\n"), std::string::npos) << G64;
  const std::string G61 = for_linuxcnc("G61\nG99 G81 X30 Z-2 R2 F200\nG80\nM2\n");
  EXPECT_EQ(G61.find("G61\n"), G61.rfind("G61\n")) << G61;
}

TEST(WrittenPathMode, ThatNobodyHasNamedIsAssumedBehindACycle) {
  Trial trial(kStart + "G99 G81 X30 Z-2 R2 F200\nG80\nM2\n", "plate.ngc");
  const Compensated done = trial.run();
  EXPECT_NE(done.program.find("\nG64\nG80\n"), std::string::npos) << done.program;
  const std::string assumed =
      "assumes that G64 without a tolerance is active at the start (no other path mode in "
      "RS274NGC_STARTUP_CODE): it is restored after canned cycles";
  EXPECT_TRUE(std::any_of(done.warnings.begin(), done.warnings.end(),
                          [&](const Fault& one) { return one.message == assumed; }));
}

TEST(WrittenPathMode, BesideACycleIsRefused) {
  Trial trial(kStart + "G64 G99 G81 X30 Z-2 R2 F200\nM2\n", "plate.ngc");
  EXPECT_EQ(refusal(trial),
            "plate.ngc:6:1: error: G64 with a canned cycle, which runs under G61: program it in a "
            "separate block");
}

// A helix of Heidenhain's ends where its angle about the written centre leads it, beside the grid:
// one circle behind it, back to the grid, would be none.
TEST(WrittenHelix, LeavesNoCircleOpen) {
  Trial trial = dialect_trial(Dialect::heidenhain,
                              "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X14.94 Y69.03 Z5\n"
                              "G1 Z-3 F900\nG2 X14.642 Y73.657 Z-6.21 I-0.342 J2.301\n"
                              "G2 I-0.616 J-1.811\nG1 Y80\nM2\n");
  EXPECT_NE(body(trial).find("CC X+14.598 Y+71.331\n"
                             "CP IPA-189.5378 Z-6.21 DR-\n"
                             "CC X+14.026 Y+71.846\n"
                             "C X+13.861 Y+69.94 DR-\n"
                             "CC X+14.026 Y+71.846\n"
                             "C X+13.73 Y+73.736 DR-\n"
                             "CC X+14.026 Y+71.846\n"
                             "C X+14.642 Y+73.657 DR-\n"
                             "L Y+80\n"),
            std::string::npos)
      << body(trial);
}

// C of the machine has no ends: on a modulo axis (MD30310 = 1) AC(20) would rotate it from -40 to
// 20 by way of -340. G55 has the offset of G54 in C: the count goes on.
TEST(WrittenTurns, OfAnEndlessAxisAreCountedOverWorkSystems) {
  Trial trial = dialect_trial(Dialect::siemens,
                              "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B-30 C-40\nG55 C20\nC30\n"
                              "G53 G0 Z0\nC-5\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_EQ(body(trial),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "TRAFOOF\n"
            "G0 X1 Y1 B-30 C-40\n"
            "G55\n"
            "C=IC(60)\n"
            "C=AC(30)\n"
            "SUPA G0 Z0 D0\n"
            "C=IC(-35)\n");
}

TEST(WrittenTurns, OfAnEndlessAxisThatNoWordSaysAreRefused) {
  const std::string start = "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B-30 C-40\n";
  Trial trial = dialect_trial(Dialect::siemens, start + "G53 G0 C20\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  const std::string keep =
      ", while it may be a modulo axis, whose absolute positions are from 0 to 360 deg; stay "
      "within that range; it cannot be expressed in siemens";
  EXPECT_EQ(refusal(trial), "plate.ngc:4: error: rotates C from -40 to 20 of the machine" + keep);
  trial = dialect_trial(Dialect::siemens, start + "G55 C20\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  trial.request.inputs.parameter_file.clear();
  trial.request.work_offsets = {"X=0,Y=0,Z=0,B=0,C=0", "G55:X=0,Y=0,Z=0,B=0,C=10"};
  EXPECT_EQ(
      refusal(trial),
      "plate.ngc:4: error: rotates C from -50 to 20 after a change of its work offset" + keep);
}

}  // namespace
}  // namespace servomill::sim::programs::written_paths_test
