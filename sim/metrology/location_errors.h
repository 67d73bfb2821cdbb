/// Location errors of the axes from a ball that the machine holds or follows: the R-test, with a
/// nest of sensors around a ball, and circles measured by a ball bar (ISO 10791-6 BK1 to BK4).
///
///            spindle                 d = n . (p_true - p_nominal)    what a sensor along n says
///               |
///             ( o )  ball            p_true - p_nominal, tip in the table frame W, to first order:
///            --> <-- sensors
///         ___[table]___                sum of E x (screw of E at these joints)    location errors
///                                      - s                                        nest on the
///                                      table
///                                      + R_WS delta                               ball in the
///                                      spindle
///
/// Set-up is never known to a micrometre: s (3; in W, own to every set-up) always is an unknown; so
/// is delta (3; in the spindle), unless the ball has been adjusted to the spindle axis and its
/// length is known; and so is the length of a ball bar (own to every set-up). With all of them
/// unknown, eight location errors of a five-axis machine can be identified: three squarenesses of
/// the linear axes, four tilts and one offset of the rotary ones (the eight link errors of
/// Abbaszadeh-Mir and Mayer). A ball bar on the axis of a cone frustum does not see EC0B of a BC
/// table.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"

namespace servomill::sim::metrology {

/// Orientation of the spindle seen from the workpiece (3x3), of the ideal machine.
Eigen::Matrix3d R_WS(const plant::MachineChain& chain, const Joints& Q);

/// One number of one sensor.
struct SensorReading {
  Joints Q = Joints::Zero();                       // m, rad; of the ideal machine
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, tip in the spindle nose
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitX();  // direction in which it measures
  double d = 0.0;                                  // m, tip relative to the table
  int set_up = 0;                                  // readings of one ball position: 0, 1, ...
};

/// Unknowns of the set-up beside the place of the nest on the table.
struct RTestSetUp {
  bool tcp_is_unknown = true;      // place of the ball in the spindle
  bool length_is_unknown = false;  // of a ball bar
};

/// Error of the same effect: `factor` of it (m, rad per m, rad).
struct Likeness {
  plant::ErrorName name;
  double factor = 0.0;
};

/// Estimate of one location error from readings.
struct LocationEstimate {
  plant::ErrorName name;
  std::optional<double> value;  // m or rad; nothing where it is confounded with others
  double uncertainty = 0.0;     // m or rad; standard deviation if what the fit leaves of the
                                // readings is independent noise
  // Without a value: errors and set-up that together have the same effect. Empty: the error has no
  // effect on these readings.
  std::vector<Likeness> like;
  bool is_like_set_up = false;

  /// "confounded with -EX0C and set-up", "has no effect"; empty where there is a value.
  std::string why_not() const;
};

struct LocationFit {
  std::vector<LocationEstimate> errors;  // all that the machine can have
  int rank = 0;                          // of all unknowns together, from the singular values
  double condition = 1.0;  // of the unknowns that were solved for, each scaled to the same effect
  double left = 0.0;       // m, root mean square of what the fit leaves

  const LocationEstimate* find(const plant::ErrorName& name) const;
  int number_identified() const;
};

/// An effect of which less than this share is its own is confounded with that of others.
inline constexpr double kOwnShare = 1e-3;

/// All location errors that do something on this machine, in the order in which they are kept where
/// one has to do for several: squareness of the linear axes, tilts of the rotary axes from the
/// workpiece on, their offsets, and last what aligning the frame of the machine to X and XY removes
/// (EB0X, EC0X, EA0Y).
std::vector<plant::ErrorName> location_errors(const plant::MachineChain& chain);

/// Identifies them by least squares. The effects are those of the first-order volumetric error, so
/// that errors of the size e leave a share of the order e (rad) of themselves.
/// @pre there are readings; their n_W are unit vectors
LocationFit identify_locations(const plant::MachineChain& chain,
                               const std::vector<SensorReading>& readings,
                               const RTestSetUp& set_up);

/// Only what could be identified at these joints and directions: no values.
LocationFit observable_locations(const plant::MachineChain& chain,
                                 const std::vector<SensorReading>& readings,
                                 const RTestSetUp& set_up);

}  // namespace servomill::sim::metrology
