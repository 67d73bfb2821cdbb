/// The feedback strategy that strategies/README.md builds step by step.
#include "tests/strategies/feedback_example.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::feedback_example_test {
namespace {

constexpr double kSlope = 0.01;  // m/m: EYX = kSlope x
constexpr double kT = 1.2e-3;    // s: twenty model periods

Acting with_time_constant(double T) {
  plant::ErrorModel errors;
  errors.component({Axis::Y, Axis::X}) = plant::polynomial({0.0, kSlope});
  auto identified = identified_with(errors);
  identified.reference.setZero();
  const Entry entry = smoothed_entry();
  Parameters parameters = default_parameters(entry);
  parameters.set("time_constant_ms", T);
  return make_acting(entry, parameters, Action::compensate, identified);
}

// A jump of x by 1 mm is one of d by 10 um: y(n) = 10 um (1 - exp(-n Tm / T)), a period later.
TEST(FeedbackExample, FollowsAJumpLikeALowPass) {
  const Acting smoothed = with_time_constant(kT);
  Joints Q = Joints::Zero();
  EXPECT_EQ(smoothed.feedback->settle(Q), Joints::Zero());
  Q[0] = 1.0 * mm;
  for (int n = 0; n <= 100; ++n) {
    const double expected = 10.0 * um * -std::expm1(-n * kModelPeriod / kT);
    EXPECT_NEAR(smoothed.feedback->advance(Q)[1], expected, 1e-12) << n;
  }
}

TEST(FeedbackExample, HasSettledWhereItStands) {
  const Acting smoothed = with_time_constant(kT);
  Joints Q = Joints::Zero();
  Q[0] = 1.0 * mm;
  const Joints d = smoothed.feedback->settle(Q);
  EXPECT_NEAR(d[1], 10.0 * um, 1e-12);
  for (int n = 0; n < 10; ++n) EXPECT_NEAR(smoothed.feedback->advance(Q)[1], d[1], 1e-18);
}

}  // namespace
}  // namespace servomill::strategies::feedback_example_test
