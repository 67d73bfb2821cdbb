/// Places of a part that a probe touches.
#pragma once

#include <Eigen/Core>

namespace servomill::plant {

/// A nominal point of the part and the normal there.
struct ProbeTarget {
  Eigen::Vector3d point;   // m
  Eigen::Vector3d normal;  // unit, out of the part
};

}  // namespace servomill::plant
