#include "sim/model/tip_uncertainty.h"

#include <cassert>

#include "sim/model/unit_error.h"

namespace servomill::sim::model {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

double travelling(const plant::ErrorFunction& f, double s, const AxisWords& q, double direction) {
  const double mean = f.value(s, q);
  return f.reversals.empty() ? mean : mean + 0.5 * direction * f.width(s);
}

}  // namespace

TipUncertainty::TipUncertainty(const plant::MachineChain& chain, const UncertainErrors& errors)
    : layout_(chain.layout), correlation_(errors.correlation) {
  assert(correlation_.rows() == Index(errors.parts.size()));
  for (const std::vector<UncertainPart>& parts : errors.parts) {
    std::vector<Part>& number = numbers_.emplace_back();
    for (const UncertainPart& part : parts) {
      number.push_back({unit_of(chain, part.name),
                        chain.layout.joint_of(part.name.axis).value_or(0), part.above, part.below});
    }
  }
}

std::size_t TipUncertainty::unit_of(const plant::MachineChain& chain,
                                    const plant::ErrorName& name) {
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (units_[i].name == name) return i;
  }
  units_.push_back({name, plant::VolumetricModel(chain, unit_error(name))});
  return units_.size() - 1;
}

Eigen::Matrix3Xd TipUncertainty::effects(const Joints& Q, const Vector3d& p_ST,
                                         const Joints& directions) const {
  Eigen::Matrix3Xd shift(3, Index(units_.size()));
  for (std::size_t i = 0; i < units_.size(); ++i) {
    shift.col(Index(i)) = units_[i].model.first_order_error(Q, p_ST).dp_W / kUnitError;
  }
  const AxisWords q = layout_.words(Q);
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, Index(numbers_.size()));
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    for (const Part& part : numbers_[k]) {
      const double s = Q[part.joint], direction = directions[part.joint];
      const double change =
          travelling(part.above, s, q, direction) - travelling(part.below, s, q, direction);
      J.col(Index(k)) += 0.5 * change * shift.col(Index(part.unit));
    }
  }
  return J;
}

// Numbers without effect, such as most of a table, are left out.
Eigen::Matrix3d TipUncertainty::covariance_of(const Eigen::Matrix3Xd& effects) const {
  Eigen::Matrix3Xd J(3, effects.cols());
  std::vector<Index> acting;
  for (Index k = 0; k < effects.cols(); ++k) {
    if (effects.col(k).isZero(0.0)) continue;
    J.col(Index(acting.size())) = effects.col(k);
    acting.push_back(k);
  }
  const auto n = Index(acting.size());
  return J.leftCols(n) * correlation_(acting, acting) * J.leftCols(n).transpose();
}

Eigen::Matrix3d TipUncertainty::covariance(const Joints& Q, const Vector3d& p_ST,
                                           const Joints& directions) const {
  return covariance_of(effects(Q, p_ST, directions));
}

Vector3d TipUncertainty::expanded(const Eigen::Matrix3Xd& effects) const {
  return kCoverageFactor * covariance_of(effects).diagonal().cwiseMax(0.0).cwiseSqrt();
}

Vector3d TipUncertainty::expanded(const Joints& Q, const Vector3d& p_ST,
                                  const Joints& directions) const {
  return expanded(effects(Q, p_ST, directions));
}

}  // namespace servomill::sim::model
