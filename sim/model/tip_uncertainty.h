/// Uncertainty of the tool that identified errors leave: first-order propagation of their
/// covariance.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/volumetric.h"
#include "plant/kinematics/chain.h"

namespace servomill::sim::model {

/// Coverage factor of expanded uncertainties: about 95 % of a normal distribution.
inline constexpr double kCoverageFactor = 2.0;

/// A component or location error that depends on an identified number.
struct UncertainPart {
  plant::ErrorName name;
  plant::ErrorFunction above, below;  // number plus, minus its standard deviation; constants of
                                      // location errors
};

/// Errors of a machine that were identified, with what is not known of them.
struct UncertainErrors {
  std::string model;                              // name of the error model
  std::vector<std::vector<UncertainPart>> parts;  // of each number that scatters
  Eigen::MatrixXd correlation;                    // of these numbers
};

/// Covariance of the deviation of the tip that remains once the identified errors are corrected.
///
///     C = J R J'    column k of J: (e(g_k + s_k) - e(g_k - s_k)) / 2
///
/// with the numbers g, their standard deviations s and correlation R, and the deviation e of the
/// tip to first order in the errors. Exact where e is linear in g, as of all numbers but phases,
/// periods and places of tables. Constant: threads may share it.
class TipUncertainty {
 public:
  TipUncertainty(const plant::MachineChain& chain, const UncertainErrors& errors);

  /// Effects J of the numbers on the tip, each by one standard deviation (3 x numbers; m, in W).
  Eigen::Matrix3Xd effects(const Joints& Q, const Eigen::Vector3d& p_ST,
                           const Joints& directions) const;

  /// Expanded uncertainty (k = 2) of a sum of effects, such as the difference of two places, where
  /// a common shift has no part in it (3; m).
  Eigen::Vector3d expanded(const Eigen::Matrix3Xd& effects) const;

  /// @param Q           joints (5; m, rad)
  /// @param p_ST        tip in the spindle nose (3; m)
  /// @param directions  of travel of the joints, -1 to 1; 0: the mean of both (5)
  /// @return covariance (3x3; m^2, in W)
  Eigen::Matrix3d covariance(const Joints& Q, const Eigen::Vector3d& p_ST,
                             const Joints& directions) const;

  /// Expanded uncertainty (k = 2) along X, Y, Z of the workpiece (3; m).
  Eigen::Vector3d expanded(const Joints& Q, const Eigen::Vector3d& p_ST,
                           const Joints& directions) const;

 private:
  Eigen::Matrix3d covariance_of(const Eigen::Matrix3Xd& effects) const;

  // Shift of the tip for an error of one (3; m) at the place of a part.
  struct UnitError {
    plant::ErrorName name;
    plant::VolumetricModel model;
  };
  struct Part {
    std::size_t unit = 0;  // of units_
    int joint = 0;         // of the axis
    plant::ErrorFunction above, below;
  };

  std::size_t unit_of(const plant::MachineChain& chain, const plant::ErrorName& name);

  JointLayout layout_;
  std::vector<UnitError> units_;
  std::vector<std::vector<Part>> numbers_;
  Eigen::MatrixXd correlation_;
};

}  // namespace servomill::sim::model
