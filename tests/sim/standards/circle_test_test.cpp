#include "sim/standards/circle_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "tests/sim/standards/reading_file.h"

namespace servomill::sim::standards::circle_test_test {

constexpr double kRadius = 100.0 * mm;
constexpr double kSecondOrder = 1e-9;  // m: squares of 10 um over 100 mm

// Rows of a ball bar, both directions, a reading a degree, none at a reversal itself; dr in m of
// angle and direction.
std::string ball_bar(const std::function<double(double, int)>& dr) {
  std::string text = "direction,angle_deg,deviation_um\n";
  for (const int direction : {1, -1}) {
    for (int k = 0; k < 360; ++k) {
      const double degrees = direction * (k + 0.5);
      text += fmt::format("{},{},{:.9f}\n", direction > 0 ? "ccw" : "cw", degrees,
                          dr(degrees * deg, direction) / um);
    }
  }
  return text;
}

Report report_of(const std::string& text) {
  const ReadingFile file(text);
  return circle_report(read_circle(file.path(), kRadius));
}

double value(const Report& report, std::string_view symbol) {
  for (const ReportValue& one : report.values) {
    if (one.symbol == symbol) return one.value;
  }
  ADD_FAILURE() << symbol;
  return 0.0;
}

// A squareness gamma (positive axes closer than 90 degrees) gives dr = gamma R / 2 sin 2 theta;
// scales s_1, s_2 give R (s_1 cos^2 + s_2 sin^2).
TEST(CircleTest, SquarenessAndScalesOfABallBar) {
  constexpr double kSquareness = 80e-6, kScale1 = 60e-6, kScale2 = 20e-6;
  const Report report = report_of(ball_bar([](double theta, int) {
    return kRadius *
           (0.5 * kSquareness * std::sin(2.0 * theta) + kScale1 * std::pow(std::cos(theta), 2) +
            kScale2 * std::pow(std::sin(theta), 2));
  }));
  EXPECT_NEAR(value(report, "squareness"), kSquareness, 1e-9);
  EXPECT_NEAR(value(report, "scale_mismatch"), kScale1 - kScale2, 1e-9);
  EXPECT_NEAR(value(report, "D"), -0.5 * kRadius * (kScale1 + kScale2), kSecondOrder);
  // an ellipse: range of its second harmonic
  const double a = kRadius * std::hypot(0.5 * kSquareness, 0.5 * (kScale1 - kScale2));
  EXPECT_NEAR(value(report, "G_ccw"), 2.0 * a, 2e-8);  // extremes lie between the degrees
  EXPECT_NEAR(value(report, "G_b"), 2.0 * a, 2e-8);
  EXPECT_TRUE(report.remarks.empty());
}

// A centre that is off the set-up changes F about the set-up, not what is about the circle.
TEST(CircleTest, SetUpShiftsTheCentreOnly) {
  constexpr double kOff = 8.0 * um;
  const Report report =
      report_of(ball_bar([](double theta, int) { return kOff * std::cos(theta); }));
  EXPECT_NEAR(value(report, "F_max_set_up_ccw"), kOff, kSecondOrder);
  EXPECT_NEAR(value(report, "F_min_set_up_ccw"), -kOff, kSecondOrder);
  EXPECT_NEAR(value(report, "F_max_ccw"), 0.0, kSecondOrder);
  EXPECT_NEAR(value(report, "G_cw"), 0.0, kSecondOrder);
}

// Lost motion b of the first axis: the point lags in x by b after each reversal at 0 and 180 deg.
TEST(CircleTest, ReversalOfTheFirstAxis) {
  constexpr double kBacklash = 6.0 * um;
  const Report report = report_of(ball_bar([](double theta, int direction) {
    const double travel = -direction * std::sin(theta);  // in x
    const double sense = travel > 1e-9 ? 1.0 : travel < -1e-9 ? -1.0 : 0.0;
    return -0.5 * kBacklash * sense * std::cos(theta);
  }));
  const ReportTable& table = report.tables.front();
  ASSERT_EQ(table.columns.size(), 4U);
  for (const std::size_t column : {0U, 2U}) {
    EXPECT_NEAR(table.columns[column].values[0], kBacklash, 0.1 * kBacklash);
    EXPECT_NEAR(table.columns[column].values[2], kBacklash, 0.1 * kBacklash);
    EXPECT_NEAR(table.columns[column].values[1], 0.0, 0.1 * kBacklash);
  }
  EXPECT_NEAR(value(report, "B_1"), -kBacklash, 1e-3 * kBacklash);
  EXPECT_NEAR(value(report, "B_2"), 0.0, 1e-3 * kBacklash);
  EXPECT_NEAR(value(report, "squareness"), 0.0, 1e-3 * kBacklash / kRadius);
}

TEST(CircleTest, GridEncoderAndBallBarAreTheSame) {
  const auto dr = [](double theta) { return 5.0 * um * std::cos(3.0 * theta); };
  std::string grid = "direction,x_mm,y_mm\n";
  for (int k = 0; k < 360; ++k) {
    const double angle = (k + 0.5) * deg;
    const double r = kRadius + dr(angle);
    grid += fmt::format("ccw,{:.9f},{:.9f}\n", r * std::cos(angle) / mm, r * std::sin(angle) / mm);
  }
  const Report one = report_of(grid);
  const Report other = report_of(ball_bar([&](double theta, int) { return dr(theta); }));
  EXPECT_NEAR(value(one, "G_ccw"), value(other, "G_ccw"), 1e-11);
  EXPECT_NEAR(value(one, "G_ccw"), 10.0 * um * std::cos(1.5 * deg),
              kSecondOrder);  // half a degree off
  EXPECT_TRUE(std::isnan(value(one, "G_b")));
  ASSERT_EQ(one.remarks.size(), 1U);
}

TEST(CircleTest, WrongTurns) {
  const auto message = [](const std::string& text) {
    return message_of(text, [](const std::string& path) { return read_circle(path, kRadius); });
  };
  std::string arc = "direction,angle_deg,deviation_um\n";
  std::string wrong_way = arc;
  for (int k = 0; k < 360; ++k) {
    if (k < 200) arc += fmt::format("ccw,{},0\n", k);
    wrong_way += fmt::format("cw,{},0\n", k);
  }
  EXPECT_EQ(
      message(arc),
      "readings.csv: error: the ccw circle covers 199 deg of the circle; must be a full circle, "
      "360 deg; remove the feed-in and feed-out arcs, and check the radius and its unit");
  EXPECT_EQ(message(wrong_way),
            "readings.csv: error: the cw circle runs in the opposite direction; put its rows in "
            "the order of the motion, or correct the direction");
  EXPECT_EQ(message("direction,angle_deg,deviation_um\nccw,0,100003\nleft,1,0\n"),
            "readings.csv:2:7: error: deviation of 100.003 mm; must be at most 5 mm: check the "
            "unit, and that it is a deviation from the nominal radius\n"
            "readings.csv:3:1: error: direction = left; must be ccw or cw");
  EXPECT_EQ(message("direction,a\nccw,0\n"),
            "readings.csv: error: has no circle: columns angle_deg and deviation_um of a ball bar, "
            "or x_mm and y_mm of a grid encoder, are missing");
}

TEST(CircleTest, GroupsOfReadingsAreOneTestARun) {
  const auto chain = plant::make_chain(plant::parse_structure("[w b X Y Z (C1) t]"));
  readings::Group group;
  group.name = "bar";
  group.kind = readings::Kind::circle;
  group.radius = kRadius;
  group.at = Joints::Constant(0.3);
  for (int run = 0; run < 2; ++run) {
    for (const int direction : {1, -1}) {
      for (int k = 0; k < 120; ++k) {
        const double theta = direction * 3.0 * k * deg;
        readings::Reading one;
        one.Q = group.at;
        one.Q[0] += kRadius * std::cos(theta);
        one.Q[1] += kRadius * std::sin(theta);
        one.direction[0] = -direction * (std::sin(theta) > 1e-9    ? 1
                                         : std::sin(theta) < -1e-9 ? -1
                                                                   : 0);
        one.direction[1] = direction * (std::cos(theta) > 1e-9    ? 1
                                        : std::cos(theta) < -1e-9 ? -1
                                                                  : 0);
        one.deviation[0] = (run + 1) * 4.0 * um * std::cos(2.0 * theta);
        one.run = run;
        group.rows.push_back(one);
      }
    }
  }
  const auto tests = circles_of(group, chain.layout);
  ASSERT_EQ(tests.size(), 2U);
  EXPECT_EQ(tests[1].name, "bar, run 2");
  EXPECT_NEAR(value(circle_report(tests[1]), "G_cw"), 16.0 * um, 1e-8);
  EXPECT_NEAR(fit_circle(tests[0]).scale_mismatch, 8.0 * um / kRadius, 1e-9);
}

// The row of 37.5 deg is off by 20 um; a reversal steps by 20 um, an ellipse has 200 um.
TEST(CircleTest, NamesAPointOffItsNeighbours) {
  const auto radial = [](double theta, int direction) {
    const double step = direction * std::cos(theta) > 0.0 ? 20.0 * um : 0.0;
    const double outlier = direction > 0 && std::abs(theta - 37.5 * deg) < 1e-6 ? 20.0 * um : 0.0;
    return 100.0 * um * std::sin(2.0 * theta) + step + outlier;
  };
  const Report report = report_of(ball_bar(radial));
  ASSERT_EQ(report.remarks.size(), 1u);
  EXPECT_TRUE(
      report.remarks[0].ends_with(":39: is 20 um off its neighbours on the circle ccw; it is "
                                  "evaluated: check it at the machine"))
      << report.remarks[0];
}

TEST(CircleTest, NamesACopiedRow) {
  std::string text = ball_bar([](double theta, int) { return 1.0 * um * std::sin(theta); });
  const std::size_t row = text.find("ccw,10.5,"), end = text.find('\n', row) + 1;
  text.insert(end, text.substr(row, end - row));
  const Report report = report_of(text);
  ASSERT_EQ(report.remarks.size(), 1u);
  EXPECT_TRUE(report.remarks[0].ends_with(
      ":13: equals line 12 on the circle ccw; it is used: remove copied rows"))
      << report.remarks[0];
}

}  // namespace servomill::sim::standards::circle_test_test
