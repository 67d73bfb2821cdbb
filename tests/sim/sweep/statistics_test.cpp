/// Distribution of the quantities of a sweep.
#include "sim/sweep/statistics.h"
#include "sim/model/scenario.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace servomill::sim::sweep::statistics_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// numpy: mean, std(ddof=1), quantile([0.025, 0.975]) of the squares of 0 ... 100.
TEST(Distribution, IsThatOfNumpy) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i * i);
  const Distribution d = distribution_of(values);
  EXPECT_EQ(d.count, 101U);
  EXPECT_DOUBLE_EQ(d.mean, 3350.0);
  EXPECT_DOUBLE_EQ(d.deviation, 3027.9709873114703);
  EXPECT_DOUBLE_EQ(d.low, 6.5);
  EXPECT_DOUBLE_EQ(d.high, 9506.5);
}

TEST(Distribution, LeavesOutPointsWithoutAValue) {
  const Distribution d = distribution_of(std::vector<double>{1.0, kNaN, 3.0});
  EXPECT_EQ(d.count, 2U);
  EXPECT_EQ(d.mean, 2.0);
  EXPECT_DOUBLE_EQ(d.deviation, std::sqrt(2.0));
}

TEST(Distribution, GivesNoNumberWhereThereAreTooFew) {
  EXPECT_TRUE(std::isnan(distribution_of({}).mean));
  const Distribution one = distribution_of(std::vector<double>{1.0});
  EXPECT_EQ(one.mean, 1.0);
  EXPECT_TRUE(std::isnan(one.deviation));
  EXPECT_TRUE(std::isnan(distribution_of(std::vector<double>(kMinForInterval - 1, 1.0)).low));
  EXPECT_EQ(distribution_of(std::vector<double>(kMinForInterval, 1.0)).low, 1.0);
}

TEST(FormatStatistics, ShowsTheGridOnlyWhereThereIsOne) {
  SampledQuantity one;
  one.column.meaning.units = "um";
  one.column.attributes = {{"quantity", "lag_time"}, {"case", "table"}};
  one.distribution = {50, 1.25, 0.5, kNaN, 2.0};
  EXPECT_EQ(
      format_statistics({one}, 5),
      std::string() +
          "quantity  axis  statistic  section  case   unit  samples  mean  standard deviation  "
          "2.5 %  97.5 %\n" +
          std::string(97, '-') +
          "\nlag_time                            table  um         50  1.25                 "
          "0.5      -       2\n");
  one.grid = "a = 1";
  const std::string with_grid = format_statistics({one, one, one}, 2);
  EXPECT_TRUE(with_grid.starts_with("grid   quantity")) << with_grid;
  EXPECT_TRUE(with_grid.ends_with("and 1 more\n")) << with_grid;
}

}  // namespace
}  // namespace servomill::sim::sweep::statistics_test
