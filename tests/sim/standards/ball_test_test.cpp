#include "sim/standards/ball_test.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/standards/diagonal_report.h"
#include "tests/sim/standards/reading_file.h"

namespace servomill::sim::standards::ball_test_test {

constexpr double kRounding = 1e-15;  // m

double value(const Report& report, std::string_view symbol) {
  for (const ReportValue& one : report.values) {
    if (one.symbol == symbol) return one.value;
  }
  ADD_FAILURE() << symbol;
  return 0.0;
}

TEST(BallTest, RangesOfTheSensorsByDirectionAndOfBoth) {
  const ReadingFile file(
      "direction,C_deg,radial_um,axial_um\n"
      "ccw,0,1,0\nccw,90,4,2\nccw,180,-2,1\n"
      "cw,180,3,1\ncw,90,5,1\ncw,0,2,1\n");
  const Report report = ball_report(read_ball(file.path()));
  EXPECT_NEAR(value(report, "radial_forward"), 6.0 * um, kRounding);
  EXPECT_NEAR(value(report, "radial_backward"), 3.0 * um, kRounding);
  EXPECT_NEAR(value(report, "radial"), 7.0 * um, kRounding);
  EXPECT_NEAR(value(report, "axial_backward"), 0.0, kRounding);
  EXPECT_NEAR(value(report, "axial"), 2.0 * um, kRounding);
  EXPECT_TRUE(report.remarks.empty());
}

TEST(BallTest, TablesOfItsPathsAreThoseOfTheFile) {
  const ReadingFile over_angle("direction,C_deg,dx_um\nccw,0,1\nccw,90,4\ncw,90,5\ncw,0,2\n");
  const Report report = ball_report(read_ball(over_angle.path()));
  ASSERT_EQ(report.tables.size(), 2u);
  EXPECT_EQ(report.tables[1].name, "curve backward");
  ASSERT_EQ(report.tables[1].columns.size(), 2u);
  EXPECT_EQ(report.tables[1].columns[0].name, "angle");
  EXPECT_NEAR(report.tables[1].columns[0].values[0], 90.0 * deg, 1e-12);
  EXPECT_NEAR(report.tables[1].columns[1].values[0], 5.0 * um, kRounding);
  const ReadingFile in_order("dx_um\n3\n4\n");
  const ReportTable table = ball_report(read_ball(in_order.path())).tables.at(0);
  EXPECT_EQ(table.name, "curve all");
  EXPECT_EQ(table.columns[0].name, "reading");
  EXPECT_EQ(table.columns[0].values, (std::vector<double>{1.0, 2.0}));
}

TEST(BallTest, WrongFiles) {
  EXPECT_EQ(message_of("C_deg,radial\n0,1\n", read_ball),
            "readings.csv: error: column radial must name its unit, such as radial_um");
  EXPECT_EQ(message_of("C_deg,radial_mm\n0,12\n", read_ball),
            "readings.csv:2:3: error: radial_mm = 12; must be at most 5 mm: check the unit");
  EXPECT_EQ(message_of("direction,radial_um\nleft,12\n", read_ball),
            "readings.csv:2:1: error: direction = left; must be forward or backward (ccw, cw)");
}

// The largest of all diagonals, each evaluated as an axis.
TEST(DiagonalReport, LargestOfTheDiagonals) {
  std::vector<PositioningFile> files;
  for (int k = 1; k <= 4; ++k) {
    PositioningTest test;
    test.targets = Eigen::ArrayXd::LinSpaced(6, 0.0, 0.5);
    test.up = (k * 1e-5 * test.targets).replicate(1, 5);
    test.down = test.up - (5 - k) * um;
    files.push_back({test, "diagonal " + std::to_string(k), {}});
  }
  const Report report = diagonal_report(files);
  EXPECT_NEAR(value(report, "E_d"), 21.0 * um, kRounding);  // the fourth: 20 um and 1 um of B
  EXPECT_NEAR(value(report, "B_d"), 4.0 * um, kRounding);
  EXPECT_NEAR(value(report, "A_d"), 21.0 * um, kRounding);
  EXPECT_NEAR(value(report, "R_d"), 4.0 * um, kRounding);
  EXPECT_EQ(report.tables.front().rows.size(), 4U);
  EXPECT_TRUE(report.remarks.empty());
  files.pop_back();
  EXPECT_EQ(diagonal_report(files).remarks.size(), 1U);
}

}  // namespace servomill::sim::standards::ball_test_test
