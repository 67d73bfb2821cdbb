#include "sim/identification/inverse_dynamics.h"

#include <gtest/gtest.h>

#include "sim/identification/synthesize.h"
#include "tests/sim/identification/axis_experiment.h"
#include "tests/text.h"

namespace servomill::sim::identification::inverse_dynamics_test {
namespace {

TEST(InverseDynamics, FindsTheAxisThatWasSimulated) {
  AxisModel model{small_axis(), small_loop()};
  model.drive.F_load = -3.0;
  // filters that hardly round the corners of the motion
  const InverseDynamicsSettings settings{.position_corner = 400.0};
  const InverseDynamics found = inverse_dynamics(recorded(ramps(6.0), model), false, settings);
  EXPECT_NEAR(found.values[0], model.drive.slide_mass(), 1.0);
  EXPECT_NEAR(found.values[1], 200.0, 6.0);
  EXPECT_NEAR(found.values[2], 20.0, 0.5);
  EXPECT_NEAR(found.values[3], -3.0, 0.1);
  EXPECT_LT(found.misfit, 0.05);
}

TEST(InverseDynamics, DirectionsOfASymmetricAxisDoNotDiffer) {
  const AxisModel model{small_axis(), small_loop()};
  const NoiseSettings noise{.force_rms = 1.5, .force_time = 8e-3, .feedback_step = 50e-9};
  const InverseDynamics found = inverse_dynamics(synthesize(ramps(12.0), model, noise), true);
  EXPECT_FALSE(test_symmetry(found).rejected()) << test_symmetry(found).viscous;
}

TEST(InverseDynamics, NeedsAForceAMotionAndSomeTime) {
  const AxisModel model{small_axis(), small_loop()};
  Record record = recorded(ramps(1.0), model);
  Record without = record;
  without.force.clear();
  EXPECT_EQ(fault_messages([&] { inverse_dynamics(without, false); }),
            "inverse dynamics needs the force or the motor current\n");
  Record still = record;
  still.feedback.assign(still.size(), 0.1);
  EXPECT_EQ(fault_messages([&] { inverse_dynamics(still, false); }),
            "contains no motion; the identification requires motion\n");
  Record brief = record;
  brief.feedback.resize(300);
  brief.force.resize(300);
  EXPECT_EQ(fault_messages([&] { inverse_dynamics(brief, false); }),
            "is too short for inverse dynamics: 0.3 s\n");
}

}  // namespace
}  // namespace servomill::sim::identification::inverse_dynamics_test
