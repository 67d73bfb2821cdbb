#include "sim/tables/tool_side_poses.h"

#include <Eigen/Geometry>

namespace servomill::sim::tables {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

plant::ErrorModel components_of(const plant::ErrorModel& errors, Axis axis) {
  plant::ErrorModel out;
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName name{direction, axis, false};
    out.component(name) = plant::travelling(errors.component(name), 0.0);
  }
  return out;
}

// Columns: images of the unit vectors (1 m).
template <typename Pose>
Matrix3d rotation(const Pose& pose) {
  const Vector3d origin = pose(Vector3d::Zero());
  Matrix3d R;
  for (int i = 0; i < 3; ++i) R.col(i) = pose(Vector3d::Unit(i)) - origin;
  return R;
}

}  // namespace

ToolSidePoses::ToolSidePoses(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                             Axis axis)
    : chain_(chain), axis_(chain.at(axis)), model_(chain, components_of(errors, axis)) {}

double ToolSidePoses::value(Axis direction, double q) const {
  Joints Q = Joints::Zero();
  Q[axis_.joint] = q;
  const auto ideal = [&](const Vector3d& p) { return plant::forward(chain_, Q, p).p_WT; };
  const auto actual = [&](const Vector3d& p) { return model_.forward(Q, p).p_WT; };
  const Matrix3d R_ideal = rotation(ideal), R = R_ideal.transpose() * rotation(actual);
  if (is_linear(direction)) {
    Vector3d shift = R_ideal.transpose() * (actual(Vector3d::Zero()) - ideal(Vector3d::Zero()));
    if (!is_linear(axis_.axis)) shift += R * axis_.centre - axis_.centre;
    return shift[index_of(direction)];
  }
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis()[index_of(direction) - index_of(Axis::A)];
}

}  // namespace servomill::sim::tables
