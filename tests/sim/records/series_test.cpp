#include "sim/records/series.h"

#include <gtest/gtest.h>

#include <optional>

namespace servomill::sim::records::series_test {
namespace {

TEST(Series, KeepsItsSignalsInTheirOrder) {
  Series series(
      {{"time", "s", "", "", ""}, {"p", "mm", "", "XYZ", "xyz"}, {"e", "um", "", "", ""}});
  EXPECT_EQ(series.width(), 5U);
  EXPECT_EQ(series.rows(), 0U);
  EXPECT_EQ(series.column("time"), 0U);
  EXPECT_EQ(series.column("p", 'X'), 1U);
  EXPECT_EQ(series.column("p", 'Z'), 3U);
  EXPECT_EQ(series.column("e"), 4U);
  EXPECT_EQ(series.column("p", 'A'), std::nullopt);
  EXPECT_EQ(series.column("q"), std::nullopt);
  EXPECT_EQ(series.find("q"), nullptr);
  series.append(std::vector{0.0, 0.0, 0.0, 0.0, 7.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(series.rows(), 2U);
  EXPECT_EQ(series.at(0, 4), 7.0);
  EXPECT_EQ(series.at(1, 4), 0.0);
  EXPECT_EQ(series.at(1, 0), 1.0);
  EXPECT_EQ(series.by_rows(), (std::vector<double>{0, 0, 0, 0, 7, 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace servomill::sim::records::series_test
