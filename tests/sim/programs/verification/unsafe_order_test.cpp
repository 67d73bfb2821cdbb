// Written programs that would go through the work where a tool change or a stop leaves positions
// unknown: verification refuses them.
#include "sim/programs/verification/verification.h"
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::unsafe_order_test {
namespace {

const std::string kStart = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS1000 M3\nG0 X10 Y10 Z5\n";

// Why the written program is refused once `from` is replaced in it.
std::string verified(const std::string& program, const std::string& from, const std::string& to) {
  const Trial trial = dialect_trial(Dialect::siemens, program);
  const Pattern block_number("^N[0-9]+ ");
  std::string text;
  for (const std::string& line : lines_of(trial.run().program)) {
    text += block_number.replaced(line, "") + "\n";
  }
  const std::size_t at = text.find(from);
  if (at == std::string::npos) return "not written: " + text;
  text.replace(at, from.size(), to);
  try {
    verify_compensated(trial.request, text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    const std::size_t begin = what.find("\": ") + 3;
    return what.substr(begin, what.find(" (its line") - begin);
  }
  return "taken";
}

TEST(UnsafeOrder, AcrossBeforeUpBehindAStop) {
  const std::string program = kStart + "G1 Z-5 F200\nX60\nM1\nG0 X10 Y60 Z20\nM2\n";
  const std::string safe = "G0 Z20\nX10 Y60\n";
  EXPECT_EQ(verified(program, safe, "G0 X10 Y60\nZ20\n"), "moves the other axes before moving up");
  EXPECT_EQ(verified(program, safe, "G0 Z20\nX10 Y60\n"), "taken");
}

TEST(UnsafeOrder, DownBeforeAcrossBehindAStop) {
  const std::string program = kStart + "M0\nG0 X30 Y30 Z-4\nM2\n";
  EXPECT_EQ(verified(program, "X30 Y30\nZ-4\n", "Z-4\nX30 Y30\n"),
            "moves Z where a tool change or stop has moved X, which is known in the original");
}

TEST(UnsafeOrder, ZWhereAToolChangeHasLeftOtherAxes) {
  const std::string program = kStart + "X20 Z20\nT2 M6\nG43 H2\nS800 M3\nG0 Z-4\nX20 Y15\nM2\n";
  const std::string safe = "G0 X20 Y10\nD1 Z-4\nY15\n";
  EXPECT_EQ(verified(program, safe, "G0 D1 Z-4\nX20 Y15\n"),
            "moves Z where a tool change or stop has moved X, which is known in the original");
  EXPECT_EQ(verified(program, safe, "G0 X20\nD1 Z-4\nY15\n"),
            "moves Z where a tool change or stop has moved Y, which is known in the original");
}

TEST(UnsafeOrder, ZBetweenTheAxesThatItNeedsBehindAToolChange) {
  const std::string program = kStart + "X20 Z20\nT2 M6\nG43 H2\nS800 M3\nG0 X30 Z5\nG0 Y15\nM2\n";
  EXPECT_EQ(verified(program, "G0 Y10\nX30\nD1 Z5\n", "G0 X30\nD1 Z5\n"),
            "moves Z where a tool change or stop has moved Y, which is known in the original");
  EXPECT_EQ(verified(program, "G0 Y10\nX30\nD1 Z5\n", "G0 X30 Y10\nD1 Z5\n"), "taken");
}

TEST(UnsafeOrder, AxesRestatedElsewhereThanTheOriginalHasThem) {
  const std::string program = kStart + "X20 Z20\nT2 M6\nG43 H2\nS800 M3\nG0 Z-4\nX20 Y15\nM2\n";
  EXPECT_EQ(verified(program, "G0 X20 Y10\n", "G0 X20.01 Y10\n"),
            "X must end at machine position 220.00000, but ends at 220.01000");
  // nothing has left an axis unknown
  const std::string known = kStart + "X20 Y20\nZ-4\nM2\n";
  EXPECT_EQ(verified(known, "X20 Y20\nZ-4\n", "X20 Y20\nX10 Y10\nZ-4\n"),
            "moves X, which is at rest in the original");
}

// The second moves nothing; without the first Z stays down.
TEST(UnsafeOrder, ReferenceMovesWhereZIsThereAlready) {
  const std::string program = kStart + "G1 Z-5 F200\nG91\nG28 Z0\nG28 Z0\nG90\nG4 P1.5\nM2\n";
  const std::string twice = "SUPA G0 Z-2 D0\nSUPA G0 Z-2 D0\n";
  EXPECT_EQ(verified(program, twice, twice), "taken");
  EXPECT_EQ(verified(program, twice, "SUPA G0 Z-2 D0\n"), "taken");
  EXPECT_EQ(verified(program, twice, ""),
            "expected a return to the reference position, found another action");
}

// Nothing moves between them: the next motion brings the coolant back.
TEST(UnsafeOrder, AStopRightBehindAToolChange) {
  const std::string program =
      kStart + "M8\nG1 Z-5 F200\nG0 Z20\nT2 M6\nG43 H2\nS800 M3\nM1\nG0 X20 Y15\nZ5\nM2\n";
  EXPECT_EQ(
      verified(program, "S800 M3\nM1\nM3\nM8\nG0 X20 Y15\n", "S800 M3\nM1\nM3\nM8\nG0 X20 Y15\n"),
      "taken");
}

// M7 says nothing about the flood that the original has still on.
TEST(UnsafeOrder, AnotherCoolantRightBehindAToolChange) {
  const std::string program =
      kStart + "M8\nG1 Z-5 F200\nG0 Z20\nT2 M6\nG43 H2\nS800 M3\nM7\nG0 X20 Y15\nZ5\nM2\n";
  EXPECT_EQ(verified(program, "M7\nM7\nM8\n", "M7\nM7\nM8\n"), "taken");
}

// The macro of the tool change leaves no motion code that is known.
TEST(UnsafeOrder, AReferenceMoveRightBehindAToolChange) {
  const std::string program = kStart + "X20 Z20\nT2 M6\nG43 H2\nG91 G28 Z0\nG90\nM2\n";
  const std::string text = dialect_trial(Dialect::fanuc, program).run().program;
  EXPECT_NE(text.find(" G0 G91 G28 Z0.\n"), std::string::npos) << text;
}

// Brought back behind '/', C is where it was for both positions of the switch.
TEST(UnsafeOrder, AnEndlessAxisBehindAnOptionalStop) {
  Trial trial =
      dialect_trial(Dialect::siemens,
                    "G21 G90 G17 G54\nT1 M6\nS600 M3\nG0 X1 Y2\nG0 A-8.161 C64.698\nG43 H1 Z9\n"
                    "/M1\nG0 X5\nY6\nZ8\nG0 A20 C-54.96\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
  trial.request.inputs.parameter_file.clear();
  trial.request.work_offsets = {"X=0,Y=0,Z=-90,A=0,C=0"};
  const std::string text = trial.run().program;
  EXPECT_NE(text.find(" A-8.161 C=AC(64.698)\n"), std::string::npos) << text;
  EXPECT_NE(text.find(" A20 C=IC(-119.658)\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace servomill::sim::programs::unsafe_order_test
