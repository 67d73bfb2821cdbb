// Rows as columns: every number in its place, whatever the width, the number of rows and the way
// in which they come.

#include "sim/records/column_table.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace servomill::sim::records::column_table_test {
namespace {

// Rows of numbers that tell their place.
std::vector<double> counted(std::size_t first, std::size_t rows, std::size_t width) {
  std::vector<double> out;
  for (std::size_t i = first * width; i < (first + rows) * width; ++i) {
    out.push_back(static_cast<double>(i));
  }
  return out;
}

void expect_counted(const ColumnTable& table, std::size_t rows) {
  ASSERT_EQ(table.rows(), rows);
  for (std::size_t c = 0; c < table.width(); ++c) {
    ASSERT_EQ(table.column(c).size(), rows);
    for (std::size_t row = 0; row < rows; ++row) {
      ASSERT_EQ(table.column(c)[row], static_cast<double>(row * table.width() + c));
      ASSERT_EQ(table.at(row, c), table.column(c)[row]);
    }
  }
}

TEST(ColumnTable, HasTheNumbersOfItsRows) {
  for (const std::size_t width : {1u, 7u, 8u, 9u, 24u}) {
    ColumnTable table(width);
    std::size_t rows = 0;
    for (const std::size_t more : {1u, 0u, 17u, 40u, 300u}) {
      table.append(counted(rows, more, width));
      expect_counted(table, rows += more);
    }
  }
}

TEST(ColumnTable, KeepsItsRowsWhenItGrows) {
  constexpr std::size_t kWidth = 20, kMany = 10'000;
  ColumnTable table(kWidth);
  table.append(counted(0, 100, kWidth));
  table.reserve(kMany);
  const double* first = table.column(0).data();
  table.append(counted(100, kMany - 100, kWidth));
  EXPECT_EQ(table.column(0).data(), first);
  expect_counted(table, kMany);
}

TEST(ColumnTable, BeginsAnewInTheSameRoom) {
  ColumnTable table(3);
  table.append(counted(7, 50, 3));
  const double* room = table.column(0).data();
  table.clear();
  EXPECT_EQ(table.rows(), 0u);
  table.append(counted(0, 50, 3));
  EXPECT_EQ(table.column(0).data(), room);
  expect_counted(table, 50);
}

TEST(ColumnTable, IsCopiedWithWhatItHolds) {
  ColumnTable table(3);
  table.append(counted(0, 5, 3));
  const ColumnTable copy = table;
  table.clear();
  table.append(counted(90, 5, 3));
  expect_counted(copy, 5);
  table = copy;
  expect_counted(table, 5);
  table = ColumnTable(2);
  EXPECT_EQ(ColumnTable(table).rows(), 0u);
}

TEST(ColumnTable, LeavesNothingWhereItIsTakenFrom) {
  ColumnTable table(3);
  table.append(counted(0, 5, 3));
  const ColumnTable taken = std::move(table);
  expect_counted(taken, 5);
  EXPECT_EQ(table.rows(), 0u);  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace servomill::sim::records::column_table_test
