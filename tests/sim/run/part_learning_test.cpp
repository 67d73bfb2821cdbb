/// Learning from a part on the CMM: the shop runs the program, measures the part and corrects the
/// next run. Here the machine is simulated, so that its errors are known.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "strategies/path_offset.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::part_learning_test {
namespace {

namespace fs = std::filesystem;

// A tool of 8 mm along the side at Y0, up the side at X100, over the top, and inside a bore of 20
// mm and around a boss of 20 mm, at 50 mm/s.
const std::string kProgram =
    "G17 G21 G40 G90 G94 G64 P0.0001\nT1 M6\nG43 H1\nF3000\n"
    "G0 X-10 Y-4 Z20\nG1 Z-10\nG1 X110\nG0 Z20\nG0 X104 Y-10\nG1 Z-10\nG1 Y60\n"
    "G0 Z20\nG0 X-10 Y3\nG1 Z0\nG1 X110\nG0 Z20\n"
    "G0 X150 Y50\nG1 Z-10\nG1 X156\nG3 I-6\nG1 X150\nG0 Z20\n"
    "G0 X74 Y50\nG1 Z0\nG2 I-24\nG0 Z20\nM2\n";

const std::string kTool =
    "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\nflute_length_mm = 25.0\n";

std::string flank(int points) {
  return fmt::format(
      "[[probe]]\nname = \"flank\"\nline = {{ from_mm = [0.0, 0.0, -5.0], to_mm = [100.0, 0.0, "
      "-5.0], normal = [0, -1, 0], points = {} }}\n",
      points);
}
const std::string kSide =
    "[[probe]]\nname = \"side\"\nline = { from_mm = [100.0, 0.0, -5.0], to_mm = [100.0, 50.0, "
    "-5.0], normal = [1, 0, 0], points = 26 }\n";
const std::string kTop =
    "[[probe]]\nname = \"top\"\nline = { from_mm = [0.0, 4.0, 0.0], to_mm = [100.0, 4.0, 0.0], "
    "normal = [0, 0, 1], points = 51 }\n";
const std::string kRound =
    "[[probe]]\nname = \"bore\"\ncircle = { centre_mm = [150.0, 50.0, -5.0], radius_mm = 10.0, "
    "outside = false, points = 36 }\n"
    "[[probe]]\nname = \"boss\"\ncircle = { centre_mm = [50.0, 50.0, 3.0], radius_mm = 20.0, "
    "outside = true, points = 36 }\n";

const std::string kPlain = "[[case]]\nname = \"plain\"\nservo = \"ideal\"\n";

std::string learning(const std::string& keys, const std::string& servo = "ideal") {
  return fmt::format(
      "[[case]]\nname = \"next\"\nservo = \"{}\"\n[[case.strategy]]\ntype = \"learning\"\n"
      "cutoff_Hz = 60.0\nlimits = \"ignore\"\n{}",
      servo, keys);
}

class PartLearning : public testing::Test {
 protected:
  PartLearning() : folder_(fs::path(testing::TempDir()) / fmt::format("part_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~PartLearning() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string part(const std::string& file, const std::string& more = "") const {
    return fmt::format("[[case.strategy.recording]]\nfile = \"{}\"\nsees = \"part\"\n{}",
                       path(file), more);
  }
  std::string of_case(const std::string& file, const std::string& more = "") const {
    return part(file, "case = \"plain\"\n" + more);
  }
  void csv(const std::string& name, const std::string& rows) const {
    std::ofstream(path(name)) << "x_mm,y_mm,z_mm,i,j,k,deviation_um\n" << rows;
  }

  static model::Scenario scenario(const std::string& toml, const std::string& program = kProgram) {
    return small_scenario(program, "machine_errors = \"machine\"\n" + kTool + toml);
  }
  RunOutput run(const model::Scenario& one) const {
    RunControl control;
    control.threads = 1;
    return run_scenario(one, control);
  }
  // Cuts and probes the part of the plain case into a result file.
  std::vector<evaluation::ProbedFeature> keep(const std::string& toml, const std::string& file,
                                              const std::string& one_case = kPlain) const {
    const model::Scenario one = scenario(toml + one_case);
    const RunOutput output = run(one);
    RunStore store(path(file), true, one);
    store.add(output.cases[0]);
    store.commit({});
    return output.cases[0].probes;
  }
  // The lesson of a case that learns.
  LearntRuns learnt(const std::string& keys, const std::string& program = kProgram,
                    const std::string& toml = "[errors.machine]\n") const {
    return run_named_case(scenario(toml + learning(keys), program), "next").learnt.at(0);
  }
  std::string refusal(const std::string& keys, const std::string& tool = kTool) const {
    std::string text = "accepted";
    try {
      const model::Scenario one = small_scenario(kProgram, tool + learning(keys));
      preparation::PreparedCase prepared(one, one.cases.front());
      prepared.teach();
    } catch (const InputError& error) {
      text = error.what();
    }
    for (const std::string& folder :
         {folder_.string() + "/", std::string(SERVOMILL_SOURCE_DIR "/scenarios/")}) {
      for (auto at = text.find(folder); at != std::string::npos; at = text.find(folder)) {
        text.erase(at, folder.size());
      }
    }
    return text;
  }

  fs::path folder_;
};

double largest(const std::vector<double>& values) {
  double out = 0.0;
  for (const double one : values) out = std::max(out, std::abs(one));
  return out;
}

// Displacement (um) of the tip of ideal axes where their reference comes nearest to a place (mm).
Eigen::Vector3d displacement_at(const CaseOutput& run, const Eigen::Vector3d& place) {
  const records::Series& servo = run.result.servo;
  const auto vector = [&](std::size_t n, const char* name) {
    return Eigen::Vector3d(servo.at(n, *servo.column(name, 'X')),
                           servo.at(n, *servo.column(name, 'Y')),
                           servo.at(n, *servo.column(name, 'Z')));
  };
  const Eigen::Vector3d tool(0.0, 0.0, 110.0);  // its length
  std::size_t best = 0;
  const auto off = [&](std::size_t n) { return (vector(n, "ref_linear") - tool - place).norm(); };
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    if (off(n) < off(best)) best = n;
  }
  EXPECT_LT(off(best), 0.1) << "mm";
  return 1e3 * (vector(best, "tool_position_true") - vector(best, "ref_linear") + tool);
}

// um at the points of the flank, 2 mm apart, that chords between points 10 mm apart leave of a
// harmonic
double left_by_chords(std::size_t point, double amplitude_um, double period_mm) {
  const auto harmonic = [&](double x) {
    return amplitude_um * std::sin(2.0 * std::numbers::pi * x / period_mm);
  };
  const double x = 2.0 * static_cast<double>(point), begin = 10.0 * std::floor(x / 10.0);
  const double share = (x - begin) / 10.0;
  return harmonic(x) - (1.0 - share) * harmonic(begin) - share * harmonic(begin + 10.0);
}

constexpr double kPart = 0.3;    // um: filter at 60 Hz, lines between points
constexpr double kShifts = 0.1;  // um: the same where errors change slowly along the path

// The straightness of X, seen at 11 points: the next part has what chords between them leave.
TEST_F(PartLearning, LeavesWhatLinesBetweenThePointsLeave) {
  const std::string error =
      "[errors.machine]\nEYX = { harmonic = { amplitude_um = 20.0, period_mm = 50.0 } }\n";
  const auto before = keep(error + flank(11), "part.h5");
  EXPECT_GT(largest(before[0].deviation), 18 * um);
  const RunOutput output = run(scenario(error + flank(51) + learning(of_case("part.h5"))));
  const std::vector<double>& left = output.cases[0].probes[0].deviation;
  ASSERT_EQ(left.size(), 51U);
  // the work lies at machine zero, so that the harmonic begins at X0, and the face is at -Y
  for (std::size_t n = 0; n < left.size(); ++n) {
    EXPECT_NEAR(left[n] / um, -left_by_chords(n, 20.0, 50.0), kPart) << n;
  }
}

// Scales that are off, a squareness and a table that is not level: on all faces at once.
TEST_F(PartLearning, CorrectsWallsFloorBoreAndBoss) {
  const std::string error =
      "[errors.machine]\nEXX = { polynomial_um = [12.0] }\nEYY = { polynomial_um = [-9.0] }\n"
      "EZZ = { polynomial_um = [11.0] }\nEC0Y = \"100 urad\"\n";
  const std::string probes = flank(51) + kSide + kTop + kRound;
  const auto before = keep(error + probes, "part.h5");
  const RunOutput output = run(scenario(error + probes + learning(of_case("part.h5"))));
  const auto& after = output.cases[0].probes;
  ASSERT_EQ(after.size(), 5U);
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_GT(largest(before[k].deviation), 8 * um) << before[k].name;
    EXPECT_LT(largest(after[k].deviation), kShifts * um) << after[k].name;
  }
}

// The part lies beside machine zero, on a table that is turned: what is a side of it in its program
// faces elsewhere in the workpiece.
TEST_F(PartLearning, CountsInWorkCoordinates) {
  const std::string error =
      "[errors.machine]\nEXX = { polynomial_um = [20.0] }\nEYY = { polynomial_um = [-15.0] }\n";
  const std::string offset =
      "work_offset = { X_mm = 30.0, Y_mm = -20.0, Z_mm = 5.0, C_deg = 50.0 }\n";
  const std::string probes = flank(11) + kSide + kRound;
  const auto before = keep(error + probes, "part.h5", kPlain + offset);
  const std::string next = learning("") + of_case("part.h5");
  const auto case_end = next.find("[[case.strategy]]");
  const RunOutput output =
      run(scenario(error + probes + next.substr(0, case_end) + offset + next.substr(case_end)));
  const auto& after = output.cases[0].probes;
  ASSERT_EQ(after.size(), 4U);
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_GT(largest(before[k].deviation), 12 * um) << before[k].name;
    EXPECT_LT(largest(after[k].deviation), kPart * um) << after[k].name;
  }
}

// A ball of 8 mm along a slope of 45 deg through X, its centre 4 mm off along the normal. Of shifts
// along Y and Z the slope shows 16 and -9 um / sqrt(2), and gets that much back along its normal.
TEST_F(PartLearning, CorrectsASlopeThatABallHasCut) {
  const std::string program =
      "G17 G21 G40 G90 G94 G64 P0.0001\nT1 M6\nG43 H1\nF3000\n"
      "G0 X-10 Y-2.828427 Z20\nG1 Z-1.171573\nG1 X110\nG0 Z20\nM2\n";
  std::string points;
  for (int x = 0; x <= 100; x += 20) {
    points += fmt::format("{}[{}, 0, 0, 0, -0.70710678, 0.70710678]", x > 0 ? ", " : "", x);
  }
  const auto ball = [&](const std::string& toml) {
    return small_scenario(
        program, "machine_errors = \"machine\"\n" + kTool +
                     "corner_radius_mm = 4.0\n[errors.machine]\nEYY = { polynomial_um = [16.0] "
                     "}\nEZZ = { polynomial_um = [-9.0] }\n[[probe]]\nname = \"slope\"\n"
                     "points_mm = [" +
                     points + "]\n" + toml);
  };
  const model::Scenario plain = ball(kPlain);
  const RunOutput before = run(plain);
  RunStore store(path("part.h5"), true, plain);
  store.add(before.cases[0]);
  store.commit({});
  const double shown = (-16.0 - 9.0) / std::numbers::sqrt2;
  const RunOutput after = run(ball(learning(of_case("part.h5"))));
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_NEAR(before.cases[0].probes[0].deviation[n] / um, shown, 0.05) << n;
    EXPECT_NEAR(after.cases[0].probes[0].deviation[n] / um, 0.0, 0.05) << n;
  }
  const Eigen::Vector3d back = displacement_at(after.cases[0], {50, -2.828427, -1.171573});
  const Eigen::Vector3d wanted =
      Eigen::Vector3d(0, 16, -9) - shown * Eigen::Vector3d(0, -1, 1) / std::numbers::sqrt2;
  EXPECT_LT((back - wanted).norm(), 0.05) << back.transpose();
}

// A flat end mill leaves the lowest of what passes within its radius, 4 mm at 0.47 um/mm: of a
// slope a part shows less than the tip has, and the next part again.
TEST_F(PartLearning, GoesOnFromPartToPart) {
  const std::string error =
      "[errors.machine]\nEZX = { harmonic = { amplitude_um = 15.0, period_mm = 200.0 } }\n" + kTop;
  std::string runs;
  std::vector<double> left = {largest(keep(error, "part_0.h5")[0].deviation)};
  for (int k = 0; k < 2; ++k) {
    runs += part(fmt::format("part_{}.h5", k), k == 0 ? "case = \"plain\"\n" : "case = \"next\"\n");
    const auto after = keep(error, fmt::format("part_{}.h5", k + 1), learning(runs));
    left.push_back(largest(after[0].deviation));
  }
  EXPECT_NEAR(left[0] / um, 15.0, kPart);
  EXPECT_NEAR(left[1] / um, 4.0 * 15.0 * 2.0 * std::numbers::pi / 200.0, kPart);
  EXPECT_LT(left[2], 0.5 * um);
}

// Servo axes lag behind the setpoint; the offset is by place, and goes through their response.
TEST_F(PartLearning, CorrectsAMachineWithServoAxes) {
  const std::string error =
      "[errors.machine]\nEYX = { harmonic = { amplitude_um = 20.0, period_mm = 50.0 } }\n";
  keep(error + flank(51), "part.h5");
  const RunOutput output =
      run(scenario(error + flank(51) + learning(of_case("part.h5"), "cascade")));
  EXPECT_LT(largest(output.cases[0].probes[0].deviation), 1.0 * um);
}

// Worked by hand. Material is left on the flank, more and more towards X100: the tool has to go
// further, to +Y. Too much is cut from the side: it has to stay away, at +X. The top is too high.
TEST_F(PartLearning, GivesTheOffsetThatTakesAwayAKnownDeviation) {
  csv("part.csv", "0,0,-5,0,-1,0,10\n100,0,-5,0,-1,0,20\n100,20,-5,1,0,0,-5\n50,3,0,0,0,1,7\n");
  const CaseOutput one = run_named_case(
      scenario("[errors.machine]\n[record]\nperiod_ms = 0.2\n" + learning(part("part.csv"))),
      "next");
  const auto expect = [&](const Eigen::Vector3d& place, const Eigen::Vector3d& wanted) {
    const Eigen::Vector3d found = displacement_at(one, place);
    EXPECT_LT((found - wanted).norm(), kPart) << place.transpose() << ": " << found.transpose();
  };
  expect({-5, -4, -10}, {0, 10, 0});
  expect({25, -4, -10}, {0, 12.5, 0});
  expect({75, -4, -10}, {0, 17.5, 0});
  expect({105, -4, -10}, {0, 20, 0});
  expect({104, 40, -10}, {5, 0, 0});
  expect({20, 3, 0}, {0, 0, -7});
  expect({150, 44, -10}, {0, 0, 0});  // the bore was not probed
}

TEST_F(PartLearning, TellsWhatNoPointWasProbedOf) {
  csv("part.csv", "50,0,-5,0,-1,0,12\n100,20,-5,1,0,0,12\n");
  const RunOutput output = run(scenario("[errors.machine]\n" + learning(part("part.csv"))));
  const std::string note = fmt::format(
      "case next: strategy learning: {} has no point of the feed motion in lines 14-15, 18-21, "
      "24-25 of small.ngc, which receives no offset",
      path("part.csv"));
  const auto& notes = output.cases[0].notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(), note), 1) << fmt::format("{}", notes.at(0));
}

// Features may be chosen; rotary axes get no offset.
TEST_F(PartLearning, TakesTheProbesThatItIsTold) {
  const std::string error =
      "[errors.machine]\nEXX = { polynomial_um = [12.0] }\n"
      "EYY = { polynomial_um = [-9.0] }\n";
  keep(error + flank(11) + kSide, "part.h5");
  const LearntRuns one =
      learnt("axes = \"all\"\n" + of_case("part.h5", "probes = [\"side\"]\n"), kProgram, error);
  double x = 0.0, others = 0.0;
  for (const Joints& row : one.lesson.offset->offset) {
    x = std::max(x, std::abs(row[0]));
    others = std::max(others, row.tail<4>().cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(x / um, 12.0, 0.3);
  EXPECT_NEAR(others, 0.0, 1e-12);
}

TEST_F(PartLearning, RefusesPointsThatTheProgramHasNotCut) {
  csv("far.csv", "50,0,-5,0,-1,0,12\n50,1,-5,0,-1,0,12\n50,0,-5,0,-1,0,0\n");
  EXPECT_EQ(refusal(part("far.csv")),
            "far.csv:3: error: point X50 Y1 Z-5: line 7 of small.ngc passes 1 mm from it, more "
            "than 0.1 mm beyond its deviation; check work coordinates, diameter of the tool and "
            "side to which the normal points");
  csv("away.csv", "500,0,-5,0,0,-1,12\n");
  EXPECT_EQ(refusal(part("away.csv")),
            "away.csv:2: error: point X500 Y0 Z-5: no feed motion of small.ngc has a cutting edge "
            "that faces it; check work coordinates, diameter of the tool and side to which the "
            "normal points");
  csv("end.csv", "154,50,-10,-1,0,0,12\n");
  EXPECT_EQ(refusal(part("end.csv")),
            "end.csv:2: error: point X154 Y50 Z-10: the tool moves there along the normal or its "
            "own axis (line 18 of small.ngc), but only deviations normal to the path are learnt; "
            "omit the point");
}

TEST_F(PartLearning, RefusesAToolWithoutDiameter) {
  csv("part.csv", "50,0,-5,0,-1,0,12\n");
  EXPECT_EQ(refusal(part("part.csv"), "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\n"),
            "part.csv: error: tool 1 of small.ngc has no diameter, so the cut surface is unknown; "
            "set diameter_mm of the tool in [[program.tool]]");
}

TEST_F(PartLearning, RefusesWhatAPartDoesNotHave) {
  csv("part.csv", "50,0,-5,0,-1,0,12\n");
  EXPECT_EQ(refusal(part("part.csv", "measured = { X = \"x\" }\n")),
            "small.toml:17:1: error: case[0].strategy[0].recording[0].measured is not known");
  EXPECT_EQ(refusal(part("part.csv", "probes = [\"side\"]\n")),
            "small.toml:17:10: error: case[0].strategy[0].recording[0].probes = [\"side\"]; are "
            "those of a "
            "case: needs sees = \"part\", and case");
  EXPECT_EQ(refusal("sees = \"tip\"\n" + part("part.csv")),
            "small.toml:14:8: error: case[0].strategy[0].sees = \"tip\"; is not used with "
            "[[case.strategy.recording]]: the recordings are the runs");
  EXPECT_EQ(
      refusal(part("part.csv") + "[[case.strategy.recording]]\nfile = \"a.h5\"\ncase = "
                                 "\"one\"\n"),
      "small.toml:14:1: error: case[0].strategy[0].recording = [...]; must see the same in all "
      "recordings: scales, tip or part");
  keep("[errors.machine]\n" + flank(11), "part.h5");
  EXPECT_EQ(refusal(part("part.h5", "case = \"one\"\n")),
            "part.h5: error: has no probed part of a case one");
  EXPECT_EQ(refusal(of_case("part.h5", "probes = [\"side\"]\n")),
            "part.h5: error: case plain has no probe side; it has flank");
  keep(
      "[errors.machine]\n[[probe]]\nname = \"beyond\"\nline = { from_mm = [90.0, 0.0, -5.0], "
      "to_mm = [120.0, 0.0, -5.0], normal = [0, -1, 0], points = 4 }\n",
      "beyond.h5");
  EXPECT_EQ(refusal(of_case("beyond.h5")),
            "beyond.h5: error: point 3 of beyond was not reached by the CMM; choose other probes");
}

}  // namespace
}  // namespace servomill::sim::run::part_learning_test
