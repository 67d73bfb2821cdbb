/// Joints of eight runs side by side, and what formulas need that are written once for such and for
/// the joints of a single run.
#pragma once

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/lanes.h"

namespace servomill {

/// Eight runs side by side, joint by joint (m, rad): [joint][run].
using JointLanes = LaneArray[kJoints];
using LinearJointLanes = LaneArray[kLinearJoints];

/// Runs that a vector of joints holds: one, or eight in lanes.
template <class Vector>
inline constexpr std::size_t kLanesOf = 1;
template <>
inline constexpr std::size_t kLanesOf<JointLanes> = kLaneWidth;
template <>
inline constexpr std::size_t kLanesOf<LinearJointLanes> = kLaneWidth;

/// A joint's value in one of these runs.
inline double& lane(double& number, std::size_t) { return number; }
inline double& lane(LaneArray& numbers, std::size_t n) { return numbers[n]; }
inline double lane(const double& number, std::size_t) { return number; }
inline double lane(const LaneArray& numbers, std::size_t n) { return numbers[n]; }

}  // namespace servomill
