#include "sim/evaluation/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/evaluation/quantity.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation::comparison_test {
namespace {

constexpr double kTol = 1e-9;  // um, %, ms: rounding of values of 100 that are stored in mm

struct Row {
  double time, s, section, rapid, y, imposed, following, deviation, contour;
};

records::Series series_of(const std::vector<Row>& rows) {
  records::Series out({{"time", "s", "", "", ""},
                       {"s", "mm", "", "", ""},
                       {"section", "1", "", "", ""},
                       {"rapid", "1", "", "", ""},
                       {"meas_linear", "mm", "", "XYZ", "axis_linear"},
                       {"imposed_linear", "um", "", "XYZ", "axis_linear"},
                       {"following_error_linear", "um", "", "XYZ", "axis_linear"},
                       {"tool_deviation", "um", "", "XYZ", "xyz"},
                       {"contour_error", "um", "", "", ""}});
  for (const Row& row : rows) {
    std::vector<double> to(out.width());
    const auto put = [&](const char* name, char label, double value) {
      to[out.column(name, label).value()] = value;
    };
    put("time", '\0', row.time);
    put("s", '\0', row.s);
    put("section", '\0', row.section);
    put("rapid", '\0', row.rapid);
    put("meas_linear", 'Y', row.y);
    put("imposed_linear", 'Y', row.imposed);
    put("following_error_linear", 'Y', row.following);
    put("tool_deviation", 'Y', row.deviation);
    put("contour_error", '\0', row.contour);
    out.append(to);
  }
  return out;
}

// The base runs along Y = 2 s and is sampled every millimetre. The case is sampled between, brings
// out an imposed ramp of 10 um/mm but for 3 um, at 1 mm per millisecond; a rapid with absurd values
// follows. Sections: "" up to 5 mm, "end" from there on.
class Comparison : public testing::Test {
 protected:
  Comparison() {
    std::vector<Row> rows;
    for (int i = 0; i <= 11; ++i) rows.push_back({0.002 * i, 1.0 * i, 0, 0, 2.0 * i, 0, 0, 0, 0});
    base_ = series_of(rows);
    rows.clear();
    for (int i = 0; i < 10; ++i) {
      const double s = i + 0.5, section = s > 5.0 ? 1 : 0;
      rows.push_back({0.001 * i, s, section, 0, 2.0 * s + (10.0 * s - 3.0) * 1e-3, 10.0 * s,
                      i % 2 == 0 ? 4.0 : -2.0, -7.0 + i, 0.1 * i});
    }
    rows.push_back({0.010, 10.5, 1, 1, 1e6, 105.0, 1e6, 1e6, 1e6});
    one_ = series_of(rows);
    cases_ = {{"one", &one_, {"", "end"}, 12.5, 34.0, true},
              {"base", &base_, {"", "end"}, 11.0, 3.0, true}};
  }

  double value(const std::string& name, const std::string& statistic,
               const std::vector<std::string>& sections = {}, const std::string& of = "one") {
    model::QuantitySpec spec;
    spec.name = name;
    spec.axis = quantity_entry(name).needs_axis() ? 'Y' : '\0';
    spec.statistic = statistic;
    spec.cases = {of};
    if (quantity_entry(name).needs_baseline) spec.baseline = "base";
    spec.sections = sections;
    const auto rows = compare(std::vector<model::QuantitySpec>{spec}, cases_);
    EXPECT_EQ(rows.size(), 1U);
    return rows.front().value;
  }

  records::Series base_, one_;
  std::vector<CaseData> cases_;
};

TEST_F(Comparison, TrajectoryDifferenceIsTakenAtEqualArcLength) {  // 10 s - 3, s = 0.5 ... 9.5
  EXPECT_NEAR(value("trajectory_difference", "max"), 92.0, kTol);
  EXPECT_NEAR(value("trajectory_difference", "mean"), 47.0, kTol);
  EXPECT_NEAR(value("trajectory_difference", "range"), 90.0, kTol);
  // variance of ten points 10 apart: 100 (10^2 - 1) / 12
  EXPECT_NEAR(value("trajectory_difference", "rms"), std::sqrt(47.0 * 47.0 + 825.0), kTol);
}

TEST_F(Comparison, ImposedCurveResidualIsWhatIsMissing) {
  EXPECT_NEAR(value("imposed_error_residual", "max"), 3.0, kTol);
  EXPECT_NEAR(value("imposed_error_residual", "mean"), -3.0, kTol);
  EXPECT_NEAR(value("imposed_error_residual", "rms"), 3.0, kTol);
  EXPECT_NEAR(value("imposed_error_residual", "range"), 0.0, kTol);
  EXPECT_NEAR(value("realised_ratio", ""), 100.0 * (1.0 - 3.0 / 95.0), kTol);
}

// 3 um at 10 um/mm and 1 mm/ms are 0.3 ms.
TEST_F(Comparison, ResponseTimeIsResidualOverRate) {
  EXPECT_NEAR(value("lag_time", ""), 0.3, kTol);
}

TEST_F(Comparison, OtherQuantitiesAreThoseOfTheCaseItself) {
  EXPECT_NEAR(value("following_error", "max"), 4.0, kTol);
  EXPECT_NEAR(value("following_error", "mean"), 1.0, kTol);
  EXPECT_NEAR(value("following_error", "rms"), std::sqrt(10.0), kTol);
  EXPECT_NEAR(value("following_error", "range"), 6.0, kTol);
  EXPECT_NEAR(value("tool_deviation", "max"), 7.0, kTol);  // by magnitude: -7 ... 2
  EXPECT_NEAR(value("tool_deviation", "range"), 9.0, kTol);
  EXPECT_NEAR(value("contour_error", "max"), 0.9, kTol);
  EXPECT_EQ(value("cycle_time", ""), 12.5);
  EXPECT_EQ(value("blocks", ""), 34.0);
}

TEST_F(Comparison, LooksAtTheSectionsAskedFor) {
  EXPECT_NEAR(value("trajectory_difference", "mean", {"end"}), 72.0, kTol);  // s = 5.5 ... 9.5
  EXPECT_NEAR(value("trajectory_difference", "mean", {""}), 22.0, kTol);
  EXPECT_NEAR(value("trajectory_difference", "mean", {"", "end"}), 47.0, kTol);
  EXPECT_TRUE(std::isnan(value("trajectory_difference", "mean", {"no such"})));
}

TEST_F(Comparison, HasNoValueWhereACaseStoppedOrIsMissing) {
  EXPECT_TRUE(std::isnan(value("following_error", "max", {}, "no such")));
  cases_[0].finished = false;
  EXPECT_TRUE(std::isnan(value("following_error", "max")));
  EXPECT_TRUE(std::isnan(value("imposed_error_residual", "max")));
  EXPECT_EQ(value("cycle_time", ""), 12.5) << "the program has a duration, whoever runs it";
  cases_[0].finished = true;
  cases_[1].finished = false;
  EXPECT_FALSE(std::isnan(value("following_error", "max")));
  EXPECT_TRUE(std::isnan(value("trajectory_difference", "max")));
  cases_.pop_back();
  EXPECT_TRUE(std::isnan(value("trajectory_difference", "max")));
  EXPECT_FALSE(std::isnan(value("following_error", "max")));
}

// A signal that is no number must not look like a small one, wherever in the series it stands.
TEST_F(Comparison, DoesNotSwallowWhatIsNoNumber) {
  for (const std::size_t at : {0U, 4U, 9U}) {
    std::vector<Row> rows;
    for (int i = 0; i < 10; ++i) rows.push_back({0.001 * i, 1.0 * i, 0, 0, 0, 0, 1.0, 0, 0});
    rows[at].following = std::numeric_limits<double>::quiet_NaN();
    one_ = series_of(rows);
    for (const char* statistic : {"max", "mean", "rms", "range"}) {
      EXPECT_TRUE(std::isnan(value("following_error", statistic))) << statistic << " " << at;
    }
  }
}

std::vector<ComparisonRow> some_rows() {
  ComparisonRow table{
      "table", "imposed_error_residual", "Y", "max", "um", "20 um", "fitted", "flank", 19.8765};
  ComparisonRow gcode = table;
  gcode.case_name = "gcode";
  gcode.reference = "2 um";
  gcode.basis = "upper_bound";
  gcode.value = 0.07777;
  ComparisonRow stopped = table;
  stopped.case_name = "stopped";
  stopped.reference = stopped.basis = "";
  stopped.value = std::numeric_limits<double>::quiet_NaN();
  ComparisonRow blocks{"table", "blocks", "", "", "1", "", "", "", 123.0};
  return {table, gcode, stopped, blocks};
}

TEST(FormatTable, SaysEachGroupOnce) {
  EXPECT_EQ(
      format_table(some_rows()),
      "quantity                axis  statistic  section  case         value  reference  basis\n"
      "--------------------------------------------------------------------------------------\n"
      "imposed_error_residual  Y     max        flank    table     19.88 um  20 um      fitted\n"
      "                                                  gcode    0.0778 um  2 um       "
      "upper_bound\n"
      "                                                  stopped       - um\n"
      "blocks                                            table       123.0\n");
}

TEST(ToJson, IsOneObjectWithNullForWhatThereIsNot) {
  const auto rows = some_rows();
  EXPECT_EQ(to_json(rows[0]),
            R"({"case": "table", "quantity": "imposed_error_residual", "axis": "Y", )"
            R"("statistic": "max", "sections": "flank", "value": 19.8765, "unit": "um", )"
            R"("reference": "20 um", "basis": "fitted"})");
  EXPECT_EQ(to_json(rows[2]),
            R"({"case": "stopped", "quantity": "imposed_error_residual", "axis": "Y", )"
            R"("statistic": "max", "sections": "flank", "value": null, "unit": "um", )"
            R"("reference": null, "basis": null})");
  ComparisonRow quoted = rows[3];
  quoted.case_name = "a \"b\"\\\n";
  EXPECT_EQ(to_json(quoted),
            R"({"case": "a \"b\"\\\u000a", "quantity": "blocks", "axis": null, "statistic": null, )"
            R"("sections": null, "value": 123, "unit": "1", "reference": null, "basis": null})");
}

}  // namespace
}  // namespace servomill::sim::evaluation::comparison_test
