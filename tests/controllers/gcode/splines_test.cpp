// G5, G5.1, G5.2 and G5.3.
#include <random>

#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/spline_curve.h"
#include "tests/controllers/gcode/program.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers::splines_test {
namespace {

using Eigen::Vector3d;

const std::string kHead = "G0 X1 Y2\nF600\n";

Move spline_of(const std::string& text, const ProgramSetup& setup = usual_setup()) {
  for (Move& move : moves_of(kHead + text, setup)) {
    if (move.kind == MoveKind::spline) return move;
  }
  ADD_FAILURE() << "no spline in " << text;
  return {};
}

// X and Y in mm.
void expect_points(const Move& move, const std::vector<std::pair<double, double>>& wanted) {
  ASSERT_NE(move.spline, nullptr);
  const std::vector<Vector3d>& found = move.spline->points;
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(found[i].x(), wanted[i].first * mm, kExact) << i;
    EXPECT_NEAR(found[i].y(), wanted[i].second * mm, kExact) << i;
  }
}

std::string message_of(const std::string& text) {
  const std::string fault = fault_of(kHead + text);
  return fault.empty() ? "" : fault.substr(fault.find(": error: ") + 9);
}

TEST(Splines, CubicLeadsByIJAndPQ) {
  const Move move = spline_of("G5 X3 Y2 I1 J2 P-1 Q3");
  expect_points(move, {{1, 2}, {2, 4}, {2, 5}, {3, 2}});
  EXPECT_EQ(move.spline->curve.order(), 4);
  EXPECT_EQ(move.spline->curve.weights(), std::vector<double>(4, 1.0));
  EXPECT_NEAR(move.feed, 0.01, kExact);
  expect_axes(move.end, axes(3, 2, 0));
  EXPECT_NEAR(move.s_end - move.s_begin, move.spline->curve.length(), kExact);
}

TEST(Splines, CubicWithoutIJGoesOn) {
  const std::vector<Move> moves = moves_of(kHead + "G5 X3 Y2 I1 J2 P-1 Q3\nG5 X6 Y2 P-1 Q1\n");
  expect_points(moves.back(), {{3, 2}, {4, -1}, {5, 3}, {6, 2}});
  const SplineCurve &first = moves[moves.size() - 2].spline->curve,
                    &second = moves.back().spline->curve;
  EXPECT_LT((first.state(first.length()).tangent - second.state(0.0).tangent).norm(), 1e-12);
}

TEST(Splines, QuadraticLeadsByIJ) {
  const Move move = spline_of("G91\nG5.1 X2 Y1 I1 J-1");
  expect_points(move, {{1, 2}, {2, 1}, {3, 3}});
  EXPECT_EQ(move.spline->curve.order(), 3);
}

TEST(Splines, BezierCodesAreNotModal) {
  const std::vector<Move> moves =
      moves_of(kHead + "G5.1 X2 Y2 I1 J1\nX5\nG1 X6\nG5 X8 I1 J1 P1 Q1\nX9");
  EXPECT_EQ(moves[2].kind, MoveKind::rapid);  // the G0 of the head
  EXPECT_EQ(moves.back().kind, MoveKind::feed);
}

TEST(Splines, NurbsCollectsPointsWeightsAndOrder) {
  const Move move = spline_of("G5.2 P2 L4\nX3 Y3 P1\nM8\nX4 Y1 P3 (one more)\nX6 Y2 P0.5\nG5.3");
  expect_points(move, {{1, 2}, {3, 3}, {4, 1}, {6, 2}});
  EXPECT_EQ(move.spline->curve.weights(), (std::vector<double>{2, 1, 3, 0.5}));
  EXPECT_EQ(move.spline->curve.order(), 4);
  EXPECT_EQ(move.line, 8);
  // the start weighs 1 if its weight is not given; order 3
  const Move plain = spline_of("G5.2 X3 Y3 P1\nX4 Y1 P3\nG5.3 F900");
  EXPECT_EQ(plain.spline->curve.weights(), (std::vector<double>{1, 1, 3}));
  EXPECT_EQ(plain.spline->curve.order(), 3);
  EXPECT_NEAR(plain.feed, 0.015, kExact);
}

TEST(Splines, NurbsOfG91CountsFromItsStart) {
  expect_points(spline_of("G91\nG5.2 X2 Y1 P1\nX3 Y-1 P1\nG5.3"), {{1, 2}, {3, 3}, {4, 1}});
}

TEST(Splines, LieInTheMachineAsTheirWorkCoordinatesDo) {
  ProgramSetup setup = usual_setup();
  setup.work_offset[0] = axes(100, 0, -50);
  setup.work_rotation[0] = 30.0 * deg;
  const std::vector<Move> moves = moves_of(kHead + "G43 H1\nG1 Z-1\nG5.1 X3 Y2 I1 J1\n", setup);
  const Move& move = moves.back();
  const MoveCurve curve(moves[moves.size() - 2].end_machine, move);
  EXPECT_LT((curve.at(0.0) - moves[moves.size() - 2].end_machine).norm(), 10 * kExact);
  EXPECT_LT((move.spline->curve.points().back() - move.end_machine.head<3>()).norm(), 10 * kExact);
  const Vector3d middle = move.spline->curve.points()[1];
  EXPECT_NEAR(middle.x(), 0.1 + 2e-3 * std::cos(30 * deg) - 3e-3 * std::sin(30 * deg), 10 * kExact);
  EXPECT_NEAR(middle.z(), move.end_machine.z(), kExact);
}

TEST(Splines, InverseTimeIsThatOfTheWholeCurve) {
  const Move move = spline_of("G93\nG5.1 X3 Y2 I1 J1 F20");
  EXPECT_NEAR(move.spline->curve.length() / move.feed, 3.0, 1e-12);
}

TEST(Splines, WordsOfTheFirstBezierThatAreMissingAreThoseThatLinuxCncKeeps) {
  Interpreter interpreter(kHead + "G5 X3 Y2 P-1 Q3\nG1 X5\nG5 X7 Y2 P1 Q1\nM2\n", "p.nc",
                          usual_setup());
  const std::vector<Move> moves = interpreter.rest();
  expect_points(moves[1], {{1, 2}, {1, 2}, {2, 5}, {3, 2}});
  expect_points(moves[3], {{5, 2}, {6, -1}, {8, 3}, {7, 2}});
  ASSERT_EQ(interpreter.warnings().size(), 2U);
  EXPECT_EQ(interpreter.warnings()[1].message,
            "G5 without I and J, and no G5 ends here: read as I1 J-3, stored by LinuxCNC from the "
            "last G5 or G87");
}

struct Refused {
  std::string text, message;
};

TEST(Splines, EachRefusalHasItsReason) {
  const std::vector<Refused> all = {
      {"G5 I1 J1 P1 Q1", "G5 requires X or Y"},
      {"G5.1 I1 J1", "G5.1 requires X or Y"},
      {"G5 X2 I1 P1 Q1", "G5 requires both I and J, or neither to continue from the previous G5"},
      {"G5.1 X2 J1", "G5.1 requires both I and J"},
      {"G5.1 X2", "G5.1 requires both I and J"},
      {"G5 X2 I1 J1 P1", "G5 requires both P and Q"},
      {"G5 X2 Z1 I1 J1 P1 Q1", "Z word is not allowed with G5; a spline moves X and Y only"},
      {"G5.1 X2 A1 I1 J1", "A word is not allowed with G5.1; a spline moves X and Y only"},
      {"G5.2 X2 Y1 C1 P1", "C word is not allowed with G5.2; a spline moves X and Y only"},
      {"G18\nG5 X2 I1 J1 P1 Q1", "G5 requires G17; splines are in the XY plane"},
      {"G17.1\nG5.2 P1", "G5.2 requires G17; splines are in the XY plane"},
      {"G41.1 D1\nG5 X2 I1 J1 P1 Q1",
       "G5 is not allowed with cutter compensation active; program G40 first"},
      {"G41.1 D1\nG1 X3\nG5.2 P1",
       "G5.2 is not allowed with cutter compensation active; program G40 first"},
      {"G43.4 H1\nG5 X2 I1 J1 P1 Q1", "G5 is not allowed under TCP control; program G49 first"},
      {"F0\nG5 X2 I1 J1 P1 Q1", "G5 with zero feed rate; F0 is active, F must be > 0"},
      {"F0\nG5.2 P1", "G5.2 with zero feed rate; F0 is active, F must be > 0"},
      {"G93\nG5.1 X2 I1 J1", "G5.1 without F; G93 requires F in every block"},
      {"G93\nG5.1 X1 Y2 I0 J0 F1", "a spline of zero length is not allowed with G93"},
      {"G93\nG5.2 P1 F2",
       "G5.2 is not allowed with G93, where F is the time of one block; program G94 first"},
      {"G5.2 X2 P1", "G5.2 requires both X and Y"},
      {"G5.2 @2 ^30 P1", "G5.2 is not allowed with polar coordinates"},
      {"G5.2 X2 Y1", "G5.2 requires a weight P for each control point"},
      {"G5.2 X2 Y1 P0", "P0; the weight must be > 0"},
      {"G5.2 P-1", "P-1; the weight must be > 0"},
      {"G5.2 P1\nG5.2 P2",
       "G5.2 requires X and Y; only the first may define just the weight of the start point"},
      {"G5.2 P1 L-1", "L-1; must be >= 0"},
      {"G5.2 P1 L3.5", "L3.5; must be an integer"},
      {"G5.2 P1 L4\nX2 Y1 P1\nX3 Y1 P1\nG5.3",
       "3 control points including the start; a NURBS of order L4 requires at least 4"},
      {"G5.3", "G5.3 requires a preceding G5.2"},
      {"G5.2 P1\nX2 Y1 P1\nX3 Y1 P1\nG5.3\nX4", "axis words, but no active G code uses them"},
      {"G5.2 P1\nX2 Y1 P1\nX3 Y1 P1\nG5.3 X5", "axis words are not allowed with G5.3"},
      {"G5.2 P1\nX2 Y1 P1\nX3 Y1 P1\nG5.2 G5.3", "G5.2 and G5.3 are not allowed in one block"},
      {"G5.2 P1\nX2 Y1 P1\nX3 Y1 P1\nG1 G5.3", "G1 and G5.3 are not allowed in one block"},
      {"G5.2 P1\nG1 X3", "G1 is not allowed between G5.2 and G5.3; program only control points"},
      {"G5.2 P1\nG80", "G80 is not allowed between G5.2 and G5.3; program only control points"},
      {"G5.2 P1\nG5 X3 I1 J1 P1 Q1",
       "G5 is not allowed between G5.2 and G5.3; program only control points"},
      {"G5.2 P1\nX2 Y1 P1\nM2",
       "M2 is not allowed between G5.2 and G5.3; program only control points"},
      {"G5.2 P1\nX2 Y1 P1\nG92 X0\nX3 Y1 P1\nG5.3",
       "the unit, work coordinates or position change between G5.2 and G5.3; program the change "
       "before G5.2"},
      {"G5.2 P1\nX2 Y1 P1\nG20\nX3 Y1 P1\nG5.3",
       "the unit, work coordinates or position change between G5.2 and G5.3; program the change "
       "before G5.2"},
      {"G53 G5 X2 I1 J1 P1 Q1", "G53 requires G0 or G1"},
      {"G5.1 X2 I1 J1 P1",
       "P word without a code that uses it (G2, G3, G4, G5, G5.2, G10, G64, G74, G82, G84, G86, "
       "G88, G89, M50, M51, M52, M53, M62, M63, M64, M65)"},
  };
  for (const auto& [text, message] : all) EXPECT_EQ(message_of(text), message) << text;
}

TEST(Splines, AnOrderBelowThreeIsReadAsThree) {
  Interpreter interpreter(kHead + "G5.2 P1 L2\nX2 Y1 P1\nX3 Y1 P1\nG5.3\nM2\n", "p.nc",
                          usual_setup());
  EXPECT_EQ(interpreter.rest()[1].spline->curve.order(), 3);
  ASSERT_EQ(interpreter.warnings().size(), 1U);
  EXPECT_EQ(interpreter.warnings()[0].message, "G5.2 L2: read as L3, as in LinuxCNC");
}

std::string reading(const std::string& text, Reader reader) {
  ProgramSetup setup = usual_setup();
  setup.reader = reader;
  setup.decimal_point = DecimalPoint::calculator;
  return fault_of(text, setup);
}

TEST(Splines, OtherControlsHaveOtherCodesOfTheseNumbers) {
  const std::string spline = "G0 X1. Y2.\nG5.1 X2. Y2. I1. J1. F600.\n";
  EXPECT_EQ(reading(spline, Reader::linuxcnc), "");
  EXPECT_EQ(reading(spline, Reader::any), "");
  for (const Reader reader : {Reader::fanuc, Reader::haas, Reader::mach, Reader::grbl}) {
    const std::string fault = reading(spline, reader);
    EXPECT_NE(fault.find("p.nc:2:1: error: G5.1 with coordinates is not supported by"),
              std::string::npos)
        << fault;
  }
  // smoothing of Fanuc
  EXPECT_EQ(reading("G5.1 Q1\nG5 P10000\nG0 X1.\nG5 P0\nG5.1 Q0\n", Reader::fanuc), "");
  EXPECT_EQ(reading("G5.1 Q1\nG0 X1.\nG5.1 Q0\n", Reader::any), "");
}

TEST(Splines, NoControlHasThemInScaledOrRotatedCoordinates) {
  EXPECT_EQ(reading("G0 X1. Y2.\nG68 X0. Y0. R30.\nG5.1 X2. Y2. I1. J1. F600.\n", Reader::any),
            "p.nc:3:1: error: G5.1 is not supported with G16, G51, G51.1, G54.1 or G68, which no "
            "control with splines has; cancel it first");
}

}  // namespace
}  // namespace servomill::controllers::splines_test
