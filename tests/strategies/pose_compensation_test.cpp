/// Displacement of all joints: tip and tool axis together.
#include "strategies/pose_compensation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::strategies::pose_compensation_test {
namespace {

constexpr double kSigma0 = 0.02;      // about 1.1 deg
constexpr double kPoseTol = 1e-12;    // m, rad: rounding of some 0.5 m and of unit vectors
constexpr double kErrorSize = 20e-6;  // m, rad: what single errors of random models are, about

// Table-table, head-table, head-head, with each two of A, B, C.
constexpr const char* kStructures[] = {
    "[w C' B' X b Y Z (C1) t]", "[w C' A' X b Y Z t]", "[w B' A' X b Y Z t]",
    "[w C' X Y b Z B t]",       "[w C' b X Y Z A t]",  "[w B' X b Y Z A t]",
    "[w X b Y Z C A t]",        "[w b X Y Z C B t]",   "[w X Y b Z B A t]"};

IdentifiedMachine identified_of(const plant::MachineChain& chain, const plant::ErrorModel& errors) {
  IdentifiedMachine identified{chain.layout, plant::VolumetricModel(chain, errors)};
  identified.p_ST << 3.0 * mm, -2.0 * mm, -110.0 * mm;
  return identified;
}

struct Case {
  std::string name;
  IdentifiedMachine identified;
  std::vector<Joints> Q;
};

// Random machines, the last ones with rotary axes that point anywhere, and poses of them that are
// farther than 3 deg from a singular direction.
std::vector<Case> cases(double error_size, int poses) {
  std::vector<Case> out;
  plant::Uniform random(101);
  for (const bool inclined : {false, true}) {
    for (const char* name : kStructures) {
      const plant::Structure structure = plant::parse_structure(name);
      const plant::MachineChain chain = inclined ? plant::random_inclined_chain(structure, random)
                                                 : plant::random_chain(structure, random);
      const plant::ErrorModel errors = plant::random_errors(random, error_size);
      Case one{name, identified_of(chain, errors), {}};
      for (int tries = 0; static_cast<int>(one.Q.size()) < poses; ++tries) {
        if (tries == 10000) throw std::logic_error(one.name + " is singular everywhere");
        const Joints Q = plant::random_joints(chain, random);
        const auto J = plant::jacobian(chain, Q, one.identified.p_ST);
        const Eigen::Vector3d a = J.J_kQ.col(3), b = J.J_kQ.col(4);
        if (a.cross(b).norm() > 0.06) one.Q.push_back(Q);  // product of the singular values
      }
      out.push_back(std::move(one));
    }
  }
  return out;
}

struct Miss {
  double tip, axis;
};
Miss between(const ToolPose& a, const ToolPose& b) {
  return {(a.p_WT - b.p_WT).norm(), a.k_W.cross(b.k_W).norm()};
}

#define EXPECT_SAME_POSE(a, b)              \
  do {                                      \
    const Miss miss = between(a, b);        \
    EXPECT_LT(miss.tip, kPoseTol) << name;  \
    EXPECT_LT(miss.axis, kPoseTol) << name; \
  } while (false)

// All 43 errors, tip and tool axis, on machines of all kinds.
TEST(PoseCompensation, OfTheSetpointIsTheNonidealInverse) {
  for (const auto& [name, identified, poses] : cases(kErrorSize, 20)) {
    const PoseCompensation all(identified, Iterations::converged, kSigma0);
    const plant::MachineChain& chain = identified.model.chain();
    for (const Joints& Q : poses) {
      const Joints d = all.of_setpoint(Action::compensate, Q);
      EXPECT_SAME_POSE(identified.model.forward(Q + d, identified.p_ST),
                       plant::forward(chain, Q, identified.p_ST));
      const Residual left = all.residual(Q, d);
      EXPECT_LT(left.tip, kPoseTol);
      EXPECT_LT(left.axis, kPoseTol);
      const Joints g = all.of_setpoint(Action::impose, Q);
      EXPECT_SAME_POSE(plant::forward(chain, Q + g, identified.p_ST),
                       identified.model.forward(Q, identified.p_ST));
    }
  }
}

// The NC reads Q + d and holds it at Q_cmd.
TEST(PoseCompensation, OfTheFeedbackPutsTheAxesWhereTheSetpointDoes) {
  for (const auto& [name, identified, poses] : cases(kErrorSize, 4)) {
    const PoseCompensation all(identified, Iterations::converged, kSigma0);
    const plant::MachineChain& chain = identified.model.chain();
    for (const Joints& Q_cmd : poses) {
      for (const Action action : {Action::compensate, Action::impose}) {
        Joints Q_true = Q_cmd;
        for (int n = 0; n < 30; ++n) Q_true = Q_cmd - all.of_feedback(action, Q_true);
        if (action == Action::compensate) {
          EXPECT_SAME_POSE(identified.model.forward(Q_true, identified.p_ST),
                           plant::forward(chain, Q_cmd, identified.p_ST));
        } else {
          EXPECT_SAME_POSE(plant::forward(chain, Q_true, identified.p_ST),
                           identified.model.forward(Q_cmd, identified.p_ST));
        }
      }
    }
  }
}

// With errors half as large a quarter is left.
TEST(PoseCompensation, InOneStepLeavesWhatIsOfSecondOrder) {
  const std::vector<Case> large = cases(kErrorSize, 5), small = cases(0.5 * kErrorSize, 5);
  for (std::size_t n = 0; n < large.size(); ++n) {
    const PoseCompensation at_full(large[n].identified, Iterations::one, kSigma0);
    const PoseCompensation at_half(small[n].identified, Iterations::one, kSigma0);
    for (const Joints& Q : large[n].Q) {
      const Joints d = at_full.of_setpoint(Action::compensate, Q);
      EXPECT_EQ(d, -at_full.of_setpoint(Action::impose, Q));
      EXPECT_EQ(d, -at_full.of_feedback(Action::compensate, Q));
      const Residual full = at_full.residual(Q, d);
      const Residual half = at_half.residual(Q, at_half.of_setpoint(Action::compensate, Q));
      constexpr double kThirdOrder = 0.1;  // of the ratio 4: 20 errors of 20e-6 and slopes of 8
      EXPECT_NEAR(full.tip / half.tip, 4.0, kThirdOrder) << large[n].name << full.tip;
      EXPECT_NEAR(full.axis / half.axis, 4.0, kThirdOrder) << large[n].name << full.axis;
    }
  }
}

// A tip displaced by d dr is displaced once: without errors of the tool axis both ways agree, and
// without rotary axes they always do.
TEST(PoseCompensation, IsThatOfTheLinearAxesWhereTheToolAxisHasNoError) {
  constexpr double kRounding = 1e-15;  // m, rad
  plant::Uniform random(7);
  for (const char* name : {"[w C' B' X b Y Z t]", "[w X b Y Z t]", "[w C' X b Y Z A t]"}) {
    const plant::MachineChain chain = plant::random_chain(plant::parse_structure(name), random);
    plant::ErrorModel errors = plant::random_errors(random, kErrorSize);
    if (chain.layout.has(kLinearJoints)) {
      for (const Axis axis : kAllAxes) {
        for (const Axis turn : {Axis::A, Axis::B, Axis::C}) {
          errors.component({turn, axis, false}) = {};
          errors.location({turn, axis, true}) = 0.0;
        }
      }
    }
    const IdentifiedMachine identified = identified_of(chain, errors);
    const PoseCompensation all(identified, Iterations::one, kSigma0);
    for (int n = 0; n < 20; ++n) {
      const Joints Q = plant::random_joints(chain, random);
      const Joints d = all.of_setpoint(Action::compensate, Q);
      const Eigen::Vector3d linear =
          setpoint_displacement(identified, Action::compensate, Iterations::one, Q);
      EXPECT_LT((d.head<3>() - linear).norm(), kRounding) << name;
      EXPECT_LT(d.tail<2>().norm(), kRounding) << name;
    }
  }
}

// A tool axis that errs about X, across what B can turn: only C could correct it.
IdentifiedMachine tilted(double EAB) {
  plant::ErrorModel errors;
  errors.component({Axis::A, Axis::B, false}) = plant::constant(EAB);
  return identified_of(plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]")), errors);
}

// At x sigma_0 from the singular direction, the share ((1 - x^2)/(1 + x^2))^2 of what C would have
// to correct is left, and C turns by 4 x / (1 + x^2)^2 / sigma_0 of it: 1.3 / sigma_0 at most.
TEST(PoseCompensation, LetsTheFreeAxisGiveWayNearASingularDirection) {
  const double error = 10.0 * urad;
  const IdentifiedMachine identified = tilted(error);
  const PoseCompensation all(identified, Iterations::converged, kSigma0);
  constexpr double kSecondOrder = 2e-3;  // error / sigma_0
  double before = 0.0, largest = 0.0;
  for (double x = -1.5; x <= 1.5; x += 0.01) {
    Joints Q = Joints::Zero();
    Q << 0.1, -0.05, 0.02, std::asin(x * kSigma0), 0.3;
    const Joints d = all.of_setpoint(Action::compensate, Q);
    const Residual left = all.residual(Q, d);
    const double xx = std::min(x * x, 1.0);
    const double share = std::pow((1.0 - xx) / (1.0 + xx), 2);
    const double turn = std::abs(x) < 1.0 ? 4.0 * x / std::pow(1.0 + xx, 2) : 1.0 / x;
    EXPECT_NEAR(left.axis / error, share, kSecondOrder) << x;
    EXPECT_NEAR(std::abs(d[4]), std::abs(turn) * error / kSigma0, kSecondOrder * error / kSigma0)
        << x;
    EXPECT_LT(left.tip, kPoseTol) << x;  // whatever the rotary axes cannot do
    if (x > -1.5) {
      EXPECT_LT(std::abs(d[4] - before), 0.05 * error / kSigma0) << "no jump at " << x;
    }
    before = d[4];
    largest = std::max(largest, std::abs(d[4]));
  }
  EXPECT_NEAR(largest, 0.75 * std::sqrt(3.0) * error / kSigma0, kSecondOrder * error / kSigma0);
}

// Only tilts that the one rotary axis of a machine cannot make remain.
TEST(PoseCompensation, LeavesWhatAMissingAxisWouldHaveToCorrect) {
  plant::ErrorModel errors;
  errors.location({Axis::A, Axis::B, true}) = 30.0 * urad;  // about X: out of reach for B
  errors.component({Axis::B, Axis::X, false}) = plant::polynomial({0.0, 200.0 * urad});
  const IdentifiedMachine identified =
      identified_of(plant::make_chain(plant::parse_structure("[w B' X b Y Z t]")), errors);
  const PoseCompensation all(identified, Iterations::converged, kSigma0);
  Joints Q = Joints::Zero();
  Q << 0.2, 0.1, -0.1, 0.5, 0.0;
  const Joints d = all.of_setpoint(Action::compensate, Q);
  const Residual left = all.residual(Q, d);
  const double out_of_reach = 30.0 * urad * (1.0 - std::cos(0.5));
  constexpr double kSecondOrder = 0.01 * urad;
  EXPECT_LT(left.tip, kPoseTol);
  EXPECT_NEAR(d[3], -40.0 * urad, kSecondOrder);  // takes EBX, which is 200 urad/m, at 0.2 m
  EXPECT_EQ(d[4], 0.0);
  EXPECT_NEAR(left.axis, out_of_reach, kSecondOrder);
}

TEST(Uncorrectable, IsTheTiltOfTheToolOnLinearAxes) {
  for (const Case& one : cases(kErrorSize, 20)) {
    for (const Joints& Q : one.Q) {
      const Residual left = uncorrectable(one.identified, DisplacedAxes::linear, kSigma0, Q);
      Joints at = Q;
      at.head<3>() +=
          setpoint_displacement(one.identified, Action::compensate, Iterations::converged, Q);
      const Eigen::Vector3d dk = one.identified.model.error(at, one.identified.p_ST).dk_W;
      EXPECT_LE(left.tip, kPoseTol) << one.name;
      EXPECT_NEAR(left.axis, dk.norm(), 1e-3 * dk.norm()) << one.name;
    }
  }
}

TEST(Uncorrectable, IsNothingOnAllAxesFarFromASingularDirection) {
  for (const Case& one : cases(kErrorSize, 20)) {
    for (const Joints& Q : one.Q) {
      const Residual left = uncorrectable(one.identified, DisplacedAxes::all, kSigma0, Q);
      EXPECT_LE(left.tip, kPoseTol) << one.name;
      EXPECT_LE(left.axis, kPoseTol) << one.name;
    }
  }
}

// At B = 0 the tool axis lies on C: B turns it about Y, nothing about X. Beside it C would have to
// turn far, and leaves the share that the header states. Turns about the tool itself do not count.
TEST(Uncorrectable, IsWhatTheAxesGiveWayToNearASingularDirection) {
  constexpr double kTilt = 10e-6;    // rad
  constexpr double kSecond = 0.003;  // of it: C turns by some 1e-3 rad to correct it
  const plant::MachineChain chain =
      plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]"));
  const auto left_at = [&](const char* name, double sigma) {
    plant::ErrorModel errors;
    errors.component(*plant::error_name_of(name)) = plant::constant(kTilt);
    const IdentifiedMachine identified = identified_of(chain, errors);
    Joints Q(0.02, -0.03, 0.01, std::asin(sigma), 0.0);
    return uncorrectable(identified, DisplacedAxes::all, kSigma0, Q);
  };
  for (const double x : {0.0, 0.3, 0.7, 1.0, 3.0}) {
    const double share = x < 1.0 ? std::pow((1.0 - x * x) / (1.0 + x * x), 2) : 0.0;
    EXPECT_NEAR(left_at("EAZ", x * kSigma0).axis, share * kTilt, kSecond * kTilt) << x;
    EXPECT_NEAR(left_at("EBZ", x * kSigma0).axis, 0.0, kSecond * kTilt) << x;
    EXPECT_NEAR(left_at("ECZ", x * kSigma0).axis, 0.0, kSecond * kTilt) << x;
    EXPECT_LE(left_at("EAZ", x * kSigma0).tip, kPoseTol) << x;
  }
}

TEST(Uncorrectable, IsNotAskedOfWhatGeneratesErrors) {
  const Case one = cases(kErrorSize, 4).front();
  EXPECT_FALSE(
      uncorrectable(one.identified, Action::impose, DisplacedAxes::all, kSigma0, one.Q[0]));
  EXPECT_TRUE(
      uncorrectable(one.identified, Action::compensate, DisplacedAxes::all, kSigma0, one.Q[0]));
}

}  // namespace
}  // namespace servomill::strategies::pose_compensation_test
