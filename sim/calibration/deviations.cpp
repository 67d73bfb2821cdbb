#include <vector>

#include "plant/geometry/volumetric.h"
#include "sim/calibration/observations.h"

namespace servomill::sim::calibration {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Deviations::Machine {
  plant::MachineChain chain;
  plant::VolumetricModel model;
  std::vector<double> directions;  // of the plays, of the pose at hand

  void set_directions(const Pose& pose) {
    for (std::size_t k = 0; k < directions.size(); ++k) {
      directions[k] = pose.direction[static_cast<std::size_t>(model.plays()[k].joint)];
    }
  }
  Vector3d shift(const Pose& pose, const Vector3d& p_ST, bool first_order) {
    return first_order ? model.first_order_error(pose.Q, p_ST, directions).dp_W
                       : model.error(pose.Q, p_ST, directions).dp_W;
  }
  // The sum of a x (w x a) over three orthogonal unit vectors a is 2 w; to second order in the turn
  // for the exact deviation, whose turns are some 1e-4.
  Vector3d turn(const Pose& pose, bool first_order) {
    const Vector3d at_nose = shift(pose, Vector3d::Zero(), first_order);
    const Vector3d origin = plant::forward(chain, pose.Q, Vector3d::Zero()).p_WT;
    Vector3d twice = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = plant::forward(chain, pose.Q, Vector3d::Unit(k)).p_WT - origin;
      twice += a.cross(shift(pose, Vector3d::Unit(k), first_order) - at_nose);
    }
    return 0.5 * twice;
  }
  double at(const Pose& pose, bool first_order) {
    set_directions(pose);
    const Vector3d deviation =
        pose.is_turn ? turn(pose, first_order) : shift(pose, pose.p_ST, first_order);
    return pose.n_W.dot(deviation);
  }
};

Deviations::Deviations(const plant::MachineChain& chain, const plant::ErrorModel& errors)
    : machine_(std::make_unique<Machine>(Machine{
          .chain = chain, .model = plant::VolumetricModel(chain, errors), .directions = {}})) {
  machine_->directions.resize(machine_->model.plays().size());
}
Deviations::~Deviations() = default;
Deviations::Deviations(Deviations&&) noexcept = default;

double Deviations::at(const Pose& pose) const { return machine_->at(pose, false); }
double Deviations::first_order_at(const Pose& pose) const { return machine_->at(pose, true); }

double Deviations::of(const Observation& observation) const {
  double sum = 0.0;
  for (const Pose& pose : observation.poses) sum += pose.weight * at(pose);
  return sum;
}

}  // namespace servomill::sim::calibration
