// Geometric errors by temperatures.
#include "plant/heat/thermal_errors.h"

#include <gtest/gtest.h>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::thermal_errors_test {
namespace {

constexpr double kReference = 293.15;  // K
constexpr int kSpindle = 0, kColumn = 1, kScale = 2;

// Growth of the spindle 3 um/K, tilt of the column 4 urad/K, scale of X 10.5 um/m/K.
std::vector<ThermalError> errors_of_a_machine() {
  std::vector<ThermalError> out = {{kSpindle, {}}, {kColumn, {}}, {kScale, {}}};
  out[0].per_kelvin.component("EZZ"_err) = constant(-3.0 * um);
  out[1].per_kelvin.component("EAZ"_err) = constant(4.0 * urad);
  out[2].per_kelvin.component("EXX"_err) = polynomial({0.0, 10.5e-6});
  return out;
}

TEST(ThermalErrors, AreZeroAtTheReference) {
  ErrorModel errors;
  errors.component("EYX"_err) = polynomial({1.0 * um, 2e-6});
  const VolumetricModel cold(make_chain(parse_structure("[w b X Y Z t]")), errors);
  const VolumetricModel same(cold.chain(),
                             at_temperatures(errors, errors_of_a_machine(),
                                             Eigen::Vector3d::Constant(kReference), kReference));
  Joints Q = Joints::Zero();
  Q.head<3>() << 0.1, 0.2, 0.3;
  EXPECT_EQ(cold.error(Q, {0, 0, -0.1}).dp_W, same.error(Q, {0, 0, -0.1}).dp_W);
}

// A spindle that grows lowers the tip, a scale that grows takes the slide farther, and a column
// that tilts about X takes a tip 0.15 m below its axes along Y.
TEST(ThermalErrors, AreProportionalToTheRise) {
  const MachineChain chain = make_chain(parse_structure("[w b X Y Z t]"));
  const Eigen::Vector3d T = Eigen::Vector3d::Constant(kReference) + Eigen::Vector3d(12.0, 1.5, 2.0);
  const VolumetricModel warm(chain, at_temperatures({}, errors_of_a_machine(), T, kReference));
  Joints Q = Joints::Zero();
  Q[0] = 0.4;
  const Eigen::Vector3d p_ST(0.0, 0.0, -0.15);
  const Eigen::Vector3d e = warm.error(Q, p_ST).dp_W;
  EXPECT_NEAR(e.x(), 0.4 * 10.5e-6 * 2.0, 1e-12);
  EXPECT_NEAR(e.y(), 0.15 * 4e-6 * 1.5, 1e-12);
  EXPECT_NEAR(e.z(), -36.0 * um, 1e-11);
}

}  // namespace
}  // namespace servomill::plant::thermal_errors_test
