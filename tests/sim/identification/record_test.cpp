#include "sim/identification/record.h"

#include <gtest/gtest.h>

namespace servomill::sim::identification::record_test {
namespace {

TEST(Record, TheStartOfAParabolaIsExact) {
  Record record;
  record.period = 1e-3;
  for (int k = 0; k < 40; ++k) {
    const double t = 1e-3 * k;
    record.feedback.push_back(0.3 + 0.02 * t + 0.5 * t * t);
  }
  const StartOfMotion start = start_of_motion(record);
  EXPECT_NEAR(start.position, 0.3, 1e-12);
  EXPECT_NEAR(start.speed, 0.02, 1e-9);
}

TEST(Record, TimesBeginWhereTheFileDoes) {
  Record record;
  record.period = 2e-3;
  record.start = 1.5;
  EXPECT_DOUBLE_EQ(record.time(10), 1.52);
}

}  // namespace
}  // namespace servomill::sim::identification::record_test
