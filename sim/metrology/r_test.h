/// Tests with a ball in the spindle (ISO 10791-6): what sensors on the table read while the machine
/// holds the tip at one place of the table, or takes it around the centre of a ball bar.
///
/// - radial: away from the rotary axis that turns (BK1, BK2, CK1, CK2 and the like, R-test)
/// - tangential: in the sense in which that axis counts
/// - axial: along that axis
/// - bar: along the line from the centre to the tip (BK4 and the like)
///
/// All tell of the true tip relative to the nominal one, in the workpiece; the nest of sensors
/// turns with the table.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plant/kinematics/chain.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim::metrology {

/// A rotary axis of the ideal machine, in the workpiece.
struct AxisLine {
  Eigen::Vector3d point, direction;  // m; unit vector, as the axis counts

  /// From the line to p, perpendicular to it (3; m).
  Eigen::Vector3d arm(const Eigen::Vector3d& p) const {
    return p - point - direction.dot(p - point) * direction;
  }
};
/// @param Q  joint coordinates (5; m, rad); those of axes between it and the workpiece count
AxisLine axis_in_workpiece(const plant::MachineChain& chain, Axis axis, const Joints& Q);

/// The tip along some part of a program, sample by sample.
struct TipPath {
  std::vector<Joints> Q;                         // m, rad; of the ideal machine
  std::vector<Eigen::Vector3d> nominal, actual;  // m, tip in the workpiece
};

enum class NestDirection : std::uint8_t { radial, axial, tangential };

/// Reading of a sensor at every sample (m), or the reason why this is no such test.
struct BallDeviation {
  std::vector<double> d;
  std::string why_not;
};

/// Deviation in a nest of sensors around the ball, in the directions of the only rotary axis that
/// turns.
BallDeviation nest_deviation(const plant::MachineChain& chain, const TipPath& path,
                             NestDirection direction);

/// Deviation of a ball bar from `centre` (3; m, in the workpiece) to the tip: true minus nominal
/// length.
BallDeviation bar_deviation(const TipPath& path, const Eigen::Vector3d& centre);

/// Readings from which location errors can be identified, or why this is no such test.
struct BallReadings {
  std::vector<SensorReading> readings;
  std::string why_not;
};

/// Readings of a nest of three sensors along X, Y and Z of the workpiece; a set-up for each place.
/// @param most_places  at which the tip may stand
BallReadings nest_readings(const plant::MachineChain& chain, const TipPath& path,
                           std::size_t most_places);

/// Readings of a ball bar as above.
/// @param set_up  number of that bar
BallReadings bar_readings(const plant::MachineChain& chain, const TipPath& path,
                          const Eigen::Vector3d& centre, int set_up);

}  // namespace servomill::sim::metrology
