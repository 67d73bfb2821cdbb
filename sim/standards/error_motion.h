/// Error motions of an axis of rotation after ISO 230-7: radial, axial and tilt, from displacement
/// sensors on a test ball or mandrel over several revolutions.
///
/// A displacement r(theta) over n revolutions at the same N angles of each. The synchronous error
/// motion is its mean over the revolutions, whole multiples of the rotational frequency; what is
/// left is asynchronous. The total error motion is all of it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/standards/report.h"

namespace servomill::sim::standards {

/// Centre about which a polar diagram is evaluated. Radial and tilt error motions: the artefact is
/// never centred perfectly, and the circle through the curve is taken away (LSC, the standard's
/// preference). An axial error motion has no such centre: that of the polar chart (PC).
enum class Centre : std::uint8_t { least_squares_circle, polar_chart };

struct ErrorMotion {
  double total = 0.0;
  double synchronous = 0.0;
  double asynchronous = 0.0;  // largest range over the revolutions at one angle
  double fundamental = 0.0;   // axial: range at the rotational frequency, 2 sqrt(a^2 + b^2)
  double residual = 0.0;      // axial: synchronous without the fundamental
  double total_mrs = 0.0;     // about the minimum radial separation centre; radial and tilt
};

/// @param theta  angles of one revolution (N; rad)
/// @param r      displacements (N x revolutions; m or rad)
ErrorMotion evaluate_error_motion(const Eigen::ArrayXd& theta, const Eigen::ArrayXXd& r,
                                  Centre centre);

/// Displacements of sensors over whole revolutions.
struct RotationTest {
  std::string name;
  Eigen::ArrayXd theta;  // N; rad, of one revolution
  struct Channel {
    std::string name;
    Dimension dimension = Dimension::length;
    Centre centre = Centre::least_squares_circle;
    Eigen::ArrayXXd r;  // N x revolutions
  };
  std::vector<Channel> channels;
};

/// Readings of sensors by their names, "x", "y", "z", "x2", "y2": N x revolutions, m.
using RotationSensors = std::map<std::string_view, Eigen::ArrayXXd>;

/// The channels that sensors give: radial in fixed sensitive directions and, of x and y together, a
/// rotating one; axial; tilt.
/// @param sensors  one at least
/// @param distance  m, of x2 and y2 from x and y; 0 without them
RotationTest rotation_of(std::string name, const Eigen::ArrayXd& theta,
                         const RotationSensors& sensors, double distance);

/// Reads sensors from a table: `revolution` from 1, `angle_deg`, and `x_um`, `y_um` (radial, fixed
/// sensitive directions; both together also a rotating one), `z_um` (axial), `x2_um`, `y2_um`
/// (radial at a second place, `distance` farther along the axis: tilt).
/// @param distance  m, between the two places; 0: not known
/// @throws InputError with all faults: angles that differ between revolutions, ...
RotationTest read_rotation(const std::string& path, double distance);

Report rotation_report(const RotationTest& test);

}  // namespace servomill::sim::standards
