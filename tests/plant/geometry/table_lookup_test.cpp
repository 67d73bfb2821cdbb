#include "plant/geometry/table_lookup.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::table_lookup_test {
namespace {

TEST(TableLookup, HasTheValuesOfItsTable) {
  Uniform random(74);
  for (int points = 1; points < 40; ++points) {
    const LinearTable table = random_table(random, 1.0, points);
    const TableLookup lookup(table);
    const double first = table.s.front(), last = table.s.back();
    for (int n = -20; n <= 120; ++n) {
      const double at = first + (last - first + 0.01) * n / 100.0;
      ASSERT_EQ(lookup.value(at), table.value(at)) << points << " points, at " << at;
    }
    for (const double s : table.s) {
      ASSERT_EQ(lookup.value(s), table.value(s));
      ASSERT_EQ(lookup.value(std::nextafter(s, -1e9)), table.value(std::nextafter(s, -1e9)));
      ASSERT_EQ(lookup.value(std::nextafter(s, 1e9)), table.value(std::nextafter(s, 1e9)));
    }
  }
}

TEST(TableLookup, TakesPointsOfVeryDifferentSpacing) {
  const LinearTable table{{0.0, 1e-12, 2e-12, 1.0, 1.0 + 1e-9, 1e6},
                          {0.0, 1.0, -1.0, 2.0, 3.0, 4.0}};
  const TableLookup lookup(table);
  for (const double at :
       {-1.0, 0.0, 5e-13, 1e-12, 1.5e-12, 2e-12, 0.3, 1.0, 1.0 + 5e-10, 2.0, 999999.0, 1e6, 1e7}) {
    ASSERT_EQ(lookup.value(at), table.value(at)) << at;
  }
}

}  // namespace
}  // namespace servomill::plant::table_lookup_test
