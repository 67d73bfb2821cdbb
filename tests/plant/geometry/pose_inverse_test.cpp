#include "plant/geometry/pose_inverse.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

TEST(PoseInverse, Statistics) {
  Uniform random(91);
  for (const Kind& kind : kKinds) {
    std::array<int, 22> steps{};
    int missed = 0, singular = 0;
    double worst_distance = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const MachineChain chain = random_chain_of(kind, random);
      const VolumetricModel model(chain, random_errors(random, 1e-3));
      const InverseKinematics ideal(chain);
      const Joints Q = random_joints(chain, random);
      const Vector3d p_ST = 0.2 * random.vector();
      const ToolPose P = model.forward(Q, p_ST);
      const TrueJoints found = nonideal_inverse(model, ideal, P, p_ST, Q);
      ++steps[static_cast<std::size_t>(found.steps)];
      if (found.is_singular) ++singular;
      if (!found.is_reached()) {
        ++missed;
      }
      if (found.steps > 4)
        worst_distance = std::max(worst_distance, ideal.distance_from_singular(P.k_W));
    }
    std::printf("%-30s missed %d singular %d steps:", kind.name, missed, singular);
    for (int s : steps) std::printf(" %d", s);
    std::printf(" | worst distance with > 4 steps %g\n", worst_distance);
  }
}

}  // namespace
}  // namespace servomill::plant
