#include "sim/standards/positioning_readings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/standards/positioning_report.h"
#include "tests/sim/standards/reading_file.h"

namespace servomill::sim::standards::positioning_readings_test {

const std::string kData = SERVOMILL_SOURCE_DIR "/scenarios/standards/linear_axis.csv";

std::string message(const std::string& text) { return message_of(text, read_positioning); }

// Two targets, two runs.
const std::string kGood =
    "direction,target_mm,p1,p2\n"
    "forward,0,0.001,0.002\n"
    "forward,100,100.003,100.004\n"
    "backward,0,0,0\n"
    "backward,100,100.002,100.001\n";

// The same, one reading a row.
const std::string kRows =
    "run;direction;target_mm;position_mm\n"
    "1;+;0;0,001\n1;+;100;100,003\n1;-;100;100,002\n1;-;0;0\n"
    "2;+;0;0,002\n2;+;100;100,004\n2;-;100;100,001\n2;-;0;0\n";

PositioningTest read(const std::string& text) {
  const ReadingFile file(text);
  return read_positioning(file.path()).test;
}

// Numbers of ISO 230-2 for the run of a real axis; the report that it comes from prints others.
TEST(PositioningReadings, ParametersOfARealAxis) {
  const Report report = positioning_report(read_positioning(kData), std::nullopt);
  const auto value = [&](std::string_view name) {
    for (const ReportValue& one : report.values) {
      if (one.symbol == name) return one.value / nm;
    }
    return 0.0;
  };
  constexpr double kPrinted = 0.05;  // nm, one decimal
  EXPECT_NEAR(value("B"), 12.2, kPrinted);
  EXPECT_NEAR(value("R"), 68.8, kPrinted);
  EXPECT_NEAR(value("M"), 27.7, kPrinted);
  EXPECT_NEAR(value("E"), 36.8, kPrinted);
  EXPECT_NEAR(value("A"), 88.8, kPrinted);
  EXPECT_TRUE(report.remarks.empty());
}

TEST(PositioningReadings, ColumnsOfRunsAndRowsOfReadingsAreTheSame) {
  const PositioningTest one = read(kGood), other = read(kRows);
  EXPECT_TRUE(one.targets.isApprox(other.targets));
  EXPECT_TRUE(one.up.isApprox(other.up));
  EXPECT_TRUE(one.down.isApprox(other.down));
  EXPECT_NEAR(one.up(1, 0), 3.0 * um, 1e-15);
}

// A file with a column a run is taken for the test cycle: all targets up, all down, again.
TEST(PositioningReadings, InstantsFollowTheTestCycleOrTheRows) {
  const PositioningTest one = read(kGood), other = read(kRows);
  EXPECT_DOUBLE_EQ(one.time_up(0, 0), 0.0);
  EXPECT_DOUBLE_EQ(one.time_down(1, 0), 2.0 / 7.0);
  EXPECT_DOUBLE_EQ(one.time_down(0, 1), 1.0);
  EXPECT_TRUE(one.time_up.isApprox(other.time_up));
  EXPECT_TRUE(one.time_down.isApprox(other.time_down));
}

TEST(PositioningReadings, UnitsOfEachColumn) {
  const PositioningTest test =
      read("direction,target_mm,position_um\nforward,0,1\nforward,10,10002\n");
  EXPECT_NEAR(test.up(1, 0), 2.0 * um, 1e-15);
  EXPECT_NEAR(test.targets[1], 10.0 * mm, 1e-15);
  const PositioningTest rotary =
      read("direction,target_deg,deviation_urad\nforward,0,1\nforward,10,-3\n");
  EXPECT_TRUE(rotary.angular);
  EXPECT_NEAR(rotary.up(1, 0), -3.0 * urad, 1e-15);
}

TEST(PositioningReadings, MissingReadings) {
  std::string text = kGood;
  text.replace(text.find("100.004"), 7, "");
  EXPECT_EQ(message(text),
            "readings.csv:3:21: error: run 2 is missing at this target; measure it, or remove the "
            "run at all targets");
  text = kRows;
  text.erase(text.find("2;-;100"), 16);
  EXPECT_EQ(message(text),
            "readings.csv: error: run 2 is missing at target 100 mm, backward; measure it, or "
            "remove the run at all targets");
  text = kGood;
  text.erase(text.find("backward,100"));
  EXPECT_EQ(message(text),
            "readings.csv: error: target 100 mm is not approached backward; each target needs the "
            "same directions: measure it, or remove the target");
}

TEST(PositioningReadings, TargetsTwiceAndOutOfOrder) {
  EXPECT_EQ(message(kGood + "backward,100,100.002,100.001\n"),
            "readings.csv:6:14: error: target 100 mm, backward, run 1 appears twice, first on line "
            "5; number the runs, or remove one of them");
  EXPECT_EQ(message("direction,target_mm,p1\nforward,0,0\nforward,20,20\nforward,10,10\n"),
            "readings.csv:4:12: error: target 10 mm after 20 mm (line 3), forward: targets of a "
            "run must rise; put the rows in the order of the approaches");
}

TEST(PositioningReadings, UnitsThatAreMixed) {
  EXPECT_EQ(
      message("direction,target_mm,position_mm\nforward,10,10001\nforward,20,20003\n"),
      "readings.csv:2:12: error: position_mm = 10001 at target 10 deviates by 9991 mm; must be at "
      "most 5 mm; it is 1000 times the target: if columns have different units, put each unit in "
      "its name, such as target_mm, position_um\nreadings.csv:3:12: error: position_mm = 20003 at "
      "target 20 deviates by 19983 mm; must be at most 5 mm; it is 1000 times the target: if "
      "columns have different units, put each unit in its name, such as target_mm, position_um");
  EXPECT_EQ(message("direction,target_deg,position_mm\nforward,10,10\n"),
            "readings.csv: error: column position_mm is in mm, the targets are in deg; use units "
            "of the same quantity");
}

TEST(PositioningReadings, WordsThatAreNoNumbers) {
  std::string text = kGood;
  text.replace(text.find("100.004"), 7, "off");
  EXPECT_EQ(message(text), "readings.csv:3:21: error: p2 = off; must be a number");
}

TEST(PositioningReadings, OutliersAreNamedAndCount) {
  std::string text = "direction,target_mm,p1,p2,p3,p4,p5\n";
  for (int i = 0; i < 5; ++i) {
    text += fmt::format("forward,{0},{0}.001,{0}.0012,{0}.0009,{0}.0011,{0}.{1}\n", 10 * i,
                        i == 3 ? "101" : "001");
  }
  const ReadingFile file(text);
  const PositioningFile read = read_positioning(file.path());
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_NE(read.remarks[0].find("readings.csv:5:"), std::string::npos) << read.remarks[0];
  EXPECT_NE(read.remarks[0].find("target 30 mm, forward, run 5 is 99.9 um off"), std::string::npos)
      << read.remarks[0];
  EXPECT_NEAR(read.test.up(3, 4), 101.0 * um, 1e-12);
}

// Runs that differ by a step of the display are none, nor are two runs, of which none is the other.
TEST(PositioningReadings, StepsOfTheDisplayAreNoOutliers) {
  const auto remarks = [](const std::string& text) {
    const ReadingFile file(text);
    return read_positioning(file.path()).remarks.size();
  };
  const std::string head = "direction,target_mm,p1,p2,p3\n";
  EXPECT_EQ(
      remarks(head + "+,0,0.001,0.001,0.001\n+,1,1.001,1.001,1.002\n+,2,2,2,2\n+,3,3,3.001,3\n"
                     "+,4,4,4,4\n"),
      0U);
  EXPECT_EQ(remarks(head + "+,0,0.001,0.001,0.001\n+,1,1.001,1.001,1.101\n+,2,2,2,2\n"), 1U);
  EXPECT_EQ(remarks("direction,target_mm,p1,p2\n+,0,0.001,0.101\n+,1,1,1.001\n"), 0U);
}

}  // namespace servomill::sim::standards::positioning_readings_test
