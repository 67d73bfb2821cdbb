// Records on a grid and what a control interpolates between them.
#include "controllers/tables/error_grid.h"

#include <gtest/gtest.h>

#include <array>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::error_grid_test {
namespace {

ErrorGrid empty() {
  return {.file = "v.csv", .name = "EXX", .axes = {Axis::Z, Axis::X}, .line = 1};
}

// e = z + 10 x + 100 z x, of which multilinear interpolation is exact.
double formula(double z, double x) { return z + 10 * x + 100 * z * x; }

TEST(ErrorGrid, IsTheSameWhateverTheOrderOfItsRecords) {
  std::vector<GridRecord> records;
  for (const double x : {0.3, 0.0, 0.1}) {
    for (const double z : {0.2, 0.0}) records.push_back({{z, x}, formula(z, x), 2});
  }
  const ErrorGrid grid = grid_of(empty(), records);
  EXPECT_EQ(grid.at[1], (std::vector{0.0, 0.1, 0.3}));
  for (const double z : {0.0, 0.07, 0.2}) {
    for (const double x : {0.0, 0.1, 0.22, 0.3}) {
      EXPECT_NEAR(grid.value(std::array{z, x}), formula(z, x), 1e-14);
    }
  }
  EXPECT_DOUBLE_EQ(grid.value(std::array{-1.0, 9.0}), formula(0.0, 0.3));
}

std::string fault_of(const std::vector<GridRecord>& records) {
  try {
    grid_of(empty(), records);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(ErrorGrid, NeedsOneRecordForEachCombination) {
  const double far = 100 * mm;
  EXPECT_EQ(fault_of({{{0, 0}, 1, 2}, {{0, 0.01}, 2, 3}, {{far, 0}, 3, 4}, {{far, 0.01}, 3, 5}}),
            "none");
  EXPECT_EQ(fault_of({{{0, 0}, 1, 2}, {{0, 0.01}, 2, 3}, {{far, 0}, 3, 4}}),
            "v.csv:1: error: EXX: 3 records, but their positions form a grid of 4 points; Z = 100, "
            "X = 10 is the first without a record; interpolation GRID requires one for each");
  EXPECT_EQ(fault_of({{{far, 0}, 3, 4}, {{0, 0}, 1, 2}, {{0, 0.02}, 1, 2}, {{0, 0.01}, 2, 3}}),
            "v.csv:1: error: EXX: 4 records, but their positions form a grid of 6 points; Z = 100, "
            "X = 10 is the first without a record; interpolation GRID requires one for each");
  EXPECT_EQ(fault_of({{{0, 0}, 1, 2}, {{0, 0.01}, 2, 3}, {{0, 0.01}, 2, 4}, {{far, 0}, 3, 5}}),
            "v.csv:4: error: EXX appears twice at Z = 0, X = 10");
  EXPECT_EQ(fault_of({{{0, 0}, 1, 2}, {{0, 0.01}, 2, 3}}),
            "v.csv:1: error: EXX: one position of Z; a grid requires at least two");
}

}  // namespace
}  // namespace servomill::controllers::error_grid_test
