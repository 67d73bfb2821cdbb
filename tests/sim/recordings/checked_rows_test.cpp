#include "sim/recordings/checked_rows.h"

#include <gtest/gtest.h>

#include "tests/text.h"

namespace servomill::sim::recordings::checked_rows_test {
namespace {

TEST(CheckedRows, DecimalSignIsAPointUnlessOnlyTheCommaFits) {
  EXPECT_EQ(decimal_of("1.5"), '.');
  EXPECT_EQ(decimal_of("1,5"), ',');
  EXPECT_EQ(decimal_of("15"), '.');
  EXPECT_EQ(decimal_of("on"), '.');
}

TEST(CheckedRows, EqualTimesAreOneBase) {
  Recording recording;
  Base base;
  append_time(base, 0.0, {"a", 1});
  append_time(base, 0.5, {"a", 2});
  EXPECT_EQ(shared_base(recording, base), 0u);
  EXPECT_EQ(shared_base(recording, base), 0u);
  append_time(base, 1.0, {"a", 3});
  EXPECT_EQ(shared_base(recording, base), 1u);
  EXPECT_EQ(recording.bases[1].name, "time 2");
  EXPECT_EQ(fault_messages([&] { append_time(base, 1.0, {"a", 4}); }), "time 1 s appears twice\n");
}

}  // namespace
}  // namespace servomill::sim::recordings::checked_rows_test
