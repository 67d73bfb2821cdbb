// Rows as columns: every number in its place, whatever the width and the number of rows.

#include "sim/records/gathered_columns.h"

#include <gtest/gtest.h>

#include <vector>

namespace servomill::sim::records::gathered_columns_test {
namespace {

TEST(GatheredColumns, HaveTheNumbersOfTheirRows) {
  for (const std::size_t width : {1u, 7u, 8u, 9u, 24u}) {
    GatheredColumns gathered(width);
    for (const std::size_t rows : {40u, 1u, 0u, 17u}) {  // one after the other in the same room
      std::vector<double> numbers(width * rows);
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
      gathered.begin(numbers);
      for (std::size_t group = 0; group < gathered.groups(); ++group) gathered.gather(group);
      for (std::size_t c = 0; c < width; ++c) {
        ASSERT_EQ(gathered.column(c).size(), rows);
        for (std::size_t row = 0; row < rows; ++row) {
          ASSERT_EQ(gathered.column(c)[row], static_cast<double>(row * width + c));
        }
      }
    }
  }
}

}  // namespace
}  // namespace servomill::sim::records::gathered_columns_test
