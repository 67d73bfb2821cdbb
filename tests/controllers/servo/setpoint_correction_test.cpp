#include "controllers/servo/setpoint_correction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace servomill::controllers::setpoint_correction_test {
namespace {

constexpr double kTp = 0.2e-3;
const Joints kOne{1.0, -2.0, 0.5, -0.3, 0.7};

TEST(SetpointCorrection, PassesValuesOnAtOnceByDefault) {
  SetpointCorrection correction({}, kTp);
  EXPECT_EQ(correction.advance(kOne), kOne);
}

TEST(SetpointCorrection, RespondsLikeAFirstOrderLag) {
  SetpointEntry entry;
  entry.time_constant = 40e-3;
  SetpointCorrection correction(entry, kTp);
  Joints out;
  for (int k = 0; k < 200; ++k) out = correction.advance(kOne);  // one time constant
  EXPECT_NEAR(out.x(), 1.0 - std::exp(-1.0), 1e-12);
}

TEST(SetpointCorrection, LagsARampByResponseTimeAndDeadTime) {
  SetpointEntry entry;
  entry.time_constant = 40e-3;
  entry.dead_time = 10e-3;
  SetpointCorrection correction(entry, kTp);
  Joints out;
  for (int k = 0; k < 10000; ++k) out = correction.advance(kOne * (k * kTp));
  const double lag = (10000 - 1) * kTp - out.x();
  EXPECT_NEAR(lag, 40e-3 + 10e-3, kTp);  // the discrete lag is T - Tp / 2 + O(Tp^2)
}

TEST(SetpointCorrection, AsksForAValueOnceAnUpdatePeriod) {
  SetpointEntry entry;
  entry.update_period = 3e-3;
  SetpointCorrection correction(entry, kTp);
  int wanted = 0;
  for (int k = 0; k < 150; ++k) {
    wanted += correction.wants_value();
    correction.advance(kOne);
  }
  EXPECT_EQ(wanted, 10);
}

TEST(SetpointCorrection, StaysWhereItWasSettled) {
  SetpointEntry entry;
  entry.time_constant = 40e-3;
  entry.dead_time = 10e-3;
  SetpointCorrection correction(entry, kTp);
  correction.settle(kOne);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(correction.advance(kOne), kOne);
}

}  // namespace
}  // namespace servomill::controllers::setpoint_correction_test
