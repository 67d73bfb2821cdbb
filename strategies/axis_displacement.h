/// Displacement of the linear axes that imposes identified errors or compensates them, and the
/// parameters that strategies share.
#pragma once

#include <Eigen/Core>

#include "plant/vocabulary/joint_lanes.h"
#include "plant/vocabulary/parameters.h"
#include "strategies/displaced_axes.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

enum class Iterations : std::uint8_t { one, converged };

/// Reads "1" or "converged".
Iterations iterations_of(const Parameters& parameters);

/// Reads "linear" or "all".
DisplacedAxes displaced_axes_of(const Parameters& parameters);

/// The parameters `axes` and `singular_deg` as every strategy declares them that has both ways.
extern const ParameterSpec kAxesSpec;
extern const ParameterSpec kSingularSpec;

/// The parameter `iterations` as every strategy declares it.
extern const ParameterSpec kIterationsSpec;

/// Displacement of the setpoint (3; m) for the programmed position Q.
///   impose:                P_comp = F_ni(I_i(P)), exact in one step      (paper [G], equation 3)
///   compensate, one:          -(F_ni(Q) - F_i(Q)), leaves about |E'||E|
///   compensate, converged:    F_ni(Q + d) = F_i(Q), the non-ideal inverse
Eigen::Vector3d setpoint_displacement(const IdentifiedMachine& identified, Action action,
                                      Iterations iterations, const Joints& Q);

/// Displacement of the reading (3; m) for the measured position Q: the axis moves by its negative.
///   compensate:            F_ni(Q) - F_i(Q), exact in one step: the reading is where the tool is
///   impose, one:           -(F_ni(Q) - F_i(Q)) at the measured position, as paper [G] does
///   impose, converged:   -(F_ni(Q_prog) - F_i(Q_prog)) with Q = Q_prog - d
void feedback_displacement(const IdentifiedMachine& identified, Action action,
                           Iterations iterations, const Joints& Q, Eigen::Vector3d& d);
/// The same of eight runs side by side.
/// @param lanes  those of interest: the others take no time
void feedback_displacement(const IdentifiedMachine& identified, Action action,
                           Iterations iterations, const JointLanes& Q, const LaneFlags& lanes,
                           LinearJointLanes& d);

}  // namespace servomill::strategies
