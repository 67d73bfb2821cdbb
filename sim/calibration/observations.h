/// Readings as observations: what of the machine's errors and of the set-up each number holds.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// Place, and direction along or about which the deviation of the tool counts.
struct Pose {
  Joints Q = Joints::Zero();                       // m, rad; nominal
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, measured point in the spindle nose
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitX();  // unit vector
  bool is_turn = false;                            // about n_W instead of along it
  std::array<int, kJoints> direction{};            // of travel
  double weight = 1.0;                             // of this pose in the number
};

/// Part of an unknown of the set-up in a number.
struct SetUpPart {
  std::size_t unknown = 0;
  double factor = 0.0;
};

/// One number d of a reading:  d = sum weight n . e(Q, p_ST) + sum factor u + noise.
struct Observation {
  std::vector<Pose> poses;
  std::vector<SetUpPart> set_up;
  double d = 0.0;           // m or rad
  double correction = 0.0;  // in d, of what the file holds: temperature, nominal length
  std::size_t group = 0;    // index into Readings::groups
  std::size_t row = 0;      // index into Group::rows
};

/// An unknown of a set-up: zero of a laser, place of a ball.
struct SetUpUnknown {
  std::string name;                  // "zero", "slope", "ball X"; shared ones "scale of laser"
  std::optional<std::size_t> group;  // none: of an instrument
  std::optional<double> prior;  // standard uncertainty in its unit, about 0; none: not known at all
  double unit = 1e-6;           // of a number that is shown: m, rad, m/m
  std::string unit_name = "um";
  std::optional<Axis> turning = std::nullopt;  // lost motion at a turning point of this axis
  bool is_size = false;                        // a radius or length, beside the stated one
};

struct Observations {
  std::vector<Observation> all;
  std::vector<SetUpUnknown> set_up;
};

Observations observations_of(const readings::Readings& readings, const plant::MachineChain& chain);

/// Deviation of the tool body at a pose, along or about n_W: of a machine with these errors.
/// Turns follow from three points of the body.
class Deviations {
 public:
  Deviations(const plant::MachineChain& chain, const plant::ErrorModel& errors);
  ~Deviations();
  Deviations(Deviations&&) noexcept;
  double at(const Pose& pose) const;
  /// To first order in the errors.
  double first_order_at(const Pose& pose) const;
  /// The number of an observation without set-up and noise.
  double of(const Observation& observation) const;

 private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace servomill::sim::calibration
