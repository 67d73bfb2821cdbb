/// Uncertainty of the points of a compensated program, from the covariance of what was identified.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "sim/model/determination.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/programs/compensate/correction.h"

namespace servomill::sim::programs {

struct CompensateRequest;
struct Step;

/// Corrected points at feed, the ends of blocks: each with the expanded uncertainty (k = 2) of the
/// tip that the correction leaves there, in the direction in which the axes travel to it. Errors
/// that the readings have not determined are unknown: they are named, and a coordinate of which
/// nothing else is known has no uncertainty.
class PointUncertainty {
 public:
  /// @param errors  the model that is corrected
  /// @param keeps   every point, for csv()
  PointUncertainty(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                   const model::UncertainErrors& identified, bool keeps);

  void add(const Step& step, const Correction& correction);

  bool empty() const { return count_ == 0; }
  const Eigen::Vector3d& largest() const { return largest_; }  ///< of X, Y, Z each (3; m)
  Eigen::Vector3d rms() const;                                 ///< over the points (3; m)
  /// True if nothing is known of X, Y or Z (0 to 2) at any point.
  bool is_unknown(int i) const { return known_[std::size_t(i)] == 0 && unknown_[std::size_t(i)]; }

  /// Refuses corrections that are not determined (sim/model/determination.h), beside that of the
  /// first point: a shift of all goes into the work offset.
  /// @param left  coordinates that are not corrected
  /// @throws InputError that names the coordinate
  void refuse_undetermined(const std::string& file, const std::array<bool, 3>& left) const;

  /// "uncertainty of the corrected points (k = 2): ...", and the errors that it lacks.
  std::vector<std::string> report() const;
  /// The same as a JSON object.
  std::string json() const;
  /// Line, machine position (mm) and expanded uncertainty (um; empty: unknown) of each point.
  std::string csv() const;

 private:
  struct Point {
    int line = 0;
    Eigen::Vector3d machine = Eigen::Vector3d::Zero();   // m
    Eigen::Vector3d expanded = Eigen::Vector3d::Zero();  // m; NaN: unknown
  };
  // An error that is not determined, and the coordinates that it has moved.
  struct Undetermined {
    plant::ErrorName name;
    plant::VolumetricModel unit;
    std::array<bool, 3> acts{};
  };

  void add_point(int line, const AxisWords& at, const Eigen::Vector3d& p_ST);
  std::array<bool, 3> undetermined_at(const Joints& Q, const Eigen::Vector3d& p_ST);
  std::vector<std::string> undetermined_names() const;

  model::TipUncertainty tip_;
  plant::VolumetricModel errors_;
  std::vector<Undetermined> undetermined_;
  model::TipDetermination determination_;
  JointLayout layout_;
  bool keeps_;
  AxisWords directions_ = AxisWords::Zero();  // of travel
  std::size_t count_ = 0;
  Eigen::Matrix3Xd first_effects_;                         // at the first point
  Eigen::Vector3d first_error_ = Eigen::Vector3d::Zero();  // m
  std::array<std::size_t, 3> known_{};  // points at which something is known of X, Y, Z
  std::array<bool, 3> unknown_{};       // points at which nothing is
  Eigen::Vector3d largest_ = Eigen::Vector3d::Zero(), squares_ = Eigen::Vector3d::Zero();
  int largest_line_ = 0;  // of the largest one of all directions
  std::vector<Point> points_;
};

/// Uncertainty of the corrected points; none where the covariance of the errors is not known.
/// @param model, errors  that are corrected
/// @throws InputError if the request asks for a covariance that is not known
std::shared_ptr<PointUncertainty> uncertainty_of(const CompensateRequest& request,
                                                 const plant::MachineChain& chain,
                                                 const std::string& model,
                                                 const plant::ErrorModel& errors);

}  // namespace servomill::sim::programs
