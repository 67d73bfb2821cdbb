// Tool-centre-point control and tilted work planes, as the interpreter reads them.
#include <Eigen/Geometry>

#include "controllers/gcode/canon_json.h"
#include "tests/controllers/gcode/program.h"
#include "tests/controllers/path/tip_programs.h"

namespace servomill::controllers::tcp_control_test {
namespace {

using Eigen::Vector3d;
using test::head_machine;
using test::table_machine;
using test::TipMachine;

constexpr double kChainTol = 1e-15;  // m, a few roundings of products of some 0.1 m
constexpr double kAxisTol = 1e-12;   // of a unit vector, what the inverse kinematics leaves

std::vector<Move> moves_on(const TipMachine& machine, const std::string& text) {
  return moves_of(text, machine.setup());
}

ToolPose pose_at_end(const TipMachine& machine, const Move& move) {
  return machine.pose(machine.chain.layout.joints(move.end_machine));
}

// --------------------------------------------------------------------------------------- G43.4

TEST(TcpControl, SwitchingItOnAndOffMovesNothing) {
  for (const TipMachine& machine : {table_machine(), head_machine()}) {
    const std::string turned = machine.lower[3] == -120.0 * deg ? "A20 C40" : "B20 C40";
    const auto moves = moves_on(
        machine, "G0 X5 Y6 Z130 " + turned + "\nG43.4 H1\nG91 G1 X0 F100\nG49\nG0 X0 Y0 Z0");
    ASSERT_EQ(moves.size(), 3U);
    const ToolPose before = pose_at_end(machine, moves[0]);
    EXPECT_LT((moves[1].end_machine.head<3>() - before.p_WT).norm(), 2 * kChainTol);
    EXPECT_LT((moves[2].end_machine - moves[0].end_machine).norm(), 2 * kChainTol);
    EXPECT_NEAR(moves[1].s_end, moves[1].s_begin, kChainTol);
  }
}

TEST(TcpControl, GivesTheTipInTheWorkpieceAndTheRotaryAxes) {
  const auto moves =
      moves_on(table_machine(), "G10 L2 P1 X1 Y2 Z3 C10\nG43.4 H1\nG1 X10 Y20 Z30 A40 C50 F600");
  const Move& move = moves.back();
  EXPECT_EQ(move.tool_control, ToolControl::rotary_axes);
  EXPECT_EQ(move.tool_offset, 1);
  expect_axes(move.end, axes(10, 20, 30, 40, 0, 50));
  expect_axes(move.end_machine, axes(11, 22, 33, 40, 0, 60));
}

TEST(TcpControl, FeedIsThatOfTheTipOrOfTheRotationWhereItStands) {
  const auto moves =
      moves_on(table_machine(), "G43.4 H1\nG1 X10 C50 F600\nC80\nG93 X40 C0 F2\nC30 F3");
  EXPECT_NEAR(moves[0].feed, 10 * mm, kExact);
  EXPECT_NEAR(moves[1].feed, 10 * deg, kExact);
  EXPECT_NEAR(moves[2].feed, 1 * mm, kExact) << "30 mm in half a minute";
  EXPECT_NEAR(moves[3].feed, 1.5 * deg, kExact) << "30 deg in 20 s";
}

TEST(TcpControl, ArcsLieInTheWorkpiece) {
  const Move move = moves_on(table_machine(), "G43.4 H1\nG2 X10 Y10 I10 A5 F600").back();
  EXPECT_EQ(move.kind, MoveKind::arc);
  EXPECT_NEAR((move.centre_machine - Vector3d(10, 0, -100) * mm).norm(), 0.0, kExact);
}

TEST(TcpControl, WorksWithoutAMachineWhileNothingIsTurned) {
  const auto moves = moves_of("G43.4 H1\nG1 X1 B30 F100\nB0\nG49\nG0 X2");
  EXPECT_EQ(moves[0].tool_control, ToolControl::rotary_axes);
  expect_axes(moves[0].end_machine, axes(1, 0, -100, 0, 30, 0));
  expect_axes(moves[2].end_machine, axes(2, 0, 0));
}

// --------------------------------------------------------------------------------------- G43.5

TEST(TcpControl, VectorsTurnTheToolAxis) {
  for (const TipMachine& machine : {table_machine(), head_machine()}) {
    const Move move = moves_on(machine, "G43.5 H1\nG1 X1 I0.36 J0.48 K0.8 F100").back();
    EXPECT_EQ(move.tool_control, ToolControl::tool_axis);
    const Vector3d k(0.36, 0.48, 0.8);
    EXPECT_LT((move.tool_axis - k).norm(), kAxisTol);
    EXPECT_LT((pose_at_end(machine, move).k_W - k).norm(), kAxisTol);
  }
}

TEST(TcpControl, ABlockWithoutAVectorKeepsTheToolAxis) {
  const auto moves =
      moves_on(head_machine(), "G43.5 H1\nG1 X1 I0.6 K0.8 F100\nY5\nI0 K1\nG0 I0.6 K0.8");
  ASSERT_EQ(moves.size(), 4U);
  EXPECT_LT((moves[1].tool_axis - Vector3d(0.6, 0, 0.8)).norm(), kAxisTol);
  EXPECT_EQ(moves[1].end_machine.tail<3>(), moves[0].end_machine.tail<3>());
  EXPECT_EQ(moves[2].s_end, moves[2].s_begin) << "only the axis turns";
  EXPECT_EQ(moves[3].kind, MoveKind::rapid);
}

TEST(TcpControl, VectorsTurnWithTheWorkSystemAndTheTiltedPlane) {
  const auto of = [](const std::string& text) {
    return Vector3d(moves_on(head_machine(), text).back().tool_axis);
  };
  EXPECT_LT((of("G10 L2 P1 R90\nG43.5 H1\nG0 I0.6 K0.8") - Vector3d(0, 0.6, 0.8)).norm(), kAxisTol);
  EXPECT_LT((of("G68.2 J-90\nG43.5 H1\nG0 I0.6 J-0.8") - Vector3d(0.6, 0, 0.8)).norm(), kAxisTol);
}

TEST(TcpControl, VectorsOfOtherLengthAreNormalisedWithAWarning) {
  Interpreter interpreter("G43.5 H1\nG1 X1 I0.3 J0.4 K1.2 F100\nX2 I0.6 K0.80008\nM2\n", "p.nc",
                          head_machine().setup());
  const auto moves = interpreter.rest();
  EXPECT_LT((moves[0].tool_axis - Vector3d(0.3, 0.4, 1.2) / 1.3).norm(), kAxisTol);
  ASSERT_EQ(interpreter.warnings().size(), 1U) << "four decimals are not worth a word";
  const Fault& warning = interpreter.warnings().front();
  EXPECT_EQ(to_string(warning.place), "p.nc:2:7");
  EXPECT_EQ(warning.message, "the tool axis I J K has length 1.3; normalised to a unit vector");
}

// --------------------------------------------------------------------------------- G68.2 G53.1

// ZXZ: the new axes are seen in the old ones.
TEST(TiltedPlane, EulerAnglesTurnAboutZThenXThenZ) {
  const auto end = [](const std::string& angles, const std::string& point) {
    const auto moves =
        moves_on(head_machine(), "G43 H1\nG68.2 X1 Y2 Z3 " + angles + "\nG0 " + point);
    return Vector3d(moves.back().end_machine.head<3>() / mm - Vector3d(1, 2, 3));
  };
  constexpr double kTol = 1e-12;  // mm
  EXPECT_LT((end("I90", "X10 Y0 Z0") - Vector3d(0, 10, 0)).norm(), kTol);
  EXPECT_LT((end("J90", "X0 Y10 Z0") - Vector3d(0, 0, 10)).norm(), kTol);
  EXPECT_LT((end("J90 K90", "X10 Y0 Z0") - Vector3d(0, 0, 10)).norm(), kTol);
  EXPECT_LT((end("I90 J90", "X0 Y0 Z10") - Vector3d(10, 0, 0)).norm(), kTol);
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(20 * deg, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(30 * deg, Vector3d::UnitX()) *
                             Eigen::AngleAxisd(40 * deg, Vector3d::UnitZ()))
                                .toRotationMatrix();
  EXPECT_LT((end("I20 J30 K40", "X3 Y4 Z5") - R * Vector3d(3, 4, 5)).norm(), kTol);
}

TEST(TiltedPlane, G53_1PutsTheToolAlongZWithoutMovingTheLinearAxes) {
  for (const TipMachine& machine : {table_machine(), head_machine()}) {
    const auto moves = moves_on(machine, "G43 H1\nG0 X7 Y8 Z9\nG68.2 I25 J35\nG53.1\nG0 X0 Y0 Z0");
    ASSERT_EQ(moves.size(), 3U);
    EXPECT_EQ(moves[1].kind, MoveKind::rapid);
    EXPECT_EQ(moves[1].tool_control, ToolControl::none);
    EXPECT_LT((moves[1].end_machine - moves[0].end_machine).head<3>().norm(), kChainTol);
    const Vector3d z = Eigen::AngleAxisd(25 * deg, Vector3d::UnitZ()) *
                       (Eigen::AngleAxisd(35 * deg, Vector3d::UnitX()) * Vector3d::UnitZ());
    EXPECT_LT((pose_at_end(machine, moves[1]).k_W - z).norm(), kAxisTol);
    EXPECT_EQ(moves[2].tool_control, ToolControl::work_plane);
    EXPECT_LT(moves[2].end_machine.head<3>().norm(), kChainTol) << "the origin of the plane";
  }
}

TEST(TiltedPlane, ACutWithoutG53_1IsToldOnceAPlane) {
  const auto warnings = [](const ProgramSetup& setup, const std::string& text) {
    Interpreter interpreter("G43 H1\n" + text + "\nM2\n", "p.nc", setup);
    interpreter.rest();
    std::vector<std::string> out;
    for (const Fault& w : interpreter.warnings()) {
      out.push_back(to_string(w.place) + " " + w.message);
    }
    return out;
  };
  using Texts = std::vector<std::string>;
  const ProgramSetup table = table_machine().setup();
  const Texts expected = {
      "p.nc:4:1 the tool axis is 35.0000 deg off Z of the tilted work plane; G53.1 aligns it"};
  EXPECT_EQ(warnings(table, "G68.2 I25 J35\nG0 X0\nG1 X1 Y0 F100\nG2 X5 I2\nG69\nG1 X3"), expected);
  EXPECT_EQ(warnings(usual_setup(), "G68.2 I25 J35\nG0 X0 Y0\nG2 X5 I2.5 F100"), expected);
  EXPECT_EQ(warnings(table, "G68.2 I25 J35\nG0 X0\nG53.1\nG1 X1 F100"), Texts{});
  EXPECT_EQ(warnings(table, "G68.2 X3 K20\nG1 X1 F100"), Texts{}) << "a plane that is not tilted";
  EXPECT_EQ(warnings(table, "G68.2 J35\nG0 X1"), Texts{}) << "nothing is cut";
  EXPECT_EQ(warnings(table, "G68.2 J35\nG1 X1 F1\nG69\nG68.2 J5\nG1 X1").size(), 2U);
  EXPECT_EQ(warnings(table, "G68.2 J35\nG43.4 H1\nG1 X1 F1"), Texts{}) << "G43.4 turns by words";
  TipMachine three = table_machine();
  three.chain = plant::make_chain(plant::parse_structure("[w X' b Y Z t]"));
  EXPECT_EQ(warnings(three.setup(), "G68.2 J35\nG1 X1 F1"),
            Texts{"p.nc:3:1 the tool axis is 35.0000 deg off Z of the tilted work plane"});
}

TEST(TiltedPlane, EndsWhereTheAxesStand) {
  for (const TipMachine& machine : {table_machine(), head_machine()}) {
    const auto moves =
        moves_on(machine, "G43 H1\nG68.2 I25 J35\nG53.1\nG69\nG91 G0 X1\nG90 G49 G0 Z300");
    const Vector3d before = moves[0].end_machine.head<3>();
    EXPECT_LT((moves[1].end_machine.head<3>() - before - Vector3d(1, 0, 0) * mm).norm(), kChainTol);
  }
}

// ---------------------------------------------------------------------------------------- canon

TEST(TcpControl, IsInTheCanonicalMoves) {
  const auto moves = moves_of("G43.4 H1\nG1 X1 B30 F100");
  EXPECT_EQ(canon_json(moves.back()),
            R"({"t":"feed","line":2,"end":[1,0,-100,0,30,0],"mend":[1,0,-100,0,30,0],)"
            R"("control":"G43.4","feed":100,"fmode":"upm"})");
  const Move vector = moves_on(head_machine(), "G43.5 H1\nG0 X1 I0 J0 K1").back();
  EXPECT_EQ(canon_json(vector),
            R"({"t":"rapid","line":2,"end":[1,0,-100,0,0,0],"mend":[1,0,-100,0,0,0],)"
            R"("control":"G43.5","axis":[0,0,1]})");
  const Move plane = moves_of("G68.2 Z-1\nG0 X1").back();
  EXPECT_EQ(canon_json(plane), R"({"t":"rapid","line":2,"end":[1,0,1,0,0,0],"mend":[1,0,0,0,0,0],)"
                               R"("control":"G68.2"})");
}

// --------------------------------------------------------------------------------------- errors

struct Wrong {
  const char* text;
  const char* message;  // behind "p.nc:"
};

void expect_gallery(const TipMachine& machine, std::initializer_list<Wrong> gallery) {
  for (const Wrong& wrong : gallery) {
    EXPECT_EQ(fault_of(wrong.text, machine.setup()), std::string("p.nc:") + wrong.message)
        << wrong.text;
  }
}

TEST(TipControlErrors, Vectors) {
  expect_gallery(
      head_machine(),
      {
          {"G43.5 H1\nG1 X1 F1", "2:1: error: G43.5 requires I J K in its first move"},
          {"G43.5 H1\nG0 X1 I0 J0 K0", "2:7: error: the tool axis I J K has length zero"},
          {"G43.5 H1\nG0 X1 B5 K1",
           "2:7: error: B word is not allowed with G43.5; I J K define the tool axis"},
          {"G43.5 H1\nG0 X1 K1\nG2 X5 I2 F1",
           "3:1: error: G2 is not supported with G43.5, where I J K are the tool axis; use G1 or "
           "G43.4"},
          {"G43.5 H1\nG0 X1 K1\nG1 X2 K-1 F1",
           "3:1: error: the tool axis rotates by 180 deg, so the great circle is undefined"},
          {"G43.5 H1\nG0 X1 K1\nG1 X2 I1 K-0.5 F1",
           "3:1: error: the tool axis (0.894427, 0.000000, -0.447214) requires B = 116.5651 deg; "
           "must be <= 110.0000"},
          {"G0 X1 K1",
           "1:7: error: K word without a code that uses it (G2, G3, G33, G33.1, G68.2, G87)"},
          {"G43.5 H1\nG10 L2 P1 X1\nG28",
           "3:1: error: G28 is not allowed under TCP control; program G49 first"},
          {"G43.4 H1\nG53 G0 X1",
           "2:1: error: G53 is not allowed under TCP control; program G49 first"},
          {"G43.4 G43.5 H1", "1:7: error: G43.4 and G43.5 in one block (same modal group)"},
          {"G43.4 H9", "1:7: error: H9 is not in the tool table"},
          {"G41 G43.4 H1",
           "1:5: error: G43.4 is not allowed with cutter compensation active; program G40 first"},
      });
}

TEST(TipControlErrors, Planes) {
  expect_gallery(
      table_machine(),
      {
          {"G68.2 J10\nG68.2 J20",
           "2:1: error: G68.2 is not allowed in a tilted work plane; program G69 first"},
          {"G53.1", "1:1: error: G53.1 requires a tilted work plane; program G68.2 first"},
          {"G68.2 J10\nG0 G53.1 X1", "2:1: error: G53.1 must be in a block without motion"},
          {"G68.2 J130\nG53.1",
           "2:1: error: G53.1: the tool axis (0.000000, -0.766044, -0.642788) requires A = "
           "130.0000 deg; must be <= 120.0000"},
          {"G68.2 J10 A5", "1:11: error: A word is not allowed with G68.2; its angles are I J K"},
          {"G68.2 J10\nG0 A5",
           "2:4: error: A word is not allowed in a tilted work plane; orient the tool with G53.1, "
           "or use G43.4 for rotary axes"},
          {"G68.2 J10\nG92 X0",
           "2:1: error: G92 is not allowed in a tilted work plane; program G69 first"},
          {"G68.2 J10\nG53 G0 X0",
           "2:1: error: G53 is not allowed in a tilted work plane; program G69 first"},
          {"G43.1 Z5\nG68.2 J10",
           "2:1: error: G68.2 is not supported with a tool offset of G43.1 or G43.2; use G43 H"},
          {"G68.2 J10\nG43.1 Z5",
           "2:1: error: G43.1 is not supported in a tilted work plane; use G43 H"},
          {"G68.2 G69 J10", "1:7: error: G68.2 and G69 in one block (same modal group)"},
          {"G68.2 G0 X1",
           "1:7: error: G68.2 and G0 are not allowed in one block: both use the axis words"},
      });
}

TEST(TipControlErrors, MachinesThatCannotTurn) {
  TipMachine three = table_machine();
  three.chain = plant::make_chain(plant::parse_structure("[w X' b Y Z t]"));
  expect_gallery(three,
                 {{"G43.4 H1", "1:1: error: G43.4: the machine has no rotary axis; write G43 H"},
                  {"G43.5 H1", "1:1: error: G43.5: the machine has no rotary axis"},
                  {"G68.2 J1\nG53.1", "2:1: error: G53.1: the machine has no rotary axis"}});
  TipMachine four = table_machine();
  four.chain = plant::make_chain(plant::parse_structure("[w A' X' b Y Z t]"));
  expect_gallery(four, {{"G43.5 H1\nG0 I0.6 K0.8",
                         "2:1: error: the tool axis (0.600000, 0.000000, 0.800000) cannot be "
                         "reached; the error is 36.8699 deg"}});
}

TEST(TipControlErrors, WithoutAMachine) {
  const auto message = [](const char* text) { return fault_of(text, usual_setup()); };
  EXPECT_EQ(message("G0 B30\nG43.4 H1"),
            "p.nc:2:1: error: B is at 30 deg: the TCP position depends on the machine; pass it "
            "with --machine");
  EXPECT_EQ(message("G43.4 H1\nG0 C-5\nG49"),
            "p.nc:3:1: error: C is at -5 deg: the TCP position depends on the machine; pass it "
            "with --machine");
  EXPECT_EQ(message("G43.5 H1"),
            "p.nc:1:1: error: G43.5: the rotary axis positions depend on the machine; pass it with "
            "--machine");
  EXPECT_EQ(message("G68.2 J10\nG53.1"),
            "p.nc:2:1: error: G53.1: the rotary axis positions depend on the machine; pass it with "
            "--machine");
}

TEST(TipControlErrors, ABlockWithAnErrorChangesNothing) {
  Interpreter interpreter("G43.4 H1\nG43.5 G53 H1 G0 X1\nG1 X1 F100\nM2\n", "p.nc",
                          head_machine().setup());
  EXPECT_THROW(interpreter.next(), InputError);
  EXPECT_EQ(interpreter.next()->tool_control, ToolControl::rotary_axes);
}

}  // namespace
}  // namespace servomill::controllers::tcp_control_test
