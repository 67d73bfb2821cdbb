#include "controllers/gcode/printer.h"

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "plant/vocabulary/spline_curve.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::printer_test {
namespace {

// Half a step of the seventh decimal, and the rounding of an arc centre seen from a rounded start.
constexpr double kPrintTol = 0.6e-7 * mm;        // m
constexpr double kPrintAngleTol = 0.6e-7 * deg;  // rad
// Inverse time: the rate is printed with 12 digits, but the length it multiplies has rounded ends.
constexpr double kFeedTol = 1e-4;  // relative, moves of 1e-3 mm and more

ProgramSetup wide_setup() {
  ProgramSetup setup = usual_setup();
  setup.work_offset[0] = axes(1, 2, 3, 4, 5, 6);
  setup.work_offset[1] = axes(-10, 20, 30, 0, 0, 90);
  setup.work_rotation[1] = 0.25;
  setup.start = axes(5, 6, 7, 8, 9, 10);
  return setup;
}

std::vector<Move> reread(const std::vector<Move>& moves, const ProgramSetup& setup) {
  return interpret(print_program(moves, {}, "printed").text, "printed.nc", setup);
}

void expect_same(const Move& a, const Move& b) {
  EXPECT_EQ(a.kind, b.kind);
  if (is_motion(a.kind)) {
    EXPECT_LE((a.end - b.end).head<3>().cwiseAbs().maxCoeff(), kPrintTol);
    EXPECT_LE((a.end - b.end).tail<3>().cwiseAbs().maxCoeff(), kPrintAngleTol);
    EXPECT_LE((a.end_machine - b.end_machine).head<3>().cwiseAbs().maxCoeff(), 2 * kPrintTol);
    EXPECT_EQ(a.path_mode, b.path_mode);
    EXPECT_NEAR(a.path_tolerance, b.path_tolerance, kExact);
    EXPECT_EQ(a.work_offset, b.work_offset);
    EXPECT_EQ(a.tool_offset, b.tool_offset);
  }
  if (a.kind == MoveKind::feed || a.kind == MoveKind::arc) {
    EXPECT_EQ(a.feed_mode, b.feed_mode);
    EXPECT_NEAR(a.feed, b.feed, kFeedTol * a.feed);
  }
  if (a.kind == MoveKind::arc) {
    EXPECT_EQ(a.arc.normal_axis, b.arc.normal_axis);
    EXPECT_EQ(a.arc.turns, b.arc.turns);
    EXPECT_LE((a.arc.centre - b.arc.centre).cwiseAbs().maxCoeff(), kPrintTol);
  }
  if (a.kind == MoveKind::spline) {
    EXPECT_NEAR(a.feed, b.feed, kFeedTol * a.feed);
    EXPECT_EQ(a.spline->curve.order(), b.spline->curve.order());
    EXPECT_EQ(a.spline->curve.weights(), b.spline->curve.weights());
    ASSERT_EQ(a.spline->points.size(), b.spline->points.size());
    for (std::size_t i = 0; i < a.spline->points.size(); ++i) {
      EXPECT_LE((a.spline->points[i] - b.spline->points[i]).head<2>().norm(), 2 * kPrintTol);
    }
  }
  EXPECT_NEAR(a.value, b.value, 1e-11 * std::abs(a.value));
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.text, b.text);
}

void expect_round_trip(const std::string& text, const ProgramSetup& setup) {
  const std::vector<Move> moves = interpret(text, "p.nc", setup);
  const std::vector<Move> again = reread(moves, setup);
  ASSERT_EQ(moves.size(), again.size()) << text << print_program(moves, {}, "").text;
  for (std::size_t i = 0; i < moves.size(); ++i) expect_same(moves[i], again[i]);
  if (testing::Test::HasFailure()) FAIL() << text << "----\n" << print_program(moves, {}, "").text;
}

TEST(Printer, WritesWhatAPersonWouldWrite) {
  const PrintedProgram printed = print_program(
      interpret(
          "T1 M6\nG43 H1\nS1000 M3\nG64 P0.02\nG0 X1 Y2\nG1 Z-1 F300\nX5\nG2 X7 I1\nG4 P0.5\nM2",
          "p.nc", usual_setup()),
      {.axes = "XYZ"}, "square part\nside 1");
  EXPECT_EQ(printed.text,
            "(square part)\n(side 1)\nG21 G90 G91.1 G94 G17 G40 G80 G92.1\nT1 "
            "M6\nS1000\nM3\nG54\nG43 H1\n"
            "G64 P0.02\nG0 X1 Y2 Z-100\nG1 Z-1 F300\nG1 X5\nG2 X7 I1 J0\nG4 P0.5\nM5\nM30\n");
  EXPECT_EQ(printed.move_of_line,
            (std::vector<int>{-1, -1, -1, 0, 1, 2, 3, 3, 3, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(Printer, PrintsMovesAsTheyCome) {
  const std::vector<Move> moves =
      interpret("G0 X1 Y2\nG4 P1\nG1 Z-1 F300\nM2\n", "p.nc", usual_setup());
  std::string text;
  ProgramPrinter printer({.axes = "XYZ"}, "header",
                         [&](std::string_view line) { text += std::string(line) + "\n"; });
  EXPECT_EQ(text, "(header)\nG21 G90 G91.1 G94 G17 G40 G80 G92.1\n");
  std::size_t lines = 0;
  for (const Move& move : moves) {
    printer.print(move);
    EXPECT_GT(text.size(), lines);
    lines = text.size();
  }
  printer.finish();
  EXPECT_EQ(text.size(), lines) << "it has ended";
  EXPECT_EQ(text, print_program(moves, {.axes = "XYZ"}, "header").text);
  printer.print(moves.front());
  printer.finish();
  EXPECT_TRUE(text.ends_with("M30\n"));
}

TEST(Printer, SplinesAreNurbs) {
  const ProgramSetup setup = usual_setup();
  expect_round_trip(
      "G0 X1 Y2\nG5 X3 Y2 I1 J2 P-1 Q3 F500\nG1 X4\nG5.1 X6 Y3 I1 J1\nG93\nG5.1 X9 I1 J2 F4\nG94 "
      "F100\nG55\nG5.2 P2 L4\nX7 Y1 P0.25\nX8 Y3 P1\nX9 Y2 P3\nG5.3\nG1 Z3\nM2\n",
      setup);
  EXPECT_NE(print_program(moves_of("G0 X1 Y2\nG5.1 X3 Y2 I1 J2 F500"), {.axes = "XYZ"}, "")
                .text.find("G5.2 P1 L3 F500\nX2 Y4 P1\nX3 Y2 P1\nG5.3\n"),
            std::string::npos);
}

TEST(Printer, DecimalsRoundAndUnchangedWordsAreLeftOut) {
  const auto moves = moves_of("G1 X1.23456 Y-0.00001 F60\nX1.23449");
  EXPECT_EQ(
      print_program(moves, {.decimals_mm = 3, .decimals_deg = 3, .axes = "XYZ"}, "").text,
      "G21 G90 G91.1 G94 G17 G40 G80 G92.1\nG54\nG49\nG64\nG1 X1.235 Y0 Z0 F60\nG1 X1.234\nM30\n");
}

TEST(Printer, ShortArcDoesNotBecomeAFullCircle) {
  const auto moves =
      moves_of("G1 X10 F60\nG3 X9.9999999 Y0.0014142 I-10\nG3 X10 Y0 I-9.9999999 J-0.0014142");
  const std::string text =
      print_program(std::span(moves).first(2), {.decimals_mm = 2, .axes = "XYZ"}, "").text;
  EXPECT_NE(text.find("G1 X10\n"), std::string::npos) << text;
  // the long way round stays an arc
  EXPECT_NE(print_program(moves, {.decimals_mm = 2, .axes = "XYZ"}, "").text.find("G3"),
            std::string::npos);
}

TEST(Printer, RefusesToolOffsetsOutsideTheTable) {
  const auto moves = moves_of("G43.1 Z5\nG0 X1");
  try {
    print_program(moves, {}, "");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "<input>:2: error: tool offsets of G43.1 and G43.2 cannot be output; use G43 H");
  }
}

Move feed_to(const AxisWords& end, double feed, FeedMode mode) {
  Move move;
  move.end = move.end_machine = end;
  move.feed = feed;
  move.feed_mode = mode;
  return move;
}

std::string line_of(const std::vector<Move>& moves, std::size_t index, const AxisWords& start) {
  PrintOptions options;
  options.start = start;
  const PrintedProgram printed = print_program(moves, options, "");
  const auto found = std::find(printed.move_of_line.rbegin(), printed.move_of_line.rend(),
                               static_cast<int>(index));
  std::size_t line = static_cast<std::size_t>(printed.move_of_line.rend() - found) - 1;
  std::string_view text = printed.text;
  for (; line > 0; --line) text.remove_prefix(text.find('\n') + 1);
  return std::string(text.substr(0, text.find('\n')));
}

// 60 deg in 2 s: F30 in 1/min. The message tells the place of the tip, which no axis has moved to.
TEST(Printer, MeasuresTheWayOfABlockFromTheMotionBefore) {
  Move turn = feed_to(axes(1, 0, 0, 60, 0, 0), 30 * deg, FeedMode::inverse_time);
  Move message;
  message.kind = MoveKind::message;
  message.end_machine = axes(7, 8, 9, 0, 0, 0);
  const std::vector<Move> moves = {feed_to(axes(0, 0, 0, 0, 0, 0), 1, FeedMode::units_per_minute),
                                   message, turn};
  EXPECT_EQ(line_of(moves, 2, AxisWords::Zero()), "G1 X1 A60 F30");
  // the same as the first block of a program that begins at 0 deg and at 30 deg
  EXPECT_EQ(line_of({turn}, 0, AxisWords::Zero()), "G1 X1 Y0 Z0 A60 B0 C0 F30");
  turn.feed = 15 * deg;
  EXPECT_EQ(line_of({turn}, 0, axes(1, 0, 0, 30, 0, 0)), "G1 X1 Y0 Z0 A60 B0 C0 F30");
}

// X moves where the path of the original stands: F is in mm/min.
TEST(Printer, GivesTheFeedOfAnAxisThatMovesBesideThePathInMillimetres) {
  const Move moves =
      feed_to(axes(0.01, 0, 0, 0, 0, 0), 500 * mm_per_min, FeedMode::units_per_minute);
  EXPECT_EQ(line_of({moves}, 0, AxisWords::Zero()), "G1 X0.01 Y0 Z0 A0 B0 C0 F500");
}

// A rotary axis whose word is 0 stands elsewhere after a change of offset.
TEST(Printer, SynchronisedMotionAfterAChangeOfOffsetNamesAllAxes) {
  const std::string text = "G43 H1\nS600 M3\nG0 X1 Y2 Z3 A0 B0 C5\nG55\nG33 X0 Z-4 C0 K2\nM2\n";
  expect_round_trip(text, wide_setup());
  const std::string printed =
      print_program(interpret(text, "p.nc", wide_setup()), {.axes = "XYZC"}, "").text;
  EXPECT_NE(printed.find("G55\nG33 X0 Y-18.4714463 Z-4 A4 B5 C0 K2\n"), std::string::npos)
      << printed;
}

TEST(Printer, RoundTripOfEveryFeature) {
  expect_round_trip(
      "(MSG,hello #1)\nS500\nM3\nM3\nM7\nM8\nM9\nM9\nT3 M6\nM4\nG61\nG0 X1\nG61.1 G1 Y2 F100\nG64\n"
      "G1 X1\nG1 X1\nG55\nG2 X30 Y0 R40\nG43 H1\nG3 I5 Z1 P3\nG18 G2 X35 Z3 R50 A5\nG19 G3 Y3 Z9 "
      "R-20\n"
      "G93 G1 X1 F30\nC7 F2\nG94\nG1 B7 F200\nX5\nG49\nG53 G0 X0 Y0\nG4 P0.125\nM1\nM0\nM5\nM30\n",
      wide_setup());
}

std::string random_program(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-50.0, 50.0);
  const auto number = [&] { return fmt::format("{:.9f}", uniform(random)); };
  std::string text = "F500 G0 X1 Y1 Z1\n";
  for (int i = 0; i < 30; ++i) {
    switch (random() % 9) {
      case 0:
        text += fmt::format("G5{}\n", 4 + random() % 2);
        break;
      case 1:
        text += random() % 2 == 0 ? "G43 H3\n" : "G49\n";
        break;
      case 2:
        text += fmt::format("G0 X{} C{}\n", number(), number());
        break;
      case 3:
        text +=
            fmt::format("G{} G3 I{} J{} K{} P{}\n", 17, number(), number(), 0, 1 + random() % 3);
        text.replace(text.rfind(" K0"), 3, "");
        break;
      case 4: {
        const std::string end = number();
        text += fmt::format("G18 G91 G2 X{} Z1 R{} A{}\nG90\n", end, 60.0, number());
        break;
      }
      case 5:
        text += fmt::format("G93 G1 X{} A{} F{:.6f}\nG94 F{:.4f}\n", number(), number(),
                            1.0 + std::abs(uniform(random)), 100 + uniform(random));
        break;
      case 6:
        text += fmt::format("G64 P{:.5f}\n", std::abs(uniform(random)));
        break;
      default:
        text += fmt::format("G1 X{} Y{} Z{} B{}\n", number(), number(), number(), number());
    }
  }
  return text + "M2\n";
}

TEST(Printer, RoundTripOfRandomPrograms) {
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) expect_round_trip(random_program(random), wide_setup());
}

}  // namespace
}  // namespace servomill::controllers::printer_test
