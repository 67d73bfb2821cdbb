#include "sim/sweep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/small_scenario.h"

namespace servomill::sim {
namespace {

using Grid = std::vector<std::vector<std::string>>;

TEST(GridOf, HasOnePointWithoutKeys) { EXPECT_EQ(grid_of(Scenario{}), Grid{{}}); }

TEST(GridOf, LetsTheLastKeyVaryFastest) {
  Scenario scenario;
  scenario.sweep = {{"a", {"1", "2"}}, {"b", {"\"x\"", "\"y\"", "\"z\""}}};
  EXPECT_EQ(grid_of(scenario), (Grid{{"1", "\"x\""},
                                     {"1", "\"y\""},
                                     {"1", "\"z\""},
                                     {"2", "\"x\""},
                                     {"2", "\"y\""},
                                     {"2", "\"z\""}}));
}

TEST(GridOf, TakesItsKeysFromTheScenario) {
  const Scenario scenario =
      small_scenario("G1 X1 F600\nM30\n",
                     "[[case]]\nname = \"one\"\n[sweep]\n\"program.feed_override\" = [0.5, 1.0]\n"
                     "\"machine.nc.Kv\" = [\"60 1/s\", \"80 1/s\"]\n");
  const Grid grid = grid_of(scenario);
  ASSERT_EQ(grid.size(), 4U);
  EXPECT_EQ(scenario.sweep[0].key, "program.feed_override");
  EXPECT_EQ(number_of(grid[0][0]), 0.5);
  EXPECT_EQ(number_of(grid[1][1]), 80.0);
}

TEST(NumberOf, ReadsTheNumberOfAValue) {
  EXPECT_EQ(number_of("1.5"), 1.5);
  EXPECT_EQ(number_of("-2e3"), -2000.0);
  EXPECT_EQ(number_of("\"60 1/s\""), 60.0);
  EXPECT_EQ(number_of("'3 mm'"), 3.0);
  EXPECT_TRUE(std::isnan(number_of("\"table\"")));
  EXPECT_TRUE(std::isnan(number_of("")));
  EXPECT_TRUE(std::isnan(number_of("\"\"")));
}

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
  series.add_row()[4] = 7.0;
  series.add_row()[0] = 1.0;
  EXPECT_EQ(series.rows(), 2U);
  EXPECT_EQ(series.at(0, 4), 7.0);
  EXPECT_EQ(series.at(1, 4), 0.0);
  EXPECT_EQ(series.row(1)[0], 1.0);
}

}  // namespace
}  // namespace servomill::sim
