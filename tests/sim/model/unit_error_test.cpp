#include "sim/model/unit_error.h"

#include <gtest/gtest.h>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::model::unit_error_test {
namespace {

using plant::operator""_err;
using Eigen::Vector3d;

Vector3d tip_error(const plant::ErrorName& name, const Joints& Q, const Vector3d& p_ST) {
  const plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w b X Y Z t]"));
  return plant::VolumetricModel(chain, unit_error(name)).first_order_error(Q, p_ST).dp_W /
         kUnitError;
}

// EXX shifts the tip along X; EBZ turns it about Y, by the arm from Z to the tip; EC0Y turns what
// Y carries along.
TEST(UnitError, ShiftsTheTipByTheArmOfEachError) {
  Joints Q = Joints::Zero();
  Q.head<3>() << 0.3, 0.2, 0.1;
  const Vector3d tool(0.0, 0.0, -0.15);
  EXPECT_LT((tip_error("EXX"_err, Q, tool) - Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((tip_error("EBZ"_err, Q, tool) - Vector3d(-0.15, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((tip_error("EC0Y"_err, Q, tool) - Vector3d(-0.2, 0.0, 0.0)).norm(), 1e-12);
}

TEST(UnitError, IsOneErrorOnly) {
  const plant::ErrorModel location = unit_error("EC0Y"_err), component = unit_error("EXX"_err);
  EXPECT_EQ(location.location("EC0Y"_err), kUnitError);
  EXPECT_EQ(location.location("EB0Z"_err), 0.0);
  EXPECT_EQ(component.component("EXX"_err).value(0.3, {}), kUnitError);
  EXPECT_EQ(component.component("EYX"_err).value(0.3, {}), 0.0);
}

}  // namespace
}  // namespace servomill::sim::model::unit_error_test
