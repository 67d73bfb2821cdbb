/// Diagonals and circles that a run tests: closed forms, and the same sheet from the files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/machine_tests.h"
#include "sim/run/test_sheet.h"
#include "sim/standards/circle_test.h"
#include "sim/standards/diagonal_report.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::test_standards_test {
namespace {

// 3-4-12: the diagonals of the body are 130 mm long.
const std::string kBody =
    "[[test]]\nname = \"body\"\nstandard = \"iso230-6\"\n"
    "from = { X_mm = -15, Y_mm = -20, Z_mm = -20 }\nto = { X_mm = 15, Y_mm = 20, Z_mm = 100 }\n"
    "target_count = 5\nruns = 2\nfeed = \"6 m/min\"\ndwell_s = 0.2\n";
const std::string kFace =
    "[[test]]\nname = \"face\"\nstandard = \"iso230-6\"\n"
    "from = { X_mm = -30, Y_mm = -40 }\nto = { X_mm = 30, Y_mm = 40 }\n"
    "target_count = 5\nruns = 2\nfeed = \"6 m/min\"\ndwell_s = 0.2\n";
constexpr double kRadius = 50.0 * mm;

std::string circles(const std::string& plane = "XY", int readings = 720) {
  return "[[test]]\nname = \"circle\"\nstandard = \"iso230-4\"\nplane = \"" + plane +
         "\"\nradius_mm = 50\nfeed = \"3 m/min\"\ndwell_s = 0.2\n" +
         fmt::format("reading_count = {}\nat = {{ {}_mm = 0, {}_mm = 0 }}\n", readings, plane[0],
                     plane[1]);
}

TestResult tested(const std::string& errors, const std::string& test,
                  const std::string& servo = "servo = \"ideal\"\n") {
  const model::Scenario scenario = input::read_resolved_scenario(
      "machine = \"machines/hsm600u.toml\"\nmachine_errors = \"actual\"\n[errors.actual]\n" +
          errors + "\n" + test + "[[case]]\nname = \"ideal\"\n" + servo,
      SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
  return *run_named_case(scenario, "ideal").tests.at(0);
}

double value(const TestResult& result, const std::string& symbol) {
  for (const standards::ReportValue& one : result.report.values) {
    if (one.symbol == symbol) return one.value;
  }
  ADD_FAILURE() << symbol;
  return 0.0;
}

// Deviation at the last target of the first run, upwards.
double at_end(const TestResult& result, std::size_t line) {
  const standards::PositioningTest& test = result.lines.at(line).test;
  return test.up(test.up.rows() - 1, 0);
}

constexpr double kRounding = 1e-11;  // m: the signals are recorded in steps of 1 pm

// A diagonal (a, b, c) of length L: scale s of X makes it longer by s a^2 / L.
TEST(DiagonalTest, OfAScaleErrorGrowsAllOfThemAlike) {
  const TestResult result = tested("EXX = { um_per_m = 100.0 }", kBody);
  ASSERT_EQ(result.lines.size(), 4U);
  const double grown = 100e-6 * 30.0 * 30.0 / 130.0 * mm;
  for (std::size_t line = 0; line < 4; ++line) {
    EXPECT_NEAR(at_end(result, line), grown, kRounding) << result.lines[line].name;
  }
  EXPECT_NEAR(value(result, "E_d"), grown, kRounding);
  EXPECT_NEAR(value(result, "B_d"), 0.0, kRounding);
}

// Squareness alone: the diagonals of a face differ by 2 a b / L of the angle, one longer, one
// shorter; of the body two and two.
TEST(DiagonalTest, OfASquarenessDiffer) {
  const double off = 50e-6;                             // rad
  const double kSquare = 2.0 * off * off * 130.0 * mm;  // m, of second order
  const TestResult face = tested("EC0Y = { um_per_m = 50.0 }", kFace);
  ASSERT_EQ(face.lines.size(), 2U);
  EXPECT_EQ(face.lines[0].name + face.lines[1].name, "PPNP");
  EXPECT_NEAR(std::abs(at_end(face, 0) - at_end(face, 1)), 2.0 * off * 60.0 * 80.0 / 100.0 * mm,
              kSquare);
  EXPECT_NEAR(at_end(face, 0) + at_end(face, 1), 0.0, kSquare);
  const TestResult body = tested("EC0Y = { um_per_m = 50.0 }", kBody);
  const double each = off * 30.0 * 40.0 / 130.0 * mm;
  EXPECT_NEAR(std::abs(at_end(body, 0)), each, kSquare);
  EXPECT_NEAR(at_end(body, 0), -at_end(body, 1), kSquare);  // NPP
  EXPECT_NEAR(at_end(body, 0), -at_end(body, 2), kSquare);  // PNP
  EXPECT_NEAR(at_end(body, 0), at_end(body, 3), kSquare);   // PPN
}

// Lost motion of X shows with the cosine of the diagonal.
TEST(DiagonalTest, OfALostMotionGivesItsShareAsReversalError) {
  const TestResult result =
      tested("EXX = { reversal = { width_um = 6.0, distance_mm = 0.1 } }", kFace);
  EXPECT_NEAR(std::abs(value(result, "B_d")), 6.0 * 0.6 * um, kRounding);
}

const std::string kDevice =
    "seed = 3\n[test.device]\nscale_uncertainty_um_per_m = 100.0\nvariation_um = 0.5\n";

// One device reads all diagonals: its scale is the same in each, its noise is not.
TEST(DiagonalTest, IsReadByOneDevice) {
  const TestResult with_device = tested("EXX = { um_per_m = 0.0 }", kFace + kDevice);
  const double scale = at_end(with_device, 0) - with_device.lines[0].test.up(0, 0);
  EXPECT_GT(std::abs(scale), 0.6 * um);
  EXPECT_NEAR(at_end(with_device, 1) - with_device.lines[1].test.up(0, 0), scale, 1.0 * um);
  EXPECT_NE(at_end(with_device, 0), at_end(with_device, 1));
}

std::vector<std::string> written(const TestResult& result) {
  std::vector<std::string> out;
  for (const ReadingsFile& file : readings_files(result)) {
    const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / file.name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << file.text;
    out.push_back(path.string());
  }
  return out;
}

void expect_same_values(const standards::Report& a, const standards::Report& b) {
  constexpr double kPrinted = 5e-12;  // m, rad: of sums of readings that are printed to 1 pm
  ASSERT_EQ(a.values.size(), b.values.size());
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    EXPECT_EQ(a.values[k].symbol, b.values[k].symbol);
    EXPECT_NEAR(a.values[k].value, b.values[k].value,
                a.values[k].dimension == standards::Dimension::length ? kPrinted
                                                                      : 10.0 * kPrinted / kRadius)
        << a.values[k].symbol;
  }
}

TEST(DiagonalTest, GivesTheSameSheetThroughTheReaderOfFiles) {
  const TestResult result = tested(
      "EC0Y = { um_per_m = 50.0 }\nEXX = { reversal = { width_um = 6.0, distance_mm = 0.1 } }",
      kBody + kDevice);
  std::vector<standards::PositioningFile> files;
  for (const std::string& path : written(result))
    files.push_back(standards::read_positioning(path));
  expect_same_values(result.report, standards::diagonal_report(files));
}

std::string refusal(const std::string& test) {
  try {
    tested("EXX = { um_per_m = 0.0 }", test);
  } catch (const InputError& error) {
    std::string text = error.what();
    for (std::size_t at = 0; (at = text.find(SERVOMILL_SOURCE_DIR)) != text.npos;) {
      text.erase(at, text.find("error: ", at) + 7 - at);
    }
    return text;
  }
  return "run";
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// A fault does not make the keys that depend on its value unknown, and no place is 0 unsaid.
TEST(TestKeys, AreRefusedOnce) {
  EXPECT_EQ(
      refusal(changed(circles(), "iso230-4", "iso230-3")),
      "test[0].standard = \"iso230-3\"; must be one of iso230-2, iso230-6, iso230-4, iso230-7, "
      "iso10791-6; did you mean 'iso230-2'?");
  EXPECT_EQ(refusal(changed(kFace, "Y_mm = 40", "Y_mm = -40")),
            "test[0].to.Y_mm = -40; must be above that of from");
  EXPECT_EQ(refusal(changed(circles(), ", Y_mm = 0", "")),
            "test[0].at: Y_mm is missing: the centre of the circles");
  EXPECT_EQ(refusal(changed(circles(), "at = { X_mm = 0, Y_mm = 0 }\n", "")),
            "test[0].at is missing");
}

// 150 m/min on a circle of 50 mm would need 125 m/s^2.
TEST(CircleTest, NotesTheReachedFeed) {
  const TestResult slow = tested("EXX = { um_per_m = 0.0 }", circles());
  EXPECT_TRUE(slow.report.remarks.empty());
  const TestResult fast =
      tested("EXX = { um_per_m = 0.0 }", changed(circles("XY", 72), "3 m/min", "40 m/min"));
  ASSERT_EQ(fast.report.remarks.size(), 1U);
  EXPECT_EQ(fast.report.remarks[0].find("the programmed feed of 40000 mm/min is not reached: "),
            0U);
  // the acceleration that the axes have, v^2 / r
  EXPECT_LT(fast.feeds.max * fast.feeds.max / kRadius, 8.0);
}

// A perfect machine runs a perfect circle.
TEST(CircleTest, OfAPerfectMachineIsRound) {
  const TestResult result = tested("EXX = { um_per_m = 0.0 }", circles());
  ASSERT_TRUE(result.circle);
  EXPECT_EQ(result.circle->turns.at(0).points.size(), 720U);
  for (const char* const symbol : {"G_ccw", "G_cw", "G_b", "D", "B_1", "B_2"}) {
    EXPECT_NEAR(value(result, symbol), 0.0, 1 * nm) << symbol;
  }
}

// Squareness a makes the radius R (1 + a / 2 sin 2 theta): G is R a; the axes close up for the sign
// of the error whose diagonal PP grows.
TEST(CircleTest, OfASquarenessAndAScaleGivesThem) {
  for (const std::string plane : {"XY", "ZX", "YZ"}) {
    const std::string error = plane == "XY" ? "EC0Y" : plane == "ZX" ? "EB0Z" : "EA0Z";
    const TestResult result = tested(error + " = { um_per_m = 100.0 }", circles(plane));
    EXPECT_NEAR(std::abs(value(result, "squareness")), 100e-6, 0.1e-6) << plane;
    EXPECT_NEAR(value(result, "G_b"), 100e-6 * kRadius, 5 * nm) << plane;
    EXPECT_NEAR(value(result, "scale_mismatch"), 0.0, 0.1e-6) << plane;
  }
  const TestResult scale = tested("EXX = { um_per_m = 200.0 }", circles());
  EXPECT_NEAR(value(scale, "scale_mismatch"), 200e-6, 0.1e-6);
  EXPECT_NEAR(value(scale, "D"), -0.5 * 200e-6 * kRadius, 5 * nm);
}

// Close readings: those next to a quadrant are in the change of direction.
TEST(CircleTest, OfALostMotionGivesItAsReversalError) {
  const TestResult result =
      tested("EXX = { reversal = { width_um = -3.0, distance_mm = 0.0001 } }", circles("XY", 3600));
  EXPECT_NEAR(value(result, "B_1"), -3.0 * um, 0.03 * um);
  EXPECT_NEAR(value(result, "B_2"), 0.0, 0.03 * um);
}

TEST(CircleTest, GivesTheSameSheetThroughTheReaderOfFiles) {
  const TestResult result = tested(
      "EXX = { reversal = { width_um = -3.0, distance_mm = 0.1 } }\nEC0Y = { um_per_m = 30.0 }",
      circles() +
          "seed = 3\n[test.device]\nresolution_um = 0.1\nvariation_um = 0.4\n"
          "set_up_um = 0.5\ndrift_um = 0.2\n",
      "servo = \"cascade\"\n");
  const standards::CircleTest read = standards::read_circle(written(result).at(0), kRadius);
  expect_same_values(result.report, standards::circle_report(read));
}

}  // namespace
}  // namespace servomill::sim::run::test_standards_test
