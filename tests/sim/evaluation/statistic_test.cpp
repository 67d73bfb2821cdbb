#include "sim/evaluation/statistic.h"

#include <gtest/gtest.h>

#include <limits>

#include "sim/evaluation/row_ranges.h"

namespace servomill::sim::evaluation::statistic_test {
namespace {

double of(std::string_view name, const std::vector<double>& values) {
  Statistic statistic(name);
  for (const double v : values) statistic.add(v);
  return statistic.value();
}

TEST(Statistic, IsThatOfItsValues) {
  const std::vector<double> values = {1.0, -4.0, 2.0, -3.0};
  EXPECT_EQ(of("max", values), 4.0);  // by magnitude
  EXPECT_EQ(of("range", values), 6.0);
  EXPECT_EQ(of("mean", values), -1.0);
  EXPECT_EQ(of("rms", values), std::sqrt(30.0 / 4.0));
}

TEST(Statistic, IsNoneWithoutValuesOrIfOneIsNone) {
  for (const char* name : {"max", "range", "mean", "rms"}) {
    EXPECT_TRUE(std::isnan(of(name, {}))) << name;
    EXPECT_TRUE(std::isnan(of(name, {1.0, std::numeric_limits<double>::quiet_NaN()}))) << name;
  }
}

TEST(Statistic, IsThatOfAllValuesOfWhichSomeAreReported) {
  for (const auto& [name, wanted] :
       {std::pair{"max", 4.0}, {"range", 7.0}, {"mean", 0.0}, {"rms", std::sqrt(39.0 / 6.0)}}) {
    Statistic statistic(name);
    statistic.add(-4.0, 2.0, -1.0, std::sqrt(30.0 / 4.0), 4.0);  // 1, -4, 2, -3
    statistic.add(3.0);
    statistic.add(0.0);
    EXPECT_DOUBLE_EQ(statistic.value(), name == std::string_view("mean") ? -1.0 / 6.0 : wanted);
  }
}

TEST(RowRanges, GivesItsRowsInOrder) {
  RowRanges rows;
  const std::vector<std::size_t> wanted = {3, 4, 5, 9, 11, 12};
  for (const std::size_t row : wanted) rows.add(row);
  std::vector<std::size_t> found;
  rows.for_each([&](std::size_t row) { found.push_back(row); });
  EXPECT_EQ(found, wanted);
  EXPECT_EQ(rows.size(), wanted.size());
}

}  // namespace
}  // namespace servomill::sim::evaluation::statistic_test
