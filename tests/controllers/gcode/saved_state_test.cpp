// Saving and restoring what is in force, and the switches that a simulation has no use for. That
// they are LinuxCNC's is tested by conformance programs (state_*.ngc).
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::saved_state_test {
namespace {

TEST(SavedState, RestoresTheModesOfMotion) {
  const std::string saved = "G20 G91 G18 G64 P0.01\nF10\nM70\nG21 G90 G17 G61 F5\n";
  const Move move = last_move(saved + "M72\nG1 X1");
  expect_axes(move.end, axes(25.4, 0, 0));
  EXPECT_NEAR(move.feed, 254 * mm_per_min, kExact);
  EXPECT_EQ(move.path_mode, PathMode::continuous);
  EXPECT_NEAR(move.path_tolerance, 0.254e-3, kExact);
  EXPECT_EQ(last_move(saved + "M72\nG2 X1 I0.5").arc.normal_axis, 1);
}

TEST(SavedState, RestoresTheSpindleTheCoolantAndTheWorkSystem) {
  const auto moves = moves_of("S100 M3\nM8\nG55\nM70\nM5\nM9\nG54\nM72\nG0 X1");
  ASSERT_GE(moves.size(), 4u);
  const Move& motion = moves[moves.size() - 3];  // then M2 stops spindle and coolant
  EXPECT_EQ(motion.work_offset, 2);
  EXPECT_EQ(moves[moves.size() - 5].direction, 1);
  EXPECT_EQ(moves[moves.size() - 4].kind, MoveKind::coolant);
  EXPECT_EQ(moves[moves.size() - 4].number, 2);
}

TEST(SavedState, DropsWhatStandsBesideARestoringM72AndWarns) {
  Interpreter interpreter("G0 X1\nM70\nG91\nM72 G0 X5\nM72 G0 X6\nM2\n", "p.nc", {});
  const std::vector<Move> moves = interpreter.rest();
  ASSERT_EQ(moves.size(), 3u);
  expect_axes(moves[1].end, axes(6, 0, 0));  // the second one has nothing to restore
  ASSERT_EQ(interpreter.warnings().size(), 1u);
  EXPECT_EQ(to_string(interpreter.warnings()[0]),
            "p.nc:4:1: error: M72 restores the modal state: words in the same block that act later "
            "are ignored, as in LinuxCNC");
}

TEST(SavedState, FaultsNameTheRule) {
  EXPECT_EQ(fault_of("M72"),
            "p.nc:1:1: error: M72 requires a preceding M70 or M73 at this call level");
  EXPECT_EQ(fault_of("M70\nM71\nM72"),
            "p.nc:3:1: error: M72 requires a preceding M70 or M73 at this call level");
  EXPECT_EQ(fault_of("M3 M70"), "p.nc:1:4: error: M3 and M70 in one block (same modal group)");
  EXPECT_EQ(fault_of("M70\nG43.4 H1\nM72"),
            "p.nc:3:1: error: M72 cannot switch TCP control or a tilted work plane");
}

TEST(Switches, TakeAPWordAndChangeNoMove) {
  EXPECT_EQ(moves_of("M48\nM49\nM50 P0\nM51\nM52 P1\nM53 P0").size(), 0u);
  EXPECT_EQ(fault_of("M48 M50"), "p.nc:1:5: error: M48 and M50 in one block (same modal group)");
}

TEST(Outputs, TakeAPWordAndChangeNoMove) {
  EXPECT_EQ(moves_of("M62 P0\nM63 P0\nM64 P2\nM65 P2").size(), 0u);
  EXPECT_EQ(fault_of("M62"), "p.nc:1:1: error: M62 requires a P word (output number)");
}

TEST(Stops, M60WaitsForTheOperatorLikeM0) {
  const Move move = last_move("M60");
  EXPECT_EQ(move.kind, MoveKind::stop);
  EXPECT_EQ(move.number, 60);
}

TEST(SystemParameters, AreReadOnly) {
  for (const std::string name : {"_vmajor", "_x", "_feed", "_value", "_call_level", "_task"}) {
    EXPECT_EQ(fault_of("#<" + name + ">=1"),
              "p.nc:1:1: error: parameter #<" + name + "> is read-only");
  }
  EXPECT_EQ(fault_of("#5410=1"), "p.nc:1:1: error: parameter #5410 is read-only");
}

TEST(SystemParameters, CanBeComputedWith) {
  expect_axes(last_move("G18 G55 F50\nG0 X[#<_plane>/10] Y[#<_coord_system>/10] Z#<_feed>").end,
              axes(18, 55, 50));
}

TEST(RefusedCodes, HaveAReasonEach) {
  const auto fault = [](const std::string& code) {
    const std::string text = fault_of(code);
    return text.substr(text.find(": error: ") + 9);
  };
  EXPECT_EQ(fault("G7"), "G7: diameter and radius mode are for turning; only milling is supported");
  EXPECT_EQ(fault("G38.3"), "G38.3 requires an axis word");
  EXPECT_EQ(fault("G71.2"), "G71.2: turning cycles are for lathes; only milling is supported");
  EXPECT_EQ(fault("G76"), "G76: threading is for lathes; only milling is supported");
  EXPECT_EQ(fault("G96"),
            "G96: constant surface speed is for turning; program the speed with G97 S");
  EXPECT_EQ(fault("M19"), "M19: the spindle angle is not simulated, so it cannot be oriented");
  EXPECT_EQ(fault("M61"), "M61: sets the number of the tool in the spindle manually; use T and M6");
  EXPECT_EQ(fault("M66"), "M66: waits for an input of the control, which is not simulated");
  EXPECT_EQ(fault("M68"), "M68: sets analog outputs of the control, which are not simulated");
}

}  // namespace
}  // namespace servomill::controllers::saved_state_test
