// Numbers of X. Li, Simulation of motion nonlinear error compensation of CNC machine tools with
// multi-axis linkage (2024), and what follows from its printed locations.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fstream>
#include <sstream>

#include "controllers/gcode/cl_data.h"
#include "plant/kinematics/nonlinear_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::li2024_test {
namespace {

using Eigen::Vector3d;
using plant::CutterLocation;
using plant::ErrorFrame;
using plant::ErrorShape;
using plant::NonlinearError;
using plant::NonlinearPeaks;
using plant::PostProcessedSegment;

constexpr NonlinearError kJoint = NonlinearError::joint_interpolation;
constexpr NonlinearError kPosted = NonlinearError::post_processed_location;
const Vector3d kNoTool = Vector3d::Zero();

// The machine of the paper: tables A and C, counted as the tables turn, both about m.
plant::InverseKinematics machine(const Vector3d& m) {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w C' A' b X Y Z (C1) t]"));
  for (const Axis axis : {Axis::A, Axis::C}) {
    chain.at(axis).centre = m;
    chain.at(axis).sense = plant::Sense::table;
  }
  return plant::InverseKinematics(chain);
}

std::string text_of(const std::string& name) {
  std::ifstream file(std::string(SERVOMILL_SOURCE_DIR) + "/scenarios/li2024/" + name);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<CutterLocation> table_3_2() {
  std::vector<CutterLocation> out;
  for (const auto& record :
       controllers::read_cl_data(text_of("table32.csv"), "table32.csv").records) {
    out.push_back({record.P.p_WT, record.P.k_W});
  }
  return out;
}

// Section 3.2.3, vectors as printed: the second one is 1.0020 long.
const CutterLocation kExample1[2] = {
    {Vector3d(-191.4037, 11.3508, 7.6182) * mm, {0.00639, -0.036377, 0.99927}},
    {Vector3d(-191.4057, 13.5159, 7.9093) * mm, {0.006393, -0.068922, 0.99960}}};

NonlinearPeaks peaks_of(const plant::InverseKinematics& inverse, const CutterLocation& from,
                        const CutterLocation& to, NonlinearError definition,
                        ErrorFrame frame = ErrorFrame::machine) {
  const auto segment = PostProcessedSegment::post(inverse, kNoTool, from, to, Joints::Zero());
  return *nonlinear_peaks(*segment, definition, frame);
}

// The largest of each over the 19 segments; residuals as shares of the segment's own peak.
struct Table32Peaks {
  double error = 0.0, harmonic = 0.0, parabolic = 0.0;
};
Table32Peaks table_3_2_peaks(const Vector3d& m, NonlinearError definition) {
  const auto locations = table_3_2();
  const plant::InverseKinematics inverse = machine(m);
  Table32Peaks out;
  for (std::size_t i = 1; i < locations.size(); ++i) {
    const NonlinearPeaks one = peaks_of(inverse, locations[i - 1], locations[i], definition);
    out.error = std::max(out.error, one.error);
    out.harmonic = std::max(out.harmonic, one.harmonic / one.error);
    out.parabolic = std::max(out.parabolic, one.parabolic / one.error);
  }
  return out;
}

// ---- equation 3.1, corrected ----

TEST(Li2024, PostIsEquation31Corrected) {
  constexpr double kRounding = 1e-15;  // m, rad; some products at 0.2 m
  boost::random::mt19937 random(3);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  for (int n = 0; n < 1000; ++n) {
    const Vector3d m = 0.2 * Vector3d(part(random), part(random), part(random));
    const Vector3d P = 0.2 * Vector3d(part(random), part(random), part(random));
    const Vector3d u = Vector3d(part(random), part(random), part(random)).normalized();
    const double A = std::atan2(std::hypot(u[0], u[1]), u[2]), C = std::atan2(u[0], u[1]);
    const Vector3d d = P - m;
    const double turned = std::sin(C) * d[0] + std::cos(C) * d[1];
    const Vector3d S = m + Vector3d(std::cos(C) * d[0] - std::sin(C) * d[1],
                                    std::cos(A) * turned - std::sin(A) * d[2],
                                    std::sin(A) * turned + std::cos(A) * d[2]);
    Joints near = Joints::Zero();
    near.tail<2>() << A, C;
    const auto Q = machine(m).nearest({P, u}, kNoTool, near);
    ASSERT_TRUE(Q.is_reached());
    EXPECT_LT((Q.Q.head<3>() - S).norm(), kRounding) << n;
    EXPECT_LT(std::hypot(Q.Q[3] - A, Q.Q[4] - C), 5 * kRounding / std::sin(A)) << n;
  }
}

// ---- table 3.1 ----

struct Table31 {
  std::vector<double> t, error;  // 1, mm
};
Table31 table_3_1() {
  Table31 out;
  const double chord = (kExample1[1].P - kExample1[0].P).norm();
  std::istringstream text(text_of("table31.csv"));
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    const std::size_t comma = line.find(',');
    out.t.push_back(std::min(1.0, 0.1 * mm * (std::stod(line) - 1.0) / chord));
    out.error.push_back(std::stod(line.substr(comma + 1)));
  }
  return out;
}

constexpr double kPeak31 = 0.973;  // mm

TEST(Li2024, Table31IsAParabolaOverPointsEvery100um) {
  const Table31 table = table_3_1();
  ASSERT_EQ(table.t.size(), 23u);
  double worst = 0.0;
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    worst = std::max(
        worst, std::abs(table.error[k] - kPeak31 * shape_at(ErrorShape::parabolic, table.t[k])));
  }
  EXPECT_LT(worst, 0.0003);  // mm; printed to 0.0001
}

TEST(Li2024, SineLeavesMoreOfTable31ThanItsBestFit) {
  const Table31 table = table_3_1();
  double ss = 0.0, se = 0.0, through_middle = 0.0, best = 0.0;
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    const double s = shape_at(ErrorShape::harmonic, table.t[k]);
    ss += s * s;
    se += s * table.error[k];
  }
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    const double s = shape_at(ErrorShape::harmonic, table.t[k]);
    through_middle = std::max(through_middle, std::abs(table.error[k] - kPeak31 * s));
    best = std::max(best, std::abs(table.error[k] - se / ss * s));
  }
  EXPECT_GT(through_middle / kPeak31, 0.055);
  EXPECT_LT(through_middle / kPeak31, 0.056);
  EXPECT_NEAR(best / kPeak31, 0.042, 0.0005);  // printed to 0.1 %
}

// ---- example 1 ----

TEST(Li2024, Example1WithJointInterpolation) {
  const NonlinearPeaks peaks =
      peaks_of(machine(Vector3d::Zero()), kExample1[0], kExample1[1], kJoint);
  EXPECT_NEAR(peaks.error / mm, 0.156, 0.0005);
  EXPECT_NEAR(peaks.harmonic / peaks.error, 0.0565, 0.0005);
  EXPECT_NEAR(peaks.parabolic / peaks.error, 0.0053, 0.0001);
}

TEST(Li2024, Example1WithAmplitudesOfTheWorkpieceLeavesTwiceAsMuchOfTheParabola) {
  const NonlinearPeaks peaks = peaks_of(machine(Vector3d::Zero()), kExample1[0], kExample1[1],
                                        kJoint, ErrorFrame::workpiece);
  EXPECT_NEAR(peaks.error / mm, 0.156, 0.0005);
  EXPECT_NEAR(peaks.harmonic / peaks.error, 0.057, 0.0005);
  EXPECT_NEAR(peaks.parabolic / peaks.error, 0.0105, 0.0001);
}

// ---- example 1 with u_x of the first location identified ----
//
// The printed U_0 is 0.99995 long, farther from 1 than its digits allow; u_x has one digit fewer
// than its neighbours. A unit vector has u_x = 0.0117 +- 0.0005.

CutterLocation corrected_from(double u_x) {
  return {kExample1[0].P, {u_x, kExample1[0].U[1], kExample1[0].U[2]}};
}
const CutterLocation kCorrectedTo = {kExample1[1].P, {0.006393, -0.068922, 0.9976}};

// Linear axes of the paper's machine that bring the tip to P, from its equations.
Vector3d axes_of(const Vector3d& P, double A, double C, const Vector3d& m) {
  const Vector3d d = P - m;
  const double turned = std::sin(C) * d[0] + std::cos(C) * d[1];
  return m + Vector3d(std::cos(C) * d[0] - std::sin(C) * d[1],
                      std::cos(A) * turned - std::sin(A) * d[2],
                      std::sin(A) * turned + std::cos(A) * d[2]);
}

// Joint interpolation in the machine, by the paper's equations alone: the linear axes, going
// linearly, minus where they would bring the tip onto the chord (mm).
struct ByHand {
  Vector3d m, S_0, S_1;
  double A_0, C_0, A_1, C_1;
  CutterLocation from, to;

  ByHand(const CutterLocation& first, const CutterLocation& second, const Vector3d& centre)
      : m(centre), from(first), to(second) {
    const auto angles = [](const Vector3d& u) {
      return std::pair(std::atan2(std::hypot(u[0], u[1]), u[2]), std::atan2(u[0], u[1]));
    };
    std::tie(A_0, C_0) = angles(from.U);
    std::tie(A_1, C_1) = angles(to.U);
    S_0 = axes_of(from.P, A_0, C_0, m);
    S_1 = axes_of(to.P, A_1, C_1, m);
  }

  Vector3d error(double t) const {
    const Vector3d onto_chord =
        axes_of(from.P + t * (to.P - from.P), A_0 + t * (A_1 - A_0), C_0 + t * (C_1 - C_0), m);
    return (S_0 + t * (S_1 - S_0) - onto_chord) / mm;
  }
  double off_the_line(double t) const { return error(t).cross((S_1 - S_0).normalized()).norm(); }
};

TEST(Li2024, PrintedFirstAxisIsNoUnitVectorAndTheIdentifiedOneIs) {
  const double half_digit = 0.5e-5 * 0.99927 + 0.5e-6 * 0.036377;  // of the length, by u_z and u_y
  EXPECT_GT(1.0 - kExample1[0].U.norm(), 5.0 * half_digit);
  EXPECT_LT(std::abs(1.0 - corrected_from(0.0113).U.norm()), half_digit);
}

TEST(Li2024, Table31FollowsFromTheIdentifiedAxisAboutTheZeroOfThePart) {
  const CutterLocation from = corrected_from(0.0113);
  const plant::InverseKinematics inverse = machine(Vector3d::Zero());
  const NonlinearPeaks peaks = peaks_of(inverse, from, kCorrectedTo, kJoint);
  EXPECT_NEAR(peaks.error / mm, 0.9739, 0.00005);
  const ByHand by_hand(from, kCorrectedTo, Vector3d::Zero());
  Joints near = Joints::Zero();  // the solution A >= 0 that the paper takes
  near.tail<2>() << by_hand.A_0, by_hand.C_0;
  const auto segment = PostProcessedSegment::post(inverse, kNoTool, from, kCorrectedTo, near);
  const Table31 table = table_3_1();
  double squares = 0.0;
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    const Vector3d e = *segment->error(kJoint, table.t[k]) / mm;
    EXPECT_LT((e - by_hand.error(table.t[k])).norm(), 1e-9);
    const Vector3d in_workpiece = *segment->error(kJoint, table.t[k], ErrorFrame::workpiece) / mm;
    EXPECT_NEAR(e.norm(), in_workpiece.norm(), 1e-9);
    squares += std::pow(e.norm() - table.error[k], 2);
  }
  EXPECT_NEAR(std::sqrt(squares / 23.0), 0.77e-3, 0.005e-3);  // mm
}

TEST(Li2024, Table31FollowsToThePrintedDigitWithAnIdentifiedCentre) {
  const ByHand by_hand(corrected_from(0.01130455), kCorrectedTo, {0.0, 0.0, -55.2 * mm});
  const Table31 table = table_3_1();
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    EXPECT_LT(std::abs(by_hand.off_the_line(table.t[k]) - table.error[k]), 0.5e-4) << k + 1;
  }
}

TEST(Li2024, AParabolaLeavesLessInTheMachineOnEverySegmentOfTable32) {
  const auto locations = table_3_2();
  const plant::InverseKinematics inverse = machine(Vector3d::Zero());
  double machine_frame = 0.0, workpiece_frame = 0.0;
  for (std::size_t i = 1; i < locations.size(); ++i) {
    const auto left = [&](ErrorFrame frame) {
      const auto peaks = peaks_of(inverse, locations[i - 1], locations[i], kJoint, frame);
      return peaks.parabolic / peaks.error;
    };
    machine_frame = std::max(machine_frame, left(ErrorFrame::machine));
    workpiece_frame = std::max(workpiece_frame, left(ErrorFrame::workpiece));
  }
  EXPECT_NEAR(machine_frame, 0.00093, 0.00001);
  EXPECT_NEAR(workpiece_frame, 0.00151, 0.00001);
}

TEST(Li2024, Example1WithPostedLocations) {
  const NonlinearPeaks peaks =
      peaks_of(machine(Vector3d::Zero()), kExample1[0], kExample1[1], kPosted);
  EXPECT_NEAR(peaks.error / mm, 2.43, 0.005);
  EXPECT_NEAR(peaks.middle / mm, 2.37, 0.005);
  EXPECT_NEAR(peaks.harmonic / peaks.error, 0.19, 0.005);
  EXPECT_NEAR(peaks.parabolic / peaks.error, 0.14, 0.005);
}

// ---- table 3.2 ----

constexpr double kPeakTol = 0.01;  // um, of peaks printed to that

TEST(Li2024, Table32WithTheRotationCentreInThePart) {
  EXPECT_NEAR(table_3_2_peaks(Vector3d::Zero(), kJoint).error / um, 2.30, kPeakTol);
  EXPECT_NEAR(table_3_2_peaks(Vector3d::Zero(), kPosted).error / um, 2.32, kPeakTol);
}

TEST(Li2024, Table32WithTheRotationCentreBelowThePart) {
  const Vector3d m(0.0, 0.0, -150.0 * mm);
  EXPECT_NEAR(table_3_2_peaks(m, kJoint).error / um, 3.99, kPeakTol);
  EXPECT_NEAR(table_3_2_peaks(m, kPosted).error / um, 4.01, kPeakTol);
}

TEST(Li2024, AParabolaLeavesAThirtiethOfWhatTheSineLeaves) {
  for (const double m_z : {0.0, -150.0 * mm}) {
    for (const NonlinearError definition : {kJoint, kPosted}) {
      const Table32Peaks peaks = table_3_2_peaks({0.0, 0.0, m_z}, definition);
      EXPECT_LT(peaks.harmonic, 0.057);
      EXPECT_GT(peaks.harmonic, 0.056);
      EXPECT_LT(peaks.parabolic, 0.002);
    }
  }
}

TEST(Li2024, ThePaperSPeakNeedsACentre190mmBelow) {
  EXPECT_NEAR(table_3_2_peaks({0.0, 0.0, -190.0 * mm}, kJoint).error / um, 4.5, 0.05);
}

TEST(Li2024, ACentreBesideThePartLeavesMore) {
  const Table32Peaks peaks = table_3_2_peaks({150.0 * mm, 0.0, 0.0}, kPosted);
  EXPECT_NEAR(peaks.harmonic, 0.061, 0.0005);
  EXPECT_NEAR(peaks.parabolic, 0.009, 0.0005);
}

TEST(Li2024, ExactPointsKeepEveryLocationOfTable32WithinTheTolerance) {
  const auto locations = table_3_2();
  const plant::InverseKinematics inverse = machine({0.0, 0.0, -150.0 * mm});
  for (const double tolerance : {1.0 * um, 0.1 * um, 0.01 * um}) {
    double worst = 0.0;
    Joints Q = inverse.nearest({locations[0].P, locations[0].U}, kNoTool, Joints::Zero()).Q;
    for (std::size_t i = 1; i < locations.size(); ++i) {
      const plant::StraightToolPath path({locations[i - 1].P, locations[i - 1].U},
                                         {locations[i].P, locations[i].U});
      const auto line = linearise(inverse, kNoTool, path, Q, {tolerance, 1.0});
      ASSERT_TRUE(line.is_complete);
      double t = 0.0;
      for (const plant::PathPoint& point : line.points) {
        for (double f = 0.0; f < 1.0; f += 0.01) {
          const auto is = forward(inverse.chain(), Q + f * (point.Q - Q), kNoTool);
          worst = std::max(worst, (is.p_WT - path.at(t + f * (point.t - t)).p_WT).norm());
        }
        t = point.t;
        Q = point.Q;
      }
    }
    EXPECT_LT(worst, 1.001 * tolerance);  // looked at in three places between two points
    EXPECT_GT(worst, 0.2 * tolerance);    // no more points than needed: halving quarters the error
  }
}

// ---- compensation as published ----

TEST(Li2024, CompensatedTipKeepsToTheChordExceptForWhatTheModelLeaves) {
  const plant::InverseKinematics inverse = machine(Vector3d::Zero());
  const auto one =
      *PostProcessedSegment::post(inverse, kNoTool, kExample1[0], kExample1[1], Joints::Zero());
  const NonlinearPeaks peaks = *nonlinear_peaks(one, kJoint);
  const auto a = *one.error(kJoint, 0.5);
  for (const ErrorShape shape : {ErrorShape::harmonic, ErrorShape::parabolic}) {
    double left = 0.0;
    for (int n = 0; n <= 1000; ++n) {
      const double t = n / 1000.0;
      const Joints Q = *one.compensated(kJoint, shape, a, t);
      const Vector3d chord = kExample1[0].P + t * (kExample1[1].P - kExample1[0].P);
      left = std::max(left, (forward(inverse.chain(), Q, kNoTool).p_WT - chord).norm());
    }
    EXPECT_NEAR(left, shape == ErrorShape::harmonic ? peaks.harmonic : peaks.parabolic, 1e-12);
  }
}

TEST(Li2024, CompensatedPostsGoWhereTheMachineGoesOfItself) {
  // definition (b) of table 3.2: posts come to the line between S_0 and S_1, the tip stays off
  const plant::InverseKinematics inverse = machine({0.0, 0.0, -150.0 * mm});
  const auto locations = table_3_2();
  const auto segment =
      *PostProcessedSegment::post(inverse, kNoTool, locations[0], locations[1], Joints::Zero());
  const auto a = *segment.error(kPosted, 0.5);
  const Joints Q = *segment.compensated(kPosted, ErrorShape::harmonic, a, 0.5);
  const Joints straight = 0.5 * (segment.Q_0() + segment.Q_1());
  EXPECT_LT((Q - straight).head<3>().norm(), 1e-15);
  const Vector3d chord = 0.5 * (locations[0].P + locations[1].P);
  const double off = (forward(inverse.chain(), Q, kNoTool).p_WT - chord).norm();
  const double uncompensated = (*segment.error(kJoint, 0.5)).norm();
  EXPECT_NEAR(off / uncompensated, 1.0, 0.01);
}

TEST(Li2024, PointsAreInsertedOnlyWhereTheModelExceedsTheTolerance) {
  const plant::InverseKinematics inverse = machine(Vector3d::Zero());
  const auto segment =
      *PostProcessedSegment::post(inverse, kNoTool, kExample1[0], kExample1[1], Joints::Zero());
  const double a = segment.error(kJoint, 0.5)->norm();
  const auto points = [&](double tolerance) {
    return *segment.compensated_points(kJoint, ErrorShape::harmonic, tolerance, 0.1 * mm);
  };
  EXPECT_EQ(points(1.001 * a).size(), 1u);
  ASSERT_EQ(points(0.999 * a).size(), 22u);  // the 23 points of table 3.1, but for the first
  EXPECT_EQ(points(0.999 * a).back().Q, segment.Q_1());
  EXPECT_NEAR(points(0.999 * a)[4].t * segment.length(), 0.5 * mm, 1e-15);
}

}  // namespace
}  // namespace servomill::li2024_test
