/// The strategy that strategies/README.md builds step by step.
#include "tests/strategies/setpoint_example.h"

#include <gtest/gtest.h>

#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::setpoint_example_test {
namespace {

Acting with_limit(double max, Action action, const IdentifiedMachine& identified) {
  const Entry entry = setpoint_entry();
  Parameters parameters = default_parameters(entry);
  parameters.set("max_um", max);
  parameters.set("iterations", std::string_view("converged"));
  return make_acting(entry, parameters, action, identified);
}

// X is 0.1 mm/m too long: at X = 36.16 mm the axis must fall short by 3.616 um.
TEST(SetpointExample, CompensatesAScaleErrorByItsNegative) {
  plant::ErrorModel errors;
  errors.component({Axis::X, Axis::X}) = plant::polynomial({0.0, 1e-4});
  const IdentifiedMachine identified = identified_with(errors);
  Joints Q = identified.reference;
  Q[0] = 36.16 * mm;
  const Joints d =
      with_limit(500.0 * um, Action::compensate, identified).displacement(identified.layout, Q);
  constexpr double kSecondOrder = 1e-4 * 3.616 * um;  // slope times error
  EXPECT_NEAR(d[0], -3.616 * um, kSecondOrder);
  EXPECT_EQ(d[1], 0.0);
  EXPECT_EQ(d[2], 0.0);
}

TEST(SetpointExample, LeavesNoErrorOfTheToolCentrePoint) {
  constexpr double kConvergedTol = 1e-12;  // m
  plant::Uniform random(23);
  const IdentifiedMachine identified = identified_with(plant::random_errors(random, 20.0 * um));
  const Acting acting = with_limit(1.0, Action::compensate, identified);
  for (int n = 0; n < 50; ++n) {
    Joints Q = identified.reference;
    for (int j = 0; j < kLinearJoints; ++j) Q[j] = 0.15 * random();
    const Joints moved = Q + acting.displacement(identified.layout, Q);
    const Eigen::Vector3d actual = identified.model.forward(moved, identified.p_ST).p_WT;
    const Eigen::Vector3d wanted =
        plant::forward(identified.model.chain(), Q, identified.p_ST).p_WT;
    EXPECT_LT((actual - wanted).norm(), kConvergedTol);
  }
}

TEST(SetpointExample, SaturatesAtItsLimit) {
  plant::ErrorModel errors;
  errors.component({Axis::X, Axis::X}) = plant::constant(80.0 * um);
  const IdentifiedMachine identified = identified_with(errors);
  for (const Action action : {Action::impose, Action::compensate}) {
    const double direction = action == Action::impose ? 1.0 : -1.0;
    for (const auto& [max, expected] : {std::pair{100.0, 80.0}, std::pair{50.0, 50.0}}) {
      const Joints d =
          with_limit(max * um, action, identified).displacement(identified.layout, Joints::Zero());
      EXPECT_NEAR(d[0], direction * expected * um, 1e-15) << max;
    }
  }
}

TEST(SetpointExample, ChangesNothingOnAPerfectMachine) {
  const IdentifiedMachine identified = identified_with({});
  const Acting acting = with_limit(500.0 * um, Action::compensate, identified);
  EXPECT_EQ(acting.displacement(identified.layout, identified.reference), Joints::Zero());
}

}  // namespace
}  // namespace servomill::strategies::setpoint_example_test
