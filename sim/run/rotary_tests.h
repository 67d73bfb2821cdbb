/// Tests of rotary axes in a run: readings of an angular device at standstills, and of sensors
/// about a ball or an artefact while the axis turns.
#pragma once

#include <Eigen/Core>

#include "sim/run/test_rows.h"

namespace servomill::sim::run {

struct TestResult;  // sim/run/machine_tests.h

/// Rotation of the spindle against the workpiece about a rotary axis, as the axis counts.
class RotaryDevice {
 public:
  /// @param zero  where it is set to zero
  /// All must outlive it.
  RotaryDevice(const model::MachineTest& test, const evaluation::CaseData& one,
               const TestRows& rows, const Standstill& zero);

  /// Deviation from the nominal rotation since zero, mean of a part of a standstill (rad).
  /// @param nominal  rotation of the axis since zero (rad)
  double deviation(const Standstill& at, double nominal, double from, double to) const;

 private:
  const TestRows& rows_;
  Eigen::Vector3d axis_;  // in the workpiece
  Eigen::Matrix3d R_zero_;
};

/// Error motion of a rotary table (ISO 230-7): displacements of one ball on its axis, or of two,
/// relative to the spindle, along the two linear directions across the axis (x and y, of C: X and
/// Y) and along it (z).
void evaluate_error_motion(const model::MachineTest& test, const evaluation::CaseData& one,
                           const TestRows& rows, TestResult& out);

/// Rotary axis about a ball (ISO 10791-6), the linear axes following: displacement of the TCP
/// relative to a nest of sensors on the workpiece (sim/metrology/r_test.h).
void evaluate_ball(const model::MachineTest& test, const evaluation::CaseData& one,
                   const TestRows& rows, TestResult& out);

}  // namespace servomill::sim::run
