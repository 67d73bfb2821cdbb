#include "plant/geometry/travelling_errors.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"

namespace servomill::plant::travelling_errors_test {
namespace {

// Half of the width above and below the mean, for all errors of the axis and for no others.
TEST(TravellingErrors, AreThoseOfOneDirectionOfOneAxis) {
  ErrorModel errors;
  errors.component("EXX"_err) = polynomial({5.0 * um}) + reversal({4.0 * um}, 0.1 * mm);
  errors.component("EYX"_err) = reversal({2.0 * um}, 0.1 * mm);
  errors.component("EYY"_err) = reversal({6.0 * um}, 0.1 * mm);
  errors.location("EC0Y"_err) = 20.0 * urad;
  for (const double direction : {1.0, 0.0, -1.0}) {
    const ErrorModel one = travelling(errors, Axis::X, direction);
    EXPECT_DOUBLE_EQ(one.component("EXX"_err).value(0.1), (5.0 + 2.0 * direction) * um);
    EXPECT_DOUBLE_EQ(one.component("EYX"_err).value(0.1), 1.0 * direction * um);
    EXPECT_TRUE(one.component("EXX"_err).reversals.empty());
    EXPECT_EQ(one.component("EYY"_err), errors.component("EYY"_err));
    EXPECT_EQ(one.locations, errors.locations);
  }
}

}  // namespace
}  // namespace servomill::plant::travelling_errors_test
