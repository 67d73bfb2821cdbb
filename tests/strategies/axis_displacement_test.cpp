/// The displacement that all strategies share.
#include "strategies/axis_displacement.h"

#include <gtest/gtest.h>

#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::axis_displacement_test {
namespace {

constexpr double kAmplitude = 100.0 * um, kPeriod = 60.0 * mm;

// An error of X along X: its correction changes it.
IdentifiedMachine positioning_error() {
  plant::ErrorModel errors;
  errors.component({Axis::X, Axis::X}) = plant::harmonic(kAmplitude, kPeriod);
  return identified_with(errors);
}

// m: distance of the true tool to the ideal one of the programmed position
double left_by_setpoint(const IdentifiedMachine& identified, Iterations iterations,
                        const Joints& Q) {
  Joints moved = Q;
  moved.head<3>() += setpoint_displacement(identified, Action::compensate, iterations, Q);
  return (identified.model.forward(moved, identified.p_ST).p_WT -
          plant::forward(identified.model.chain(), Q, identified.p_ST).p_WT)
      .norm();
}

// E(x - E(x)) - E(x) = -E' E to first order: for a sine at most A^2 omega / 2 = 0.52 um here.
TEST(SetpointDisplacement, InOneStepLeavesSlopeTimesError) {
  const IdentifiedMachine identified = positioning_error();
  const double omega = 2.0 * std::numbers::pi / kPeriod;
  const double second_order = kAmplitude * omega;  // 1 %
  double largest = 0.0;
  for (double x = -60.0 * mm; x < 60.0 * mm; x += 0.37 * mm) {
    Joints Q = identified.reference;
    Q[0] = x;
    const double E = kAmplitude * std::sin(omega * x),
                 dE = kAmplitude * omega * std::cos(omega * x);
    const double left = left_by_setpoint(identified, Iterations::one, Q);
    // next term: E'' E^2 / 2
    EXPECT_NEAR(left, std::abs(dE * E), 0.5 * kAmplitude * second_order * second_order) << x;
    largest = std::max(largest, left);
  }
  RecordProperty("left_um", std::to_string(largest / um));
  EXPECT_NEAR(largest, 0.5 * kAmplitude * kAmplitude * omega, 0.02 * largest);
}

TEST(SetpointDisplacement, ConvergedIsTheNonidealInverse) {
  constexpr double kConvergedTol = 1e-12;  // m
  plant::Uniform random(17);
  for (const IdentifiedMachine& identified :
       {positioning_error(), identified_with(plant::random_errors(random, 50e-6))}) {
    for (int n = 0; n < 50; ++n) {
      Joints Q = identified.reference;
      for (int j = 0; j < kLinearJoints; ++j) Q[j] = 0.15 * random();
      EXPECT_LT(left_by_setpoint(identified, Iterations::converged, Q), kConvergedTol);
    }
  }
}

Eigen::Vector3d converged_displacement(const IdentifiedMachine& identified, Action action,
                                       const Joints& Q) {
  Eigen::Vector3d d;
  feedback_displacement(identified, action, Iterations::converged, Q, d);
  return d;
}

// Both act on what they are given, and where they are exact they end in the same place:
// Q_true + d(Q_true) = Q_cmd.
TEST(FeedbackDisplacement, PutsTheAxesWhereTheSetpointDoes) {
  constexpr double kSamePlaceTol = 2e-13;  // m, twice the iteration's
  plant::Uniform random(19);
  const IdentifiedMachine identified = identified_with(plant::random_errors(random, 50e-6));
  for (const Action action : kBothActions) {
    for (int n = 0; n < 50; ++n) {
      Joints Q_cmd = identified.reference;
      for (int j = 0; j < kLinearJoints; ++j) Q_cmd[j] = 0.15 * random();
      Joints Q_true = Q_cmd;
      for (int k = 0; k < 30; ++k) {
        Q_true.head<3>() = Q_cmd.head<3>() - converged_displacement(identified, action, Q_true);
      }
      const Eigen::Vector3d by_setpoint =
          Q_cmd.head<3>() + setpoint_displacement(identified, action, Iterations::converged, Q_cmd);
      EXPECT_LT((Q_true.head<3>() - by_setpoint).norm(), kSamePlaceTol);
    }
  }
}

}  // namespace
}  // namespace servomill::strategies::axis_displacement_test
