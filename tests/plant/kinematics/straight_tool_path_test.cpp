#include "plant/kinematics/straight_tool_path.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "plant/kinematics/nonlinear_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::plant::straight_tool_path_test {
namespace {

constexpr double kRounding = 1e-12;  // m, rad; some products at 1 m
const Eigen::Vector3d kTool(0.0, 0.0, -0.11);

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double size) { return size * part_(engine_); }
  Eigen::Vector3d vector(double size) { return {(*this)(size), (*this)(size), (*this)(size)}; }

 private:
  boost::random::mt19937 engine_;
  boost::random::uniform_real_distribution<double> part_{-1.0, 1.0};
};

const std::array<const char*, 4> kStructures = {"[w C' A' b X Y Z t]", "[w C' B' X b Y Z t]",
                                                "[w C' X' b Y Z B t]", "[w X' b Y Z C A t]"};

InverseKinematics machine(const char* structure) {
  return InverseKinematics(make_chain(parse_structure(structure)));
}

// Joints for which no rotary axis is near a singular direction, and a neighbour.
std::pair<Joints, Joints> some_segment(Random& random) {
  Joints Q_0, Q_1;
  Q_0.head<3>() = random.vector(0.2);
  Q_0[3] = 0.8 + random(0.4);
  Q_0[4] = random(3.0);
  Q_1.head<3>() = Q_0.head<3>() + random.vector(0.01);
  Q_1[3] = Q_0[3] + random(0.1);
  Q_1[4] = Q_0[4] + random(0.1);
  return {Q_0, Q_1};
}

StraightToolPath path_between(const InverseKinematics& inverse, const Joints& Q_0,
                              const Joints& Q_1) {
  return {forward(inverse.chain(), Q_0, kTool), forward(inverse.chain(), Q_1, kTool)};
}

TEST(StraightToolPath, TipOnTheChordAxisOnTheGreatCircleBothUniform) {
  Random random(1);
  for (int n = 0; n < 1000; ++n) {
    const ToolPose a{random.vector(0.2), random.vector(1.0).normalized()};
    const ToolPose b{random.vector(0.2), random.vector(1.0).normalized()};
    const StraightToolPath path(a, b);
    const double t = 0.5 + random(0.5);
    const ToolPose P = path.at(t);
    EXPECT_LT((P.p_WT - (a.p_WT + t * (b.p_WT - a.p_WT))).norm(), kRounding);
    EXPECT_NEAR(P.k_W.norm(), 1.0, kRounding);
    EXPECT_NEAR(angle_between(a.k_W, P.k_W), t * path.angle(), kRounding);
    EXPECT_NEAR(angle_between(P.k_W, b.k_W), (1.0 - t) * path.angle(), kRounding);
  }
}

TEST(StraightToolPath, EndsAreTheLocations) {
  Random random(2);
  const ToolPose a{random.vector(0.2), random.vector(1.0).normalized()};
  const ToolPose b{random.vector(0.2), random.vector(1.0).normalized()};
  const StraightToolPath path(a, b);
  EXPECT_LT((path.at(0.0).k_W - a.k_W).norm(), kRounding);
  EXPECT_LT((path.at(1.0).k_W - b.k_W).norm(), kRounding);
  EXPECT_EQ(StraightToolPath(a, a).at(0.3).k_W, a.k_W.normalized());
}

TEST(Linearise, KeepsTipAndAxisWithinTheTolerance) {
  const ToolTolerance tolerance{0.5 * um, 5e-6};
  for (const char* structure : kStructures) {
    Random random(3);
    const InverseKinematics inverse = machine(structure);
    for (int n = 0; n < 50; ++n) {
      auto [Q, Q_1] = some_segment(random);
      const StraightToolPath path = path_between(inverse, Q, Q_1);
      const LinearisedPath line = linearise(inverse, kTool, path, Q, tolerance);
      ASSERT_TRUE(line.is_complete) << structure << " " << n;
      EXPECT_LT((line.points.back().Q - Q_1).norm(), kRounding) << structure << " " << n;
      double t = 0.0;
      for (const PathPoint& point : line.points) {
        for (double f = 0.0; f < 1.0; f += 0.03) {
          const ToolPose wanted = path.at(t + f * (point.t - t));
          const ToolPose is = forward(inverse.chain(), Q + f * (point.Q - Q), kTool);
          // looked at in three places between two points
          EXPECT_LT((is.p_WT - wanted.p_WT).norm(), 1.01 * tolerance.tip);
          EXPECT_LT(angle_between(is.k_W, wanted.k_W), 1.01 * tolerance.axis);
        }
        t = point.t;
        Q = point.Q;
      }
    }
  }
}

TEST(Linearise, AHundredthOfTheToleranceTakesTenTimesThePoints) {
  const InverseKinematics inverse = machine(kStructures[0]);
  Joints Q_0, Q_1;
  Q_0 << 0.1, 0.05, 0.0, 0.5, 0.0;
  Q_1 << 0.15, 0.05, 0.02, 0.7, 0.8;
  const StraightToolPath path = path_between(inverse, Q_0, Q_1);
  const auto points = [&](double tolerance) {
    return linearise(inverse, kTool, path, Q_0, {tolerance, 1.0}).points.size();
  };
  const double ratio = static_cast<double>(points(1e-9)) / static_cast<double>(points(1e-7));
  EXPECT_GT(ratio, 7.0);  // halving makes steps of 2 of what would be 10
  EXPECT_LT(ratio, 17.0);
}

TEST(Linearise, NoPointWhereTheRotaryAxesStandStill) {
  const InverseKinematics inverse = machine(kStructures[1]);
  Joints Q_0, Q_1;
  Q_0 << 0.1, 0.05, 0.0, 0.5, 0.7;
  Q_1 << -0.1, 0.2, 0.1, 0.5, 0.7;
  const auto line = linearise(inverse, kTool, path_between(inverse, Q_0, Q_1), Q_0, {1e-9, 1e-9});
  EXPECT_EQ(line.points.size(), 1u);
}

TEST(Linearise, GoesThroughASingularDirectionByTiltingToTheOtherSide) {
  const InverseKinematics inverse = machine(kStructures[0]);
  const ToolPose a{Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, 0.1, 1.0).normalized()};
  const ToolPose b{Eigen::Vector3d(0.12, 0.0, 0.0), Eigen::Vector3d(0.0, -0.1, 1.0).normalized()};
  const Joints Q_0 = inverse.nearest(a, kTool, Joints::Zero()).Q;
  const auto line = linearise(inverse, kTool, StraightToolPath(a, b), Q_0, {1 * um, 1e-5});
  ASSERT_TRUE(line.is_complete);
  EXPECT_NEAR(line.points.back().Q[3], -Q_0[3], kRounding);
  EXPECT_NEAR(line.points.back().Q[4], Q_0[4], kRounding);
}

TEST(Linearise, SaysWhereTheJointsWouldHaveToJump) {
  InverseSettings settings;
  settings.lower[3] = 0.0;  // A tilts to one side only: at the pole C must turn round
  const InverseKinematics inverse(make_chain(parse_structure(kStructures[0])), settings);
  const ToolPose a{Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, -0.1, 1.0).normalized()};
  const ToolPose b{Eigen::Vector3d(0.12, 0.0, 0.0), Eigen::Vector3d(0.0, 0.1, 1.0).normalized()};
  const JointSolution begin = inverse.nearest(a, kTool, Joints::Zero());
  ASSERT_TRUE(begin.is_reached());
  const auto line = linearise(inverse, kTool, StraightToolPath(a, b), begin.Q, {1 * um, 1e-5});
  EXPECT_FALSE(line.is_complete);
  EXPECT_NEAR(line.t, 0.5, 1e-6);
}

// On the axis of C, where the tip stays while C turns.
TEST(Linearise, LeavesASingularDirectionOnTheBranchThatArrives) {
  InverseSettings settings;
  settings.lower[3] = -10 * deg;
  settings.upper[3] = 110 * deg;
  const ToolPose a{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()};
  const Joints Q_0 = machine(kStructures[0]).nearest(a, kTool, Joints::Zero()).Q;
  for (const char* structure : kStructures) {
    const InverseKinematics inverse(make_chain(parse_structure(structure)), settings);
    for (int phi = -180; phi < 180; phi += 30) {
      const Eigen::Vector3d k(0.5 * std::cos(phi * deg), 0.5 * std::sin(phi * deg),
                              std::sqrt(0.75));
      const StraightToolPath path(a, {{0.01, 0.0, 0.0}, k});
      const auto line = linearise(inverse, kTool, path, Q_0, {1 * um, 1e-5});
      ASSERT_TRUE(line.is_complete) << structure << " " << phi;
      EXPECT_TRUE(inverse.is_within_travel(line.points.back().Q));
      EXPECT_LT((forward(inverse.chain(), line.points.back().Q, kTool).k_W - k).norm(), kRounding);
      Joints Q = Q_0;
      double t = 0.0;
      for (const PathPoint& point : line.points) {
        for (double f = 0.0; f < 1.0; f += 0.1) {
          const ToolPose wanted = path.at(t + f * (point.t - t));
          const ToolPose is = forward(inverse.chain(), Q + f * (point.Q - Q), kTool);
          EXPECT_LT((is.p_WT - wanted.p_WT).norm(), 1.01 * um);
          EXPECT_LT(angle_between(is.k_W, wanted.k_W), 1.01e-5);
        }
        t = point.t;
        Q = point.Q;
      }
    }
  }
}

TEST(PostProcessedSegment, ErrorsVanishAtBothEndsAndModelsMeetThemInTheMiddle) {
  Random random(4);
  for (const char* structure : kStructures) {
    const InverseKinematics inverse = machine(structure);
    for (int n = 0; n < 50; ++n) {
      const auto [Q_0, Q_1] = some_segment(random);
      const PostProcessedSegment segment(inverse, kTool, Q_0, Q_1);
      for (const auto definition :
           {NonlinearError::joint_interpolation, NonlinearError::post_processed_location}) {
        EXPECT_LT(segment.error(definition, 0.0)->norm(), kRounding);
        EXPECT_LT(segment.error(definition, 1.0)->norm(), kRounding);
      }
      const auto a = *segment.error(NonlinearError::joint_interpolation, 0.5);
      const auto Q =
          segment.compensated(NonlinearError::joint_interpolation, ErrorShape::harmonic, a, 0.5);
      const auto middle = forward(inverse.chain(), *Q, kTool).p_WT;
      const auto path = path_between(inverse, Q_0, Q_1);
      EXPECT_LT((middle - path.at(0.5).p_WT).norm(), kRounding);
    }
  }
}

TEST(PostProcessedSegment, StandingTipIsCompensatedToo) {
  const InverseKinematics inverse = machine(kStructures[0]);
  const Eigen::Vector3d P(0.1, 0.05, 0.02);
  const auto segment = *PostProcessedSegment::post(inverse, kTool, {P, {0.6, 0.0, 0.8}},
                                                   {P, {0.8, 0.0, 0.6}}, Joints::Zero());
  const auto bend = [&](const std::vector<PathPoint>& points) {
    double worst = 0.0;
    Joints Q = segment.Q_0();
    for (const PathPoint& point : points) {
      for (double f = 0.0; f <= 1.0; f += 0.1) {
        const Joints at = Q + f * (point.Q - Q);
        worst = std::max(worst, (forward(inverse.chain(), at, kTool).p_WT - P).norm());
      }
      Q = point.Q;
    }
    return worst;
  };
  const auto points = segment.compensated_points(NonlinearError::joint_interpolation,
                                                 ErrorShape::parabolic, 1 * um, 0.1 * mm);
  // what the model leaves, and the chords between points, which are shorter by their number
  const auto peaks = *nonlinear_peaks(segment, NonlinearError::joint_interpolation);
  const double chord = peaks.error / static_cast<double>(points->size() * points->size());
  ASSERT_GT(points->size(), 10u);
  EXPECT_LT(bend(*points), peaks.parabolic + 2.0 * chord);
}

TEST(PostProcessedSegment, ErrorIsOfSecondOrderInTheLength) {
  const InverseKinematics inverse = machine(kStructures[0]);
  Joints Q_0, step;
  Q_0 << 0.1, 0.05, 0.0, 0.5, 0.3;
  step << 0.05, 0.0, 0.02, 0.2, 0.3;
  double before = 0.0;
  for (const double h : {1.0, 0.5, 0.25, 0.125}) {
    const PostProcessedSegment segment(inverse, kTool, Q_0, Q_0 + h * step);
    const double error = nonlinear_peaks(segment, NonlinearError::joint_interpolation)->error;
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.5);  // second order in the length
    }
    before = error;
  }
}

TEST(PostProcessedSegment, ParabolaIsBetterByAnOrderOfTheLength) {
  const InverseKinematics inverse = machine(kStructures[0]);
  Joints Q_0, step;
  Q_0 << 0.1, 0.05, 0.0, 0.5, 0.3;
  step << 0.05, 0.0, 0.02, 0.2, 0.3;
  const auto shares = [&](double h) {
    const PostProcessedSegment segment(inverse, kTool, Q_0, Q_0 + h * step);
    const auto peaks = *nonlinear_peaks(segment, NonlinearError::joint_interpolation);
    return std::pair(peaks.harmonic / peaks.error, peaks.parabolic / peaks.error);
  };
  // sin(pi t) differs from 4 t (1 - t) by 0.0560 at most; the rest of the parabola is of third
  // order
  EXPECT_NEAR(shares(1e-2).first, 0.0560, 0.0005);
  EXPECT_NEAR(shares(0.1).second / shares(0.05).second, 2.0, 0.2);
}

}  // namespace
}  // namespace servomill::plant::straight_tool_path_test
