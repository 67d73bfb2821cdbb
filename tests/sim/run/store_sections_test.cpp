#include "sim/run/store_sections.h"

#include <gtest/gtest.h>

#include "sim/records/series.h"

namespace servomill::sim::run::store_sections_test {
namespace {

struct Row {
  double time, s, section, window;
};

records::Series series_of(const std::vector<Row>& rows, bool has_windows) {
  std::vector<records::Signal> signals = {
      {"time", "s", "time", "", ""}, {"s", "mm", "s", "", ""}, {"section", "1", "section", "", ""}};
  if (has_windows) signals.push_back({"window", "1", "window", "", ""});
  records::Series series(signals);
  for (const Row& row : rows) {
    std::vector<double> values = {row.time, row.s, row.section};
    if (has_windows) values.push_back(row.window);
    series.append(values);
  }
  return series;
}

TEST(PassesOfSections, OfARepeatedSectionAreSeveral) {
  const auto passes = passes_of(
      series_of({{0, 0, 0, 0}, {1, 5, 1, 0}, {2, 9, 1, 0}, {3, 9, 0, 0}, {4, 12, 1, 0}}, false));
  ASSERT_EQ(passes.size(), 4u);
  EXPECT_EQ(passes[1].section, 1);
  EXPECT_EQ(passes[1].begin, 1.0);
  EXPECT_EQ(passes[1].end, 2.0);
  EXPECT_EQ(passes[1].begin_at, 5.0);
  EXPECT_EQ(passes[1].end_at, 9.0);
  EXPECT_EQ(passes[3].begin, passes[3].end);
}

TEST(PassesOfSections, EndWhereWindowsLeftRowsOut) {
  const std::vector<Row> rows = {{0, 0, 1, 1}, {1, 5, 1, 1}, {7, 9, 1, 2}};
  EXPECT_EQ(passes_of(series_of(rows, false)).size(), 1u);
  const auto passes = passes_of(series_of(rows, true));
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(passes[0].end, 1.0);
  EXPECT_EQ(passes[1].begin, 7.0);
}

TEST(PassesOfSections, OfNoRowsAreNone) { EXPECT_TRUE(passes_of(series_of({}, false)).empty()); }

}  // namespace
}  // namespace servomill::sim::run::store_sections_test
