/// A prepared model does not touch the heap: it is evaluated in the tick.
#include <gtest/gtest.h>

#include "plant/geometry/pose_inverse.h"
#include "tests/counting_new.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::volumetric_allocation_test {
namespace {

TEST(VolumetricModel, DoesNotAllocate) {
  Uniform random(41);
  ErrorModel errors = random_errors(random, 1e-4);
  errors.component("EXX"_err) = linear_table({-1.0, 0.0, 1.0}, {1e-5, 0.0, 1e-5});
  // three orthogonal linear axes, and two with a rotary one between
  for (const char* text : {"[w C' B' X b Y Z t]", "[w C' X b B Z t]"}) {
    const MachineChain chain = make_chain(parse_structure(text));
    const VolumetricModel model(chain, errors);
    const Joints Q = random_joints(chain, random);
    const Eigen::Vector3d p_ST(0.0, 0.0, -0.1);
    const std::vector<Joints> many(11, Q);
    std::vector<ToolPose> poses(many.size());
    std::vector<VolumetricError> each(many.size());
    std::vector<Eigen::Vector3d> offsets(many.size());
    const std::size_t before = allocations;
    model.poses(many, p_ST, poses);
    model.errors(many, p_ST, each);
    model.joint_offsets(many, p_ST, offsets);
    LaneArray lanes[kJoints]{}, offsets_in_lanes[kLinearJoints];
    model.joint_offsets(lanes, p_ST, offsets_in_lanes);
    const Eigen::Vector3d p_WT = model.forward(Q, p_ST).p_WT;
    const Eigen::Vector3d dp = model.error(Q, p_ST).dp_W;
    const Eigen::Vector3d first = model.first_order_error(Q, p_ST).dp_W;
    const Eigen::Vector3d offset = model.joint_offset(Q, p_ST);
    const auto inverse = model.inverse(p_WT, Q, p_ST);
    EXPECT_EQ(allocations, before) << text;
    EXPECT_TRUE(inverse && dp.allFinite() && first.allFinite() && offset.allFinite());
    ::operator delete(::operator new(1));  // the counter counts
    EXPECT_EQ(allocations, before + 1);
  }
}

TEST(InverseKinematics, DoesNotAllocate) {
  Uniform random(42);
  const ErrorModel errors = random_errors(random, 1e-4);
  for (const char* text : {"[w C' B' X b Y Z t]", "[w C' X b B Z t]", "[w b X Y Z t]"}) {
    const MachineChain chain = random_inclined_chain(parse_structure(text), random);
    const VolumetricModel model(chain, errors);
    const InverseKinematics ideal(chain);
    const Joints Q = random_joints(chain, random);
    const Eigen::Vector3d p_ST(0.0, 0.0, -0.1);
    const ToolPose P = forward(chain, Q, p_ST);
    const std::size_t before = allocations;
    const JointSolution solution = ideal.nearest(P, p_ST, Q);
    const TrueJoints found = nonideal_inverse(model, ideal, P, p_ST, Q);
    EXPECT_EQ(allocations, before) << text;
    EXPECT_TRUE(solution.is_reached() && found.Q.allFinite()) << text;
  }
}

}  // namespace
}  // namespace servomill::plant::volumetric_allocation_test
