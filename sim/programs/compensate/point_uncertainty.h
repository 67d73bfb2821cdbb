/// Uncertainty of the points of a compensated program, from the covariance of what was identified.
#pragma once

#include <string>
#include <vector>

#include "sim/model/tip_uncertainty.h"
#include "sim/programs/compensate/correction.h"

namespace servomill::sim::programs {

struct Step;

/// Corrected points at feed, the ends of blocks: each with the expanded uncertainty (k = 2) of the
/// tip that the correction leaves there, in the direction in which the axes travel to it.
class PointUncertainty {
 public:
  /// @param keeps  every point, for csv()
  PointUncertainty(const plant::MachineChain& chain, const model::UncertainErrors& errors,
                   bool keeps)
      : tip_(chain, errors), layout_(chain.layout), keeps_(keeps) {}

  void add(const Step& step, const Correction& correction);

  bool empty() const { return count_ == 0; }
  const Eigen::Vector3d& largest() const { return largest_; }  ///< of X, Y, Z each (3; m)
  Eigen::Vector3d rms() const;                                 ///< over the points (3; m)

  /// "uncertainty of the corrected points (k = 2): ..."
  std::string report() const;
  /// The same as a JSON object.
  std::string json() const;
  /// Line, machine position (mm) and expanded uncertainty (um) of each point.
  std::string csv() const;

 private:
  struct Point {
    int line = 0;
    Eigen::Vector3d machine = Eigen::Vector3d::Zero();   // m
    Eigen::Vector3d expanded = Eigen::Vector3d::Zero();  // m
  };

  model::TipUncertainty tip_;
  JointLayout layout_;
  bool keeps_;
  AxisWords directions_ = AxisWords::Zero();  // of travel
  std::size_t count_ = 0;
  Eigen::Vector3d largest_ = Eigen::Vector3d::Zero(), squares_ = Eigen::Vector3d::Zero();
  int largest_line_ = 0;  // of the largest one of all directions
  std::vector<Point> points_;
};

}  // namespace servomill::sim::programs
