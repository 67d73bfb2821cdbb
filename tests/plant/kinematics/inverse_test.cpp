#include "plant/kinematics/inverse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr double kRoundTrip = 1e-12;  // m or 1, promised
constexpr double kSqrt_2 = std::numbers::sqrt2;
constexpr double kFullTurn = 2.0 * std::numbers::pi;

double miss(const MachineChain& chain, const Joints& Q, const Vector3d& p_ST, const ToolPose& P) {
  const ToolPose got = forward(chain, Q, p_ST);
  return std::max((got.p_WT - P.p_WT).norm(), (got.k_W - P.k_W).norm());
}

TEST(InverseLaws, ForwardOfEverySolutionIsThePose) {
  constexpr int kPoses = 6000;  // of each kind: 10^5 in all
  Uniform random(51);
  double worst = 0.0;
  for (const Kind& kind : kKinds) {
    for (int n = 0; n < kPoses; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      const InverseKinematics inverse(chain);
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const ToolPose P = forward(chain, Q, p_ST);
      const JointSolutions solutions = inverse.solve(P, p_ST, random_joints(chain, random));
      ASSERT_EQ(solutions.count, 2) << kind.name;
      for (const JointSolution& s : solutions.all) {
        ASSERT_TRUE(s.is_reached()) << kind.name << " " << Q.transpose();
        worst = std::max(worst, miss(chain, s.Q, p_ST, P));
      }
      ASSERT_LT(worst, kRoundTrip) << kind.name << " " << Q.transpose();
    }
  }
  RecordProperty("worst", std::to_string(worst));
  std::printf("worst %g\n", worst);
}

TEST(InverseLaws, TheJointsThemselvesAreTheNearestSolution) {
  Uniform random(52);
  double worst = 0.0;
  for (const Kind& kind : kKinds) {
    for (int n = 0; n < 1000; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      Joints Q = random_joints(chain, random);
      Q[3] *= 10.0;  // many turns
      const Vector3d p_ST = 0.2 * random.vector();
      const JointSolution s = InverseKinematics(chain).nearest(forward(chain, Q, p_ST), p_ST, Q);
      worst = std::max(worst, (s.Q - Q).norm());
      ASSERT_LT((s.Q - Q).norm(), 1e-6) << kind.name << "\n"
                                        << Q.transpose() << "\n"
                                        << s.Q.transpose();
    }
  }
  std::printf("worst %g\n", worst);
}

}  // namespace
}  // namespace servomill::plant
