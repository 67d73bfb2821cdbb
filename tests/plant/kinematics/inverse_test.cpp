#include "plant/kinematics/inverse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr double kRoundTrip = 1e-12;  // m or 1, promised
constexpr double kSqrt_2 = std::numbers::sqrt2;
constexpr double kFullTurn = 2.0 * std::numbers::pi;

// A machine of a common kind: structure, and where a rotary axis points if it is inclined.
struct Kind {
  const char* name;
  const char* structure;
  std::vector<std::pair<Axis, Vector3d>> directions;
};
const std::vector<Kind> kKinds = {
    {"table-table BC", "[w C' B' X b Y Z t]", {}},
    {"table-table AC, trunnion", "[w C' A' b X Y Z t]", {}},
    {"table-table AC on Y", "[w C' A' Y b X Z t]", {}},
    {"table-table AB", "[w B' A' b X Y Z t]", {}},
    {"head-table BC", "[w C' X b Y Z B t]", {}},
    {"head-table AC", "[w C' Y b X Z A t]", {}},
    {"head-table AB", "[w A' b X Y Z B t]", {}},
    {"head-head CA", "[w b X Y Z C A t]", {}},
    {"head-head CB on a moving table", "[w X b Y Z C B t]", {}},
    {"head-head AB", "[w b X Y Z A B t]", {}},
    {"head-head BA", "[w X Y b Z B A t]", {}},
    {"rotary between the linear axes", "[w C' X b A Y Z t]", {}},
    {"45 deg nutating head CB", "[w b X Y Z C B t]", {{Axis::B, {0, 1, 1}}}},
    {"45 deg nutating table CB", "[w C' B' X b Y Z t]", {{Axis::B, {0, 1, 1}}}},
    {"45 deg nutating head, C table", "[w C' Y b X Z B t]", {{Axis::B, {0, -1, 1}}}},
    {"50 deg nutating head CA",
     "[w b X Y Z C A t]",
     {{Axis::A, {0, std::sin(50 * deg), std::cos(50 * deg)}}}},
    {"both inclined, anywhere",
     "[w X A' b Y Z C t]",
     {{Axis::A, {1, 0.3, -0.2}}, {Axis::C, {0.7, 0.5, 0.6}}}},
};

[[maybe_unused]] MachineChain chain_of(const Kind& kind) {
  MachineChain chain = make_chain(parse_structure(kind.structure));
  for (const auto& [axis, direction] : kind.directions) incline(chain.at(axis), direction);
  return chain;
}

// With centres and senses at random.
MachineChain random_chain_of(const Kind& kind, Uniform& random) {
  MachineChain chain = random_chain(parse_structure(kind.structure), random);
  for (const auto& [axis, direction] : kind.directions) incline(chain.at(axis), direction);
  return chain;
}

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
