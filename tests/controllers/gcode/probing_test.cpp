// G38.2 ... G38.5: the moves, #5061 ... #5070, and what is refused. Programs of tests/conformance
// are compared with LinuxCNC's interpreter; here a wall stands where the test says.
#include "controllers/gcode/probing.h"

#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::probing_test {
namespace {

/// A surface at machine X = `at`, met from below; solid beyond it.
class Wall : public Probed {
 public:
  explicit Wall(double at_x) : at_(at_x) {}
  std::optional<ProbeContact> contact(const ProbingMove& move) override {
    seen.push_back(move);
    const double begin = move.begin_machine[0], end = move.end_machine[0];
    const bool was_inside = begin >= at_, is_inside = end >= at_;
    if (was_inside == is_inside) return std::nullopt;
    const double share = (at_ - begin) / (end - begin);
    const AxisWords latched = move.begin + share * (move.end - move.begin);
    return ProbeContact{latched, latched};
  }
  std::vector<ProbingMove> seen;

 private:
  double at_;
};

struct WallRun {
  std::shared_ptr<Wall> wall = std::make_shared<Wall>(10.0 * mm);
  ProgramSetup setup = usual_setup();
  WallRun() { setup.probed = wall; }
};

TEST(Probing, MovesAtFeedToWhereTheProbeSwitchesAndStandsThere) {
  const WallRun run;
  const std::vector<Move> moves = moves_of("G21 F300\nG38.2 X20 Y10\nG91 G1 X-1", run.setup);
  ASSERT_EQ(moves.size(), 2U);
  EXPECT_EQ(moves[0].kind, MoveKind::feed);
  EXPECT_EQ(moves[0].number, 2);
  EXPECT_EQ(moves[0].path_mode, PathMode::exact_stop);
  EXPECT_NEAR(moves[0].feed, 300.0 * mm_per_min, kExact);
  expect_axes(moves[0].end, axes(10, 5, 0));
  expect_axes(moves[1].end, axes(9, 5, 0));
  EXPECT_EQ(moves[1].number, 0);
}

TEST(Probing, LatchesInWorkCoordinatesAndUnitsOfTheProgram) {
  const WallRun run;
  const std::string latch = "G1 Z#5061 Y#5062 A#5064 B#5070 C[#5067 + #5068 + #5069]";
  expect_axes(last_move("G21 F300 G10 L2 P1 X3 Y1\nG0 X0 Y4\nG38.2 X20\n" + latch, run.setup).end,
              axes(7, 4, 7, 0, 1));
  // 10 mm are 1/2.54 inch; the position behind G21 is the same, the latched number stays in inches
  expect_axes(last_move("G20 F30\nG0 X0 Y0\nG38.2 X1\nG21\nG0 Z#5061", run.setup).end,
              axes(10, 0, 1 / 2.54));
  // turned by 90 degrees: machine X 10 is met along -Y of the program
  expect_axes(last_move("G21 F300 G10 L2 P1 R90\nG0 X0 Y0\nG38.2 Y-20\nG0 Z#5062", run.setup).end,
              axes(0, -10, -10));
}

TEST(Probing, GivesTheProbeWhatItNeedsToKnow) {
  const WallRun run;
  moves_of("G21 F60 G10 L2 P1 X1 Z2\nG43 H1\nG0 X5 Z200\nG38.3 X20", run.setup);
  ASSERT_EQ(run.wall->seen.size(), 1U);
  const ProbingMove& move = run.wall->seen[0];
  EXPECT_EQ(move.mode.digit, 3);
  EXPECT_EQ(move.line, 4);
  expect_axes(move.begin, axes(5, 0, 200));
  expect_axes(move.end, axes(20, 0, 200));
  expect_axes(move.begin_machine, axes(6, 0, 302));
  expect_axes(move.end_machine, axes(21, 0, 302));
  EXPECT_NEAR((move.p_ST - Eigen::Vector3d(0, 0, -0.1)).norm(), 0.0, kExact);
  EXPECT_NEAR(move.feed, 1e-3, kExact);
}

TEST(Probing, ThatMeetsNothingIsAFaultOrGoesOn) {
  const WallRun run;
  EXPECT_EQ(fault_of("G21 F300\nG38.2 X9", run.setup),
            "p.nc:2:1: error: G38.2: the probe makes no contact before the end of the move");
  EXPECT_EQ(fault_of("G21 F300\nG0 X20\nG38.4 X11", run.setup),
            "p.nc:3:1: error: G38.4: the probe is still in contact before the end of the move");
  expect_axes(last_move("G21 F300\nG38.3 X9\nG0 Y#5061 Z#5070", run.setup).end, axes(9, 9, 0));
  expect_axes(last_move("G21 F300\nG0 X20\nG38.5 X11\nG0 Y#5061 Z#5070", run.setup).end,
              axes(11, 11, 0));
  expect_axes(last_move("G21 F300\nG0 X20\nG38.5 X9\nG0 Y#5061 Z#5070", run.setup).end,
              axes(10, 10, 1));
}

TEST(Probing, StaysInForceAndBranchesOnItsResult) {
  const WallRun run;
  const std::vector<Move> moves = moves_of("G21 F300\nG38.3 X5\nX20\n", run.setup);
  ASSERT_EQ(moves.size(), 2U);
  expect_axes(moves[1].end, axes(10, 0, 0));
  const std::string branch = "\no1 if [#5070 EQ 1]\nG0 Z1\no1 else\nG0 Z2\no1 endif";
  EXPECT_NEAR(last_move("G21 F300\nG38.3 X20" + branch, run.setup).end[2], 1 * mm, kExact);
  EXPECT_NEAR(last_move("G21 F300\nG38.3 X2" + branch, run.setup).end[2], 2 * mm, kExact);
}

TEST(Probing, IsRefusedWhereItMeansNothing) {
  const WallRun run;
  const auto fault = [&](const std::string& text) {
    const std::string all = fault_of(text, run.setup);
    return all.substr(all.find(": error: ") + 9);
  };
  EXPECT_EQ(fault("G38.2 F100"), "G38.2 requires an axis word");
  EXPECT_EQ(fault("G38.2 X20"), "G38.2 with zero feed rate; no F is active");
  EXPECT_EQ(fault("G93 G38.2 X20 F2"), "G38.2 is not allowed with G93; program G94 first");
  EXPECT_EQ(fault("G95 F1 S100\nG38.2 X20"), "G38.2 is not allowed with G95; program G94 first");
  EXPECT_EQ(fault("F100 G41.1 D3\nG1 X5\nG38.2 X20"),
            "G38.2 is not allowed with cutter compensation active; program G40 first");
  EXPECT_EQ(fault("F100 G43.4 H1\nG38.2 X20"),
            "G38.2 is not allowed under TCP control; cancel G43.4, G43.5 or G68.2 first");
  EXPECT_EQ(fault("F100 G0 X20\nG38.2 X20"), "G38.2 has zero travel: start and end coincide");
  EXPECT_EQ(fault("F100 G53 G38.2 X20"), "G53 requires G0 or G1");
  EXPECT_EQ(fault_of("F100 G38.2 X20"),
            "p.nc:1:6: error: G38.2: the probed surface is unknown here; simulate it with "
            "[touch_probe] of a scenario");
}

TEST(Probing, NeedsTheLengthOfTheProbe) {
  WallRun run;
  run.setup.tools = ToolTable();
  run.setup.tools.take_any_number();
  run.setup.reader = Reader::any;
  run.setup.accepts_unknown_lengths = true;
  const std::string program = "G21 F300\nT5 M6\nG43 H5\nG38.3 X20";
  EXPECT_EQ(fault_of(program, run.setup),
            "p.nc:4:1: error: the length of the probe is unknown; pass a tool table with --tools");
  run.setup.probed = std::make_shared<AssumedContact>();
  EXPECT_EQ(fault_of(program, run.setup), "");
}

TEST(Probing, IsWarnedOfOnceWhereTheContactIsAssumed) {
  ProgramSetup setup = usual_setup();
  setup.reader = Reader::any;
  setup.probed = std::make_shared<AssumedContact>();
  Interpreter interpreter("G21 F300.\nG38.2 X20.\nG38.2 Y20.\nG0 Z#5070\nM2\n", "p.nc", setup);
  const std::vector<Move> moves = interpreter.rest();
  ASSERT_EQ(interpreter.warnings().size(), 1U);
  EXPECT_EQ(
      interpreter.warnings()[0].message,
      "G38.2: assumed to touch at the end of the move; the measured position is unknown here");
  expect_axes(moves[1].end, axes(20 - 0.254, 20, 0));
  expect_axes(moves[2].end, axes(20 - 0.254, 20 - 0.254, 1));
  setup.reader = Reader::linuxcnc;  // rs274 leaves #5070 at 0
  EXPECT_NEAR(last_move("G21 F300\nG38.2 X20\nG0 Z#5070", setup).end[2], 0.0, kExact);
}

}  // namespace
}  // namespace servomill::controllers::probing_test
